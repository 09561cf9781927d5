"""What the shaft gives at the moment at which it begins to turn, at every angle, either way.

ISO 4392 asks for the least torque at which a motor starts under pressure. At standstill no
volume changes: each chamber holds the pressure at which what flows in through its ports leaves
past the piston, so that an open chamber has its port's pressure and a shut one, which only
leaks, the case's. Inertia and film give nothing, and the contacts rub as they do at rest.
docs/theory.md section 14.
"""

from dataclasses import replace

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.geometry.extremes import extreme_radius
from camring.metrics.batch_spectra import of_all_pistons
from camring.metrics.displacement import rises_between_knots
from camring.numerics.quantity import Q
from camring.numerics.selection import largest, smallest
from camring.physics.chamber import Chamber, chamber_at
from camring.physics.contact import normal_force
from camring.physics.cycle import reference_radius
from camring.physics.force import radial_force
from camring.physics.friction import SlidingContacts
from camring.physics.motor import Motor
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint
from camring.physics.pressure import port_flows
from camring.physics.rotation import in_mode

__all__ = ["Starting", "starting", "still_pressure"]

ANGLES = 2000  # over the period of the sum of all pistons
_HALVINGS = 60
_SHUT = 1e-24  # m3/(s.Pa): holds the pressure of a chamber that neither opens nor leaks


class Starting(eqx.Module):
    """Torque of all pistons at rest, over the angle after which it repeats."""

    angle: Q[Float[Array, " angle"], "rad"]
    forward: Q[Float[Array, " angle"], "N.m"]
    """The way that the motor file calls forward."""
    backward: Q[Float[Array, " angle"], "N.m"]
    """The other way, the ports exchanged; positive where the shaft starts."""
    ideal_torque: Q[Float[Array, ""], "N.m"]

    def torque(self, reverse: bool = False) -> Q[Float[Array, " angle"], "N.m"]:
        """Over the angle, for one direction."""
        return self.backward if reverse else self.forward

    def starting_torque(self, reverse: bool = False) -> Q[Float[Array, ""], "N.m"]:
        """The least at any of the angles: what the shaft gives wherever it stands."""
        return smallest(self.torque(reverse))

    def starting_efficiency(self, reverse: bool = False) -> Q[Float[Array, ""], "1"]:
        """Over the torque without any loss."""
        return self.starting_torque(reverse) / self.ideal_torque


def starting(
    motor: Motor, fluid: AbstractFluid, point: OperatingPoint, angles: int = ANGLES
) -> Starting:
    """Torque at standstill under the pressures of an operating point, both ways round.

    Traceable and differentiable.

    Parameters
    ----------
    motor
        As its file has it, not seen from behind; `point.reverse` is of no account.
    angles
        Samples over one period of the sum of all pistons. Torque jumps where a
        chamber opens, so that the least is not interpolated.

    Notes
    -----
    Behind a manifold the set pressure stands at the windows. At standstill a relief notch is
    only a place: both directions are those of the same plate.
    """
    motor = in_mode(motor, point.idle_lobes)
    phases, period = motor.distinct_phases, motor.cam.period
    reference, lowest = reference_radius(motor), extreme_radius(motor.cam, -1)
    angle = period / phases * jnp.arange(phases * angles) / angles
    radius = motor.cam.pitch_radius(angle)
    plate = motor.valve_plate
    other = replace(plate, supply=plate.return_, return_=plate.supply)
    still = jnp.zeros_like(point.shaft_speed)

    here = OperatingPoint(still, point.supply_pressure, point.return_pressure, point.case_pressure)

    def turning(motor: Motor) -> tuple[Array, Array]:
        """Torque of every piston without friction, and what friction takes."""
        chamber = chamber_at(motor, reference, angle, radius)
        pressure = still_pressure(motor, fluid, here, chamber)
        force = radial_force(
            motor.piston, pressure, point.case_pressure, radius, still, still, lowest
        )
        contacts = SlidingContacts(radius, force, normal_force(force, radius), motor.roller, still)
        lost = motor.contact_loss(contacts, fluid)
        return of_all_pistons(force * radius.first, motor), of_all_pistons(lost, motor)

    both = (motor, replace(motor, valve_plate=other))
    (given, lost), (taken, lost_back) = map(turning, both)
    return Starting(angle[:angles], given - lost, -taken - lost_back, _ideal_torque(motor, point))


def still_pressure(
    motor: Motor, fluid: AbstractFluid, point: OperatingPoint, chamber: Chamber
) -> Q[Float[Array, "*grid"], "Pa"]:
    """Pressure of chambers that stand still, at which as much comes as goes.

    By halving the range of the pressures around, and a step of Newton's that carries the
    derivatives. A chamber that neither opens nor leaks stands between the ports.
    """
    middle = (point.supply_pressure + point.return_pressure) / 2

    def net(pressure: Array) -> Array:
        flows = port_flows(motor, fluid, point, chamber, pressure)
        held = _SHUT * fluid.content(middle) * (middle - pressure)
        return flows.supply + flows.return_ - flows.leakage + held

    around = jnp.stack([point.supply_pressure, point.return_pressure, point.case_pressure])
    zeros = jnp.zeros_like(chamber.volume)
    low, high = smallest(around) + zeros, largest(around) + zeros

    def halve(_: int, ends: tuple[Array, Array]) -> tuple[Array, Array]:
        low, high = ends
        at = (low + high) / 2
        rises = net(at) > 0
        return jnp.where(rises, at, low), jnp.where(rises, high, at)

    low, high = jax.lax.fori_loop(0, _HALVINGS, halve, jax.lax.stop_gradient((low, high)))
    found = jax.lax.stop_gradient((low + high) / 2)
    left, slope = jax.jvp(net, (found,), (jnp.ones_like(found),))
    return found - left / jax.lax.stop_gradient(slope)


def _ideal_torque(motor: Motor, point: OperatingPoint) -> Q[Float[Array, ""], "N.m"]:
    """`dp V_D / (2 pi)`, docs/theory.md section 6."""
    rises = rises_between_knots(motor)
    return point.pressure_drop * motor.pistons * rises * motor.piston.area / (2 * jnp.pi)

"""The manifolds of supply and return: the oil between a port's line and its windows.

A manifold's pressure `p` is a state. A line of laminar conductance `G` joins it to
the port at the set pressure `P0`, and all pistons draw from it what flows into them:

    content'(p) V dp/dt = mean content * G (P0 - p) - sum of the flows into the pistons

On the return's side both flows are negative: the pistons fill the manifold, the line empties
it. A manifold without end, or one with a wide line, holds its pressure still; one of no
volume passes on at each instant what the pistons draw. The derivation is in
docs/notes/manifold.md.
"""

from collections.abc import Sequence

import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.geometry.extremes import extreme_radius
from camring.numerics.coupled.orbits import (
    CoupledOrbit,
    settle_coupled,
    side_by_side,
    solve_coupled,
)
from camring.numerics.coupled.step import CoupledEquation
from camring.numerics.mesh import Breakpoints, ElementCount
from camring.numerics.periodic import Orbit
from camring.numerics.quantity import Q
from camring.numerics.selection import smaller
from camring.physics.chamber import Chamber, chamber_alone
from camring.physics.manifold.manifold import Manifold
from camring.physics.manifold.sides import SIDES, SUPPLY, at_windows, sides_of
from camring.physics.motor import Motor
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint
from camring.physics.pressure import kinks, port_flows, state_rate

FARTHEST = 3 / 4  # of the way to the other port's pressure, or to zero, that a first guess goes


def line_flow(
    manifold: Manifold,
    fluid: AbstractFluid,
    port_pressure: Q[Float[Array, ""], "Pa"],
    pressure: Q[Float[Array, "*grid"], "Pa"],
) -> Float[Array, "*grid"]:
    """Amount a second through the line from a port into its manifold.

    Negative where the oil leaves, as it does on the return's side.
    """
    content = (fluid.content(port_pressure) + fluid.content(pressure)) / 2
    return content * manifold.line_conductance * (port_pressure - pressure)


def expected_pressures(motor: Motor, point: OperatingPoint) -> list[Q[Float[Array, ""], "Pa"]]:
    """Of the manifolds, if the motor draws what it displaces; a first guess."""
    stroke = extreme_radius(motor.cam, 1) - extreme_radius(motor.cam, -1)
    displaced = motor.pistons * motor.lobes * motor.piston.area * stroke
    drawn = displaced * point.shaft_speed / (2 * jnp.pi)
    found = []
    for side in sides_of(motor):
        manifold, port = side.of(motor), side.set_pressure(point)
        assert manifold is not None
        # A brake's manifold goes away from the other port: what bounds it is a pressure of zero.
        most = jnp.where(point.pressure_drop > 0, point.pressure_drop, port)
        lost = smaller(drawn / manifold.line_conductance, FARTHEST * most)
        found.append(port - lost if side is SUPPLY else port + lost)
    return found


def solve_with_manifolds(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    reference: Q[Float[Array, ""], "m"],
    uncoupled: Orbit,
    manifold_pressures: Sequence[Q[Float[Array, ""], "Pa"]],
    breakpoints: Breakpoints,
    elements: ElementCount,
) -> CoupledOrbit:
    """Chamber and manifolds together.

    Parameters
    ----------
    uncoupled
        The chamber's orbit when the manifolds stand at `manifold_pressures`: it gives
        the first mesh and the first guess.
    elements
        Of the mesh that is laid from what they do together.
    """
    return solve_coupled(
        _equation(motor, fluid, point, reference),
        breakpoints,
        motor.cam.period,
        motor.distinct_phases,
        elements,
        uncoupled,
        [fluid.state(each) for each in manifold_pressures],
    )


def settle_with_manifolds(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    reference: Q[Float[Array, ""], "m"],
    known: CoupledOrbit,
    breakpoints: Breakpoints,
) -> CoupledOrbit:
    """Chamber and manifolds at hand as a function of the motor; see `numerics.periodic.settle`."""
    own, shared = known
    links = motor.distinct_phases
    return settle_coupled(
        _equation(motor, fluid, point, reference),
        breakpoints,
        motor.cam.period,
        own.mesh,
        side_by_side(own.stage_state, [each.stage_state for each in shared], links),
        own.iterations,
    )


def _equation(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    reference: Q[Float[Array, ""], "m"],
) -> CoupledEquation:
    sides = sides_of(motor)
    constant = [side.set_pressure(point) for side in SIDES if side not in sides]
    return CoupledEquation(
        (motor, fluid, point, reference),
        _rate,
        _draw,
        _manifold_rates,
        len(sides),
        chamber_alone,
        kinks(motor, fluid, *constant),
        kinks(motor, fluid),
        motor.orifice.bends_at_zero,
    )


Parameters = tuple[Motor, AbstractFluid, OperatingPoint, Array]
States = tuple[Array, ...]


def _seen(parameters: Parameters, manifold_states: States) -> OperatingPoint:
    motor, fluid, point, _ = parameters
    return at_windows(motor, point, [fluid.pressure(each) for each in manifold_states])


def _rate(parameters: Parameters, chamber: Chamber, state: Array, manifolds: States) -> Array:
    motor, fluid, _, _ = parameters
    return state_rate(motor, fluid, _seen(parameters, manifolds), chamber, state)


def _draw(parameters: Parameters, chamber: Chamber, state: Array, manifolds: States) -> States:
    motor, fluid, _, _ = parameters
    alike = motor.pistons // motor.distinct_phases
    here = _seen(parameters, manifolds)
    flows = port_flows(motor, fluid, here, chamber, fluid.pressure(state))
    return tuple(alike * getattr(flows, side.flow) for side in sides_of(motor))


def _manifold_rates(parameters: Parameters, manifolds: States, drawn: States) -> States:
    motor, fluid, point, _ = parameters
    rates = []
    for side, state, taken in zip(sides_of(motor), manifolds, drawn, strict=True):
        manifold, pressure = side.of(motor), fluid.pressure(state)
        assert manifold is not None
        net = line_flow(manifold, fluid, side.set_pressure(point), pressure) - taken
        capacity = fluid.at(pressure).content_slope * manifold.volume
        rates.append(fluid.state_slope(pressure) * net / (capacity * point.shaft_speed))
    return tuple(rates)

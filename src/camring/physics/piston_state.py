"""Everything the reference piston does, read off a cycle at chosen angles."""

from collections.abc import Sequence
from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from camring.numerics.quadrature import gauss_legendre
from camring.numerics.quantity import Q
from camring.numerics.spline import Jet, floor_past_rounding
from camring.physics.chamber import Chamber, chamber_at, chamber_between
from camring.physics.contact import hertz_stress, normal_force
from camring.physics.cycle import Cycle
from camring.physics.force import radial_force
from camring.physics.friction import SlidingContacts
from camring.physics.manifold.sides import RETURN, SUPPLY, at_windows, sides_of
from camring.physics.pressure import port_flows
from camring.physics.torque import torque_by_virtual_work

QUADRATURE_POINTS = 4


class PistonState(eqx.Module):
    """Everything one piston does at a set of angles; arrays of one shape."""

    angle: Q[Float[Array, "*grid"], "rad"]
    radius: Jet
    chamber: Chamber
    lift: Q[Float[Array, "*grid"], "m"]
    chamber_pressure: Q[Float[Array, "*grid"], "Pa"]
    supply_pressure: Q[Float[Array, "*grid"], "Pa"] | None
    """In the manifold before the supply windows; None without one, as for the return."""
    return_pressure: Q[Float[Array, "*grid"], "Pa"] | None
    supply_flow: Q[Float[Array, "*grid"], "amount/s"]
    return_flow: Q[Float[Array, "*grid"], "amount/s"]
    leakage_flow: Q[Float[Array, "*grid"], "amount/s"]
    force: Q[Float[Array, "*grid"], "N"]
    contact_force: Q[Float[Array, "*grid"], "N"]
    contact_stress: Q[Float[Array, "*grid"], "Pa"]
    friction_torque: Q[Float[Array, "*grid"], "N.m"]
    torque: Q[Float[Array, "*grid"], "N.m"]


class QuadratureSamples(NamedTuple):
    """The reference piston at some points of every element, and the weights of its integrals."""

    piston: PistonState
    pressure_slope: Q[Float[Array, "point element"], "Pa/rad"]
    """Slope of the solution itself, which meets the equation to solver accuracy only."""
    weights: Float[Array, "point element *batch"]

    def mean(self, values: Float[Array, "point element *batch"]) -> Float[Array, "*batch"]:
        """Mean over a period."""
        total = jnp.sum(self.weights * values, axis=(0, 1))
        return total / jnp.sum(self.weights, axis=(0, 1))


def quadrature_samples(cycle: Cycle) -> QuadratureSamples:
    """Sample a cycle at Gauss points, where its integrals are taken."""
    points, weights = gauss_legendre(QUADRATURE_POINTS)
    piston = sample_elements(cycle, jnp.asarray(points))
    slope = cycle.orbit.slope(jnp.asarray(points)) / cycle.fluid.state_slope(
        piston.chamber_pressure
    )
    return QuadratureSamples(piston, slope, jnp.asarray(weights)[:, None] * cycle.orbit.mesh.width)


def sample_elements(cycle: Cycle, fraction: Float[Array, " point"]) -> PistonState:
    """The reference piston at the same fractions of every element, arrays (point, element)."""
    mesh = cycle.orbit.mesh
    radius, chamber = chamber_between(
        cycle.motor, cycle.reference_radius, mesh.start, mesh.width, fraction
    )
    angle = mesh.at(fraction)
    shared = [each.at(fraction) for each in cycle.manifolds]
    return piston_state(cycle, angle, radius, chamber, cycle.orbit.at(fraction), shared)


def sample_angles(cycle: Cycle, angle: Q[Float[Array, "*grid"], "rad"]) -> PistonState:
    """The reference piston at any angles, taken modulo the cam's period."""
    mesh, period = cycle.orbit.mesh, cycle.motor.cam.period
    turns = floor_past_rounding((angle - mesh.start[0]) / period)
    within = angle - turns * period
    element, _ = mesh.locate(within)
    return sample_located(cycle, element, within - mesh.start[element])


def sample_located(
    cycle: Cycle,
    element: Int[Array, "*grid"],
    offset: Q[Float[Array, "*grid"], "rad"],
) -> PistonState:
    """The reference piston at offsets from the starts of numbered elements."""
    angle = cycle.orbit.mesh.start[element] + offset
    radius = cycle.motor.cam.pitch_radius(angle)
    chamber = chamber_at(cycle.motor, cycle.reference_radius, angle, radius)
    shared = [each.at_offset(element, offset) for each in cycle.manifolds]
    state = cycle.orbit.at_offset(element, offset)
    return piston_state(cycle, angle, radius, chamber, state, shared)


def piston_state(
    cycle: Cycle,
    angle: Q[Float[Array, "*grid"], "rad"],
    radius: Jet,
    chamber: Chamber,
    state: Float[Array, "*grid"],
    manifolds: Sequence[Float[Array, "*grid"]] = (),
) -> PistonState:
    """What follows from cam, chamber and the states of the oil at some angles."""
    motor, fluid, point = cycle.motor, cycle.fluid, cycle.point
    pressure = fluid.pressure(state)
    at_ports = [fluid.pressure(each) for each in manifolds]
    flows = port_flows(motor, fluid, at_windows(motor, point, at_ports), chamber, pressure)
    found = dict(zip(sides_of(motor), at_ports, strict=True))
    damping = motor.viscous_damping(fluid)
    force = radial_force(
        motor.piston,
        pressure,
        point.case_pressure,
        radius,
        point.shaft_speed,
        damping,
        cycle.lowest_radius,
    )
    pressing = normal_force(force, radius)
    contacts = SlidingContacts(radius, force, pressing, motor.roller, point.shaft_speed)
    lost = motor.contact_loss(contacts, fluid)
    return PistonState(
        angle=angle,
        radius=radius,
        chamber=chamber,
        lift=radius.value - cycle.reference_radius,
        chamber_pressure=pressure,
        supply_pressure=found.get(SUPPLY),
        return_pressure=found.get(RETURN),
        supply_flow=flows.supply,
        return_flow=flows.return_,
        leakage_flow=flows.leakage,
        force=force,
        contact_force=pressing,
        contact_stress=hertz_stress(pressing, radius, motor.roller, motor.ring_material),
        friction_torque=lost,
        torque=torque_by_virtual_work(force, radius) - lost,
    )

"""Everything the reference piston does, read off a cycle at chosen angles."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from camring.numerics.quantity import Q
from camring.numerics.spline import Jet, floor_past_rounding
from camring.physics.chamber import Chamber, chamber_at, chamber_between
from camring.physics.contact import hertz_stress, normal_force
from camring.physics.cycle import Cycle
from camring.physics.force import radial_force
from camring.physics.manifold import at_supply
from camring.physics.pressure import port_flows
from camring.physics.torque import torque_by_virtual_work


class PistonState(eqx.Module):
    """Everything one piston does at a set of angles; arrays of one shape."""

    angle: Q[Float[Array, "*grid"], "rad"]
    radius: Jet
    chamber: Chamber
    lift: Q[Float[Array, "*grid"], "m"]
    chamber_pressure: Q[Float[Array, "*grid"], "Pa"]
    supply_pressure: Q[Float[Array, "*grid"], "Pa"]
    """Before the supply windows; the operating point's where there is no manifold."""
    supply_flow: Q[Float[Array, "*grid"], "amount/s"]
    return_flow: Q[Float[Array, "*grid"], "amount/s"]
    leakage_flow: Q[Float[Array, "*grid"], "amount/s"]
    force: Q[Float[Array, "*grid"], "N"]
    contact_force: Q[Float[Array, "*grid"], "N"]
    contact_stress: Q[Float[Array, "*grid"], "Pa"]
    friction_torque: Q[Float[Array, "*grid"], "N.m"]
    torque: Q[Float[Array, "*grid"], "N.m"]


def sample_elements(cycle: Cycle, fraction: Float[Array, " point"]) -> PistonState:
    """The reference piston at the same fractions of every element, arrays (point, element)."""
    mesh = cycle.orbit.mesh
    radius, chamber = chamber_between(
        cycle.motor, cycle.reference_radius, mesh.start, mesh.width, fraction
    )
    angle = mesh.at(fraction)
    before = None if cycle.gallery is None else cycle.gallery.at(fraction)
    return piston_state(cycle, angle, radius, chamber, cycle.orbit.at(fraction), before)


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
    before = None if cycle.gallery is None else cycle.gallery.at_offset(element, offset)
    state = cycle.orbit.at_offset(element, offset)
    return piston_state(cycle, angle, radius, chamber, state, before)


def piston_state(
    cycle: Cycle,
    angle: Q[Float[Array, "*grid"], "rad"],
    radius: Jet,
    chamber: Chamber,
    state: Float[Array, "*grid"],
    gallery: Float[Array, "*grid"] | None = None,
) -> PistonState:
    """What follows from cam, chamber and the states of the oil at some angles."""
    motor, fluid, point = cycle.motor, cycle.fluid, cycle.point
    pressure = fluid.pressure(state)
    before = point.supply_pressure if gallery is None else fluid.pressure(gallery)
    flows = port_flows(motor, fluid, at_supply(point, before), chamber, pressure)
    damping = motor.viscous_damping(fluid)
    force = radial_force(
        motor.piston, pressure, point.case_pressure, radius, point.shaft_speed, damping
    )
    pressing = normal_force(force, radius)
    lost = motor.friction.loss_torque(radius, force, pressing, motor.roller)
    return PistonState(
        angle=angle,
        radius=radius,
        chamber=chamber,
        lift=radius.value - cycle.reference_radius,
        chamber_pressure=pressure,
        supply_pressure=jnp.broadcast_to(before, pressure.shape),
        supply_flow=flows.supply,
        return_flow=flows.return_,
        leakage_flow=flows.leakage,
        force=force,
        contact_force=pressing,
        contact_stress=hertz_stress(pressing, radius, motor.roller, motor.ring_material),
        friction_torque=lost,
        torque=torque_by_virtual_work(force, radius) - lost,
    )

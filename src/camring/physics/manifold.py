"""A supply manifold: the gallery of oil before the supply windows, and the line that fills it.

The gallery's pressure `p` is a state. A line of laminar conductance `G` feeds it
from the set supply pressure `Ps`, and all pistons draw from it:

    content'(p) V dp/dt = mean content * G (Ps - p) - sum of the pistons' supply flows

A gallery without end, or one fed through a wide line, holds its pressure still;
one of no volume passes at each instant what the pistons draw. The derivation
is in docs/notes/manifold.md.
"""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.geometry.extremes import extreme_radius
from camring.numerics.coupled import (
    CoupledOrbit,
    settle_coupled,
    side_by_side,
    solve_coupled,
)
from camring.numerics.coupled_step import CoupledEquation
from camring.numerics.mesh import Breakpoints, ElementCount
from camring.numerics.periodic import Orbit
from camring.numerics.quantity import Q
from camring.physics.chamber import Chamber, chamber_alone
from camring.physics.fluid import AbstractFluid
from camring.physics.motor import Motor
from camring.physics.operating_point import OperatingPoint
from camring.physics.pressure import kinks, port_flows, state_rate


def at_supply(point: OperatingPoint, pressure: Q[Float[Array, "*grid"], "Pa"]) -> OperatingPoint:
    """The operating point with another supply pressure, which may differ from angle to angle."""
    return eqx.tree_at(lambda each: each.supply_pressure, point, pressure)


def line_flow(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    pressure: Q[Float[Array, "*grid"], "Pa"],
) -> Float[Array, "*grid"]:
    """Amount a second through the line into a gallery at a pressure."""
    assert motor.manifold is not None
    content = (fluid.content(point.supply_pressure) + fluid.content(pressure)) / 2
    return content * motor.manifold.line_conductance * (point.supply_pressure - pressure)


def expected_pressure(motor: Motor, point: OperatingPoint) -> Q[Float[Array, ""], "Pa"]:
    """Of the gallery, if the motor draws what it displaces; a first guess, above the return's."""
    assert motor.manifold is not None
    stroke = extreme_radius(motor.cam, 1) - extreme_radius(motor.cam, -1)
    displaced = motor.pistons * motor.lobes * motor.piston.area * stroke
    drawn = displaced * point.shaft_speed / (2 * jnp.pi)
    fallen = point.supply_pressure - drawn / motor.manifold.line_conductance
    least = (point.supply_pressure + 3 * point.return_pressure) / 4
    return jnp.maximum(fallen, least)


def solve_with_manifold(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    reference: Q[Float[Array, ""], "m"],
    uncoupled: Orbit,
    gallery_pressure: Q[Float[Array, ""], "Pa"],
    breakpoints: Breakpoints,
    elements: ElementCount,
) -> CoupledOrbit:
    """Chamber and gallery together.

    Parameters
    ----------
    uncoupled
        The chamber's orbit when the gallery stands at `gallery_pressure`: it gives
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
        fluid.state(gallery_pressure),
    )


def settle_with_manifold(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    reference: Q[Float[Array, ""], "m"],
    known: CoupledOrbit,
    breakpoints: Breakpoints,
) -> CoupledOrbit:
    """Chamber and gallery at hand as a function of the motor; see `numerics.periodic.settle`."""
    own, shared = known
    links = motor.distinct_phases
    return settle_coupled(
        _equation(motor, fluid, point, reference),
        breakpoints,
        motor.cam.period,
        own.mesh,
        side_by_side(own.stage_state, shared.stage_state, links),
        own.iterations,
    )


def _equation(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    reference: Q[Float[Array, ""], "m"],
) -> CoupledEquation:
    return CoupledEquation(
        (motor, fluid, point, reference),
        _rate,
        _draw,
        _gallery_rate,
        chamber_alone,
        kinks(motor, fluid, point.return_pressure),
        motor.orifice.bends_at_zero,
    )


Parameters = tuple[Motor, AbstractFluid, OperatingPoint, Array]


def _rate(parameters: Parameters, chamber: Chamber, state: Array, gallery: Array) -> Array:
    motor, fluid, point, _ = parameters
    return state_rate(motor, fluid, at_supply(point, fluid.pressure(gallery)), chamber, state)


def _draw(parameters: Parameters, chamber: Chamber, state: Array, gallery: Array) -> Array:
    motor, fluid, point, _ = parameters
    here = at_supply(point, fluid.pressure(gallery))
    alike = motor.pistons // motor.distinct_phases
    return alike * port_flows(motor, fluid, here, chamber, fluid.pressure(state)).supply


def _gallery_rate(parameters: Parameters, gallery: Array, drawn: Array) -> Array:
    motor, fluid, point, _ = parameters
    assert motor.manifold is not None
    pressure = fluid.pressure(gallery)
    net = line_flow(motor, fluid, point, pressure) - drawn
    capacity = fluid.at(pressure).content_slope * motor.manifold.volume
    return fluid.state_slope(pressure) * net / (capacity * point.shaft_speed)

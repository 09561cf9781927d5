"""The numbers of a data sheet for many motors side by side (`physics/lane_cycle.py`).

Integrals are taken with the collocation points' own quadrature, extremes from the
cubic through an element's start and its three points. Spectra come from places that
are the same in every lane, equally far apart: there the cam is a fixed combination
of control radii, only the pressure is looked up, and the Fourier coefficients are
one matrix product. Pistons are added by folding the period before it.
"""

from math import gcd, pi
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jax.lax import optimization_barrier, stop_gradient
from jaxtyping import Array, Float

from camring.geometry.contour import pressure_angle, undercut_factor
from camring.geometry.lane_cam import radius_around
from camring.metrics.cavitation import cavitation
from camring.metrics.power_balance import power_balance
from camring.metrics.spectrum import QuadratureSamples
from camring.metrics.stiffness import oscillator
from camring.metrics.summary import Metrics
from camring.numerics.extremum import vertex_value
from camring.numerics.lane_mesh import locate_in_lanes, positions
from camring.numerics.lanes import take
from camring.numerics.quantity import Q
from camring.numerics.radau import STAGE_INTEGRALS, STAGES, element_powers, horner
from camring.physics.chamber import chamber_at
from camring.physics.cycle import Cycle
from camring.physics.lane_cycle import LaneCycle, operating_at, radial
from camring.physics.piston_state import PistonState, piston_state
from camring.physics.pressure import pressure_slope

PLACES = np.concatenate([[0.0], STAGES])
_BOOLE = np.array([14, 64, 24, 64, 28, 64, 24, 64, 14]) / 360
"""Boole's rule on two runs of five places, exact to degree five."""


def summarise_lanes(found: LaneCycle, highest_order: int = 600, oversampling: int = 12) -> Metrics:
    """Every result of every lane's cycle, leaves (lane,)."""
    cycle, cam = found.cycle, found.cam
    motor, fluid, point = cycle.motor, cycle.fluid, cycle.point
    samples = _at_collocation_points(found)
    piston = samples.piston
    around = _at_fixed_places(cycle, highest_order, oversampling)

    pistons, speed, drop = motor.pistons, point.shaft_speed, point.pressure_drop
    power = power_balance(cycle, samples)
    mean_torque = pistons * samples.mean(piston.torque)
    mean_gauge = samples.mean(piston.chamber_pressure) - point.return_pressure
    amount_flow = power.supply_flow * fluid.content(point.supply_pressure)

    phases = pistons // gcd(pistons, motor.cam.repeats)
    orders = highest_order // motor.cam.repeats
    torque = _folded(around.torque, phases, pistons)
    torque_power = _power(torque, orders // phases)
    flow_power = _power(_folded(around.supply_flow, phases, pistons), orders // phases)
    pressure_power = _power(around.chamber_pressure, orders)
    torque_ripple = jnp.sqrt(torque_power) / jnp.abs(mean_torque)
    pressure_ripple = jnp.sqrt(pressure_power) / jnp.abs(mean_gauge)
    flow_ripple = jnp.sqrt(flow_power) / jnp.abs(amount_flow)
    peak_to_peak = _largest_sample(torque) + _largest_sample(-torque)

    lowest, highest = cam.extremes()
    stroke = highest - lowest
    displacement = pistons * motor.cam.repeats * cam.rises() * motor.piston.area
    ideal_torque = drop * displacement / (2 * pi)
    spring = oscillator(cycle, samples.mean(piston.chamber.volume))
    corners = _with_starts(cycle, piston)
    pressure = corners.chamber_pressure
    most_pressure, least_pressure = _largest(pressure), -_largest(-pressure)
    starved = cavitation(cycle, pressure, least_pressure, PLACES)
    zero = jnp.zeros_like(stroke)
    third = _round(cam.radius.third, _BOOLE)

    return Metrics(
        mean_torque=mean_torque,
        torque_ripple=torque_ripple,
        torque_ripple_true_rms=jnp.sqrt(2) * torque_ripple,
        torque_ripple_peak_to_peak=peak_to_peak / jnp.abs(mean_torque),
        pressure_ripple=pressure_ripple,
        pressure_ripple_true_rms=jnp.sqrt(2) * pressure_ripple,
        flow_ripple=flow_ripple,
        flow_ripple_true_rms=jnp.sqrt(2) * flow_ripple,
        displacement=displacement,
        stroke=stroke,
        min_lift=lowest - cycle.reference_radius,
        max_lift=highest - cycle.reference_radius,
        ideal_torque=ideal_torque,
        supply_flow=power.supply_flow,
        efficiency=power.output_power / power.input_power,
        volumetric_efficiency=displacement * speed / (2 * pi * power.supply_flow),
        hydromechanical_efficiency=mean_torque / ideal_torque,
        input_power=power.input_power,
        output_power=power.output_power,
        line_loss=zero,
        throttling_loss=power.throttling_loss,
        leakage_loss=power.leakage_loss,
        friction_loss=power.friction_loss,
        compression_loss=power.compression_loss,
        power_residual=power.residual,
        min_pressure=least_pressure,
        max_pressure=most_pressure,
        supply_pressure_swing=zero,
        pressure_overshoot=jnp.maximum(most_pressure - point.supply_pressure, 0),
        pressure_undershoot=jnp.maximum(point.return_pressure - least_pressure, 0),
        air_release_margin=starved.air_release_margin,
        vapour_margin=starved.vapour_margin,
        share_below_air_release=starved.share_below_air_release,
        share_below_vapour=starved.share_below_vapour,
        min_contact_force=-_largest(-corners.force),
        max_contact_stress=_largest(corners.contact_stress),
        min_undercut_factor=-_largest_part(-undercut_factor(cam.radius, motor.roller.radius)),
        max_pressure_angle=_largest_part(jnp.abs(pressure_angle(cam.radius))),
        max_velocity=jnp.abs(speed) * _largest_part(jnp.abs(cam.radius.first)),
        max_acceleration=speed**2 * _largest_part(jnp.abs(cam.radius.second)),
        max_jerk=jnp.abs(speed) ** 3 * _largest_part(jnp.abs(cam.radius.third)),
        min_volume=motor.dead_volume + motor.piston.area * (lowest - cycle.reference_radius),
        hydraulic_stiffness=spring.stiffness,
        natural_frequency=spring.natural_frequency,
        damping_ratio=spring.damping_ratio,
        jerk_objective=third / (stroke * motor.lobes**3) ** 2,
        spectral_pressure=pressure_power / drop**2,
        spectral_torque=torque_power / ideal_torque**2,
    )


class Waves(NamedTuple):
    """What spectra are taken of, shape (place, lane)."""

    torque: Q[Float[Array, "place lane"], "N.m"]
    supply_flow: Float[Array, "place lane"]
    chamber_pressure: Q[Float[Array, "place lane"], "Pa"]


class Corners(NamedTuple):
    """What extremes are taken of, at an element's start and its collocation points."""

    chamber_pressure: Q[Float[Array, "4 element lane"], "Pa"]
    force: Q[Float[Array, "4 element lane"], "N"]
    contact_stress: Q[Float[Array, "4 element lane"], "Pa"]


def _at_collocation_points(found: LaneCycle) -> QuadratureSamples:
    cycle, (radius, chamber) = found.cycle, found.at_stages
    mesh = cycle.orbit.mesh
    angle = positions(mesh, jnp.asarray(STAGES))
    piston = piston_state(cycle, angle, radius, chamber, cycle.orbit.stage_state)
    pressure = piston.chamber_pressure
    slope = pressure_slope(cycle.motor, cycle.fluid, cycle.point, chamber, pressure)
    weights = STAGE_INTEGRALS[-1][:, None, None] * mesh.width
    return optimization_barrier(QuadratureSamples(piston, slope, weights))


def _with_starts(cycle: Cycle, piston: PistonState) -> Corners:
    start = cycle.orbit.mesh.start[None]
    radius, chamber = operating_at(cycle.motor, cycle.reference_radius, start)
    first = piston_state(cycle, start, radius, chamber, cycle.orbit.node_state[None])
    pairs = [
        jnp.concatenate([getattr(first, name), getattr(piston, name)]) for name in Corners._fields
    ]
    return optimization_barrier(Corners(*pairs))


def _at_fixed_places(cycle: Cycle, highest_order: int, oversampling: int) -> Waves:
    motor, orbit, period = cycle.motor, cycle.orbit, cycle.motor.cam.period
    phases = motor.pistons // gcd(motor.pistons, motor.cam.repeats)
    wanted = max(oversampling * (highest_order // motor.cam.repeats), 256)
    count = phases * -(-wanted // phases)
    lanes = orbit.node_state.shape[-1]
    angle = jnp.broadcast_to(jnp.arange(count)[:, None] * (period / count), (count, lanes))
    # The mesh covers a period that begins at its first breakpoint.
    within = angle + jnp.where(angle < orbit.mesh.start[:1], period, 0)
    element, fraction = locate_in_lanes(orbit.mesh, within)
    powers = optimization_barrier(orbit.coefficients)
    state = horner([take(each, element) for each in powers], fraction)
    radius = radius_around(radial(motor), np.arange(count) / count)
    chamber = chamber_at(motor, cycle.reference_radius, angle, radius)
    state, radius, chamber = optimization_barrier((state, radius, chamber))
    piston = piston_state(cycle, angle, radius, chamber, state)
    return optimization_barrier(Waves(*(getattr(piston, name) for name in Waves._fields)))


def _folded(
    wave: Float[Array, "place lane"], phases: int, pistons: int
) -> Float[Array, "place_of_phase lane"]:
    """All pistons together, over the period that their sum has."""
    parts = wave.reshape(phases, -1, wave.shape[-1])
    return pistons // phases * jnp.sum(parts, axis=0)


def _power(wave: Float[Array, "place lane"], orders: int) -> Float[Array, " lane"]:
    """Sum of squared Fourier coefficients of orders 1 to `orders` of equidistant samples."""
    count = wave.shape[0]
    phase = 2 * pi / count * np.outer(np.arange(1, orders + 1), np.arange(count))
    transform = np.concatenate([np.cos(phase), np.sin(phase)]) / count
    return jnp.sum((jnp.asarray(transform) @ wave) ** 2, axis=0)


def _largest_sample(wave: Float[Array, "place lane"]) -> Float[Array, " lane"]:
    """Top of the parabolas through neighbouring samples of a periodic wave."""
    before, after = jnp.roll(wave, 1, axis=0), jnp.roll(wave, -1, axis=0)
    return jnp.max(vertex_value(before, wave, after), axis=0)


def _largest_part(samples: Float[Array, "point span lane"]) -> Float[Array, " lane"]:
    """The same within spans that nothing is smooth across."""
    return jnp.max(vertex_value(samples[:-2], samples[1:-1], samples[2:]), axis=(0, 1))


def _round(samples: Float[Array, "point span lane"], rule: np.ndarray) -> Float[Array, " lane"]:
    """Mean square round the cam, by a rule for each span."""
    return jnp.mean(jnp.tensordot(jnp.asarray(rule), samples**2, axes=1), axis=0)


def _largest(values: Float[Array, "4 element lane"]) -> Float[Array, " lane"]:
    """Largest value of the cubics through an element's start and its three points."""
    constant, first, second, third = element_powers(values[0], values[1:])
    # The slope's roots without cancellation; those outside the element do not count.
    linear, square = 2 * second, 3 * third
    discriminant = linear**2 - 4 * square * first
    turns = discriminant > 0
    root = jnp.where(turns, jnp.sqrt(jnp.where(turns, discriminant, 1)), 0)
    half = -(linear + jnp.where(linear < 0, -root, root)) / 2
    one = half / jnp.where(square == 0, 1, square)
    other = first / jnp.where(half == 0, 1, half)
    best = jnp.max(values, axis=0)
    # An extreme does not notice, to first order, where it is (envelope theorem).
    for place in (stop_gradient(one), stop_gradient(other)):
        inside = turns & (place > 0) & (place < 1)
        top = horner([constant, first, second, third], place)
        best = jnp.where(inside, jnp.maximum(best, top), best)
    return jnp.max(best, axis=0)

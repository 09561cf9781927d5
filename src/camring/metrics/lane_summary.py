"""The numbers of a data sheet for many motors side by side (`physics/lane_cycle.py`).

Integrals are taken with the collocation points' own quadrature, extremes from the
cubic through an element's start and its three points. Spectra come from places that
are the same in every lane, equally far apart: there the cam is a fixed combination
of control radii, only the pressure is looked up, and the Fourier coefficients are
one matrix product. Pistons are added by folding the period before it.
"""

from dataclasses import replace
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jax.lax import stop_gradient
from jaxtyping import Array, Float

from camring.geometry.contour import pressure_angle, undercut_factor
from camring.geometry.lane_cam import radius_around
from camring.metrics.cavitation import cavitation
from camring.metrics.power_balance import power_balance
from camring.metrics.spectrum import QuadratureSamples
from camring.metrics.summary import Measured, Metrics, results
from camring.numerics.extremum import vertex_value
from camring.numerics.lane_fourier import power_of_orders
from camring.numerics.lane_mesh import locate_round, positions
from camring.numerics.lanes import take
from camring.numerics.once import computed_once
from camring.numerics.quantity import Q
from camring.numerics.radau import STAGE_INTEGRALS, STAGES, element_powers, horner
from camring.physics.chamber import chamber_at
from camring.physics.cycle import Cycle
from camring.physics.lane_cycle import LaneCycle, operating_at, radial
from camring.physics.motor import Motor
from camring.physics.piston_state import PistonState, piston_state
from camring.physics.pressure import pressure_slope

PLACES = np.concatenate([[0.0], STAGES])
_BOOLE = np.array([14, 64, 24, 64, 28, 64, 24, 64, 14]) / 360
"""Boole's rule on two runs of five places, exact to degree five."""


def summarise_lanes(found: LaneCycle, highest_order: int = 600, oversampling: int = 12) -> Metrics:
    """Every result of every lane's cycle, leaves (lane,)."""
    cycle, cam = found.cycle, found.cam
    motor, point = cycle.motor, cycle.point
    samples = _at_collocation_points(found)
    piston = samples.piston
    around = _at_fixed_places(cycle, highest_order, oversampling)
    corners = _with_starts(cycle, piston)

    per_amount = 1 / cycle.fluid.content(point.supply_pressure)
    orders = highest_order // motor.cam.repeats
    of_sum = orders // motor.distinct_phases
    torque = _of_all_pistons(around.torque, motor)
    flow = _of_all_pistons(around.supply_flow * per_amount, motor)

    lowest, highest = cam.extremes()
    zero = jnp.zeros_like(lowest)
    least_pressure = -_largest(-corners.chamber_pressure)
    measured = Measured(
        power=replace(power_balance(cycle, samples), line_loss=zero),
        mean_torque=motor.pistons * samples.mean(piston.torque),
        mean_gauge_pressure=samples.mean(piston.chamber_pressure) - point.return_pressure,
        torque_power=power_of_orders(torque, of_sum),
        pressure_power=power_of_orders(around.chamber_pressure, orders),
        flow_power=power_of_orders(flow, of_sum),
        torque_span=_largest_sample(torque) + _largest_sample(-torque),
        lowest_radius=lowest,
        highest_radius=highest,
        rises=motor.cam.repeats * cam.rises(),
        mean_volume=samples.mean(piston.chamber.volume),
        lowest_pressure=least_pressure,
        highest_pressure=_largest(corners.chamber_pressure),
        supply_pressure_swing=zero,
        cavitation=cavitation(cycle, corners.chamber_pressure, least_pressure, PLACES),
        least_force=-_largest(-corners.force),
        most_stress=_largest(corners.contact_stress),
        least_undercut=-_largest_part(-undercut_factor(cam.radius, motor.roller.radius)),
        most_tilt=_largest_part(jnp.abs(pressure_angle(cam.radius))),
        steepest=_largest_part(jnp.abs(cam.radius.first)),
        most_bent=_largest_part(jnp.abs(cam.radius.second)),
        most_jerky=_largest_part(jnp.abs(cam.radius.third)),
        mean_square_jerk=_mean_square(cam.radius.third),
    )
    return results(cycle, measured)


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
    return computed_once(QuadratureSamples(piston, slope, weights))


def _with_starts(cycle: Cycle, piston: PistonState) -> Corners:
    start = cycle.orbit.mesh.start[None]
    radius, chamber = operating_at(cycle.motor, cycle.reference_radius, start)
    first = piston_state(cycle, start, radius, chamber, cycle.orbit.node_state[None])
    pairs = [
        jnp.concatenate([getattr(first, name), getattr(piston, name)]) for name in Corners._fields
    ]
    return computed_once(Corners(*pairs))


def _at_fixed_places(cycle: Cycle, highest_order: int, oversampling: int) -> Waves:
    motor, orbit, period = cycle.motor, cycle.orbit, cycle.motor.cam.period
    phases = motor.distinct_phases
    wanted = max(oversampling * (highest_order // motor.cam.repeats), 256)
    parts = 4 * phases  # so that sums of pistons, too, have parts to be split into
    count = parts * -(-wanted // parts)
    lanes = orbit.node_state.shape[-1]
    angle = jnp.broadcast_to(jnp.arange(count)[:, None] * (period / count), (count, lanes))
    element, fraction = locate_round(orbit.mesh, count, period)
    powers = computed_once(orbit.coefficients)
    state = horner([take(each, element) for each in powers], fraction)
    radius = radius_around(radial(motor), np.arange(count) / count)
    chamber = chamber_at(motor, cycle.reference_radius, angle, radius)
    state, radius, chamber = computed_once((state, radius, chamber))
    piston = piston_state(cycle, angle, radius, chamber, state)
    return computed_once(Waves(*(getattr(piston, name) for name in Waves._fields)))


def _of_all_pistons(
    wave: Float[Array, "place lane"], motor: Motor
) -> Float[Array, "place_of_phase lane"]:
    """All pistons together, over the period that their sum has."""
    phases = motor.distinct_phases
    parts = wave.reshape(phases, -1, wave.shape[-1])
    return motor.pistons // phases * jnp.sum(parts, axis=0)


def _largest_sample(wave: Float[Array, "place lane"]) -> Float[Array, " lane"]:
    """Top of the parabolas through neighbouring samples of a periodic wave."""
    before, after = jnp.roll(wave, 1, axis=0), jnp.roll(wave, -1, axis=0)
    return jnp.max(vertex_value(before, wave, after), axis=0)


def _largest_part(samples: Float[Array, "point span lane"]) -> Float[Array, " lane"]:
    """The same within spans that nothing is smooth across."""
    return jnp.max(vertex_value(samples[:-2], samples[1:-1], samples[2:]), axis=(0, 1))


def _mean_square(samples: Float[Array, "point span lane"]) -> Float[Array, " lane"]:
    """Round the cam, by Boole's rule in each span."""
    return jnp.mean(jnp.tensordot(jnp.asarray(_BOOLE), samples**2, axes=1), axis=0)


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

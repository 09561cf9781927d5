"""Ripples of many motors side by side: how strong their waves are, order by order.

Either waves are sampled at places that are the same in every member, equally far apart:
there the cam is a fixed combination of control radii and only the pressure is taken from
the elements. Fast, and good where waves are smooth. Or they are integrated on the
elements first (`numerics/batch_integral.py`): for windows that open at a crawl, where
flows jump. Pistons are added by folding the period.
"""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from camring.geometry.batch_cam import radius_around
from camring.metrics.batch_torque import torque_span
from camring.numerics.batch import take
from camring.numerics.batch_fourier import power_of_orders
from camring.numerics.batch_integral import INTEGRATIONS, integrated_samples
from camring.numerics.batch_mesh import locate_round
from camring.numerics.compilation import computed_once
from camring.numerics.extremum import vertex_value
from camring.numerics.quantity import Q
from camring.numerics.radau import horner
from camring.numerics.selection import largest
from camring.physics.batch_cycle import radial
from camring.physics.chamber import chamber_at
from camring.physics.cycle import Cycle
from camring.physics.motor import Motor
from camring.physics.piston_state import PistonState, piston_state

FEWEST = 256
"""Places round the period, at least."""


class Waves(NamedTuple):
    """What spectra are taken of, of one piston."""

    torque: Q[Float[Array, "*grid batch"], "N.m"]
    supply_flow: Float[Array, "*grid batch"]
    return_flow: Float[Array, "*grid batch"]
    chamber_pressure: Q[Float[Array, "*grid batch"], "Pa"]


class Spectra(NamedTuple):
    """Sums of squared amplitudes over the orders that count, shape (batch,)."""

    torque: Q[Float[Array, " batch"], "N2.m2"]
    """Of all pistons, as the flows are."""
    supply_flow: Q[Float[Array, " batch"], "m6/s2"]
    return_flow: Q[Float[Array, " batch"], "m6/s2"]
    chamber_pressure: Q[Float[Array, " batch"], "Pa2"]
    torque_span: Q[Float[Array, " batch"], "N.m"]
    """From the lowest to the highest torque on the shaft."""


def sampled_spectra(cycle: Cycle, highest_order: int, oversampling: int) -> Spectra:
    """Of waves sampled so many times for each order."""
    count = _places(cycle.motor, highest_order, oversampling)
    piston = piston_around(cycle, count)
    around = computed_once(Waves(*(getattr(piston, name) for name in Waves._fields)))
    shaft = of_all_pistons(around.torque, cycle.motor)
    span = _largest_sample(shaft) + _largest_sample(-shaft)
    return _spectra(cycle, around, span, highest_order, 0)


def integrated_spectra(
    cycle: Cycle, waves: Waves, highest_order: int, oversampling: int
) -> Spectra:
    """Of waves on elements, their integrals sampled so many times for each order.

    Parameters
    ----------
    waves
        Shape (4, element, batch), at an element's start and its collocation points.
    """
    motor, mesh = cycle.motor, cycle.orbit.mesh
    period = motor.cam.period
    count = _places(motor, highest_order, oversampling)
    around = Waves(*integrated_samples(list(waves), mesh, period, count))
    span = torque_span(cycle, waves.torque)
    return _spectra(cycle, around, span, highest_order, INTEGRATIONS)


def _spectra(
    cycle: Cycle,
    around: Waves,
    torque_span: Float[Array, " batch"],
    highest_order: int,
    derivative: int,
) -> Spectra:
    motor, fluid, point = cycle.motor, cycle.fluid, cycle.point
    orders = highest_order // motor.cam.repeats
    # The sum of pistons has a period of its own, in which its orders are counted.
    own = float(motor.distinct_phases**derivative)

    def of_all(wave: Float[Array, "place batch"]) -> Float[Array, " batch"]:
        summed = own * of_all_pistons(wave, motor)
        return power_of_orders(summed, orders // motor.distinct_phases, derivative)

    return Spectra(
        torque=of_all(around.torque),
        supply_flow=of_all(around.supply_flow / fluid.content(point.supply_pressure)),
        return_flow=of_all(around.return_flow / fluid.content(point.return_pressure)),
        chamber_pressure=power_of_orders(around.chamber_pressure, orders, derivative),
        torque_span=torque_span,
    )


def _places(motor: Motor, highest_order: int, oversampling: int) -> int:
    """So many that sums of pistons, too, have parts to be split into."""
    wanted = max(oversampling * (highest_order // motor.cam.repeats), FEWEST)
    parts = 4 * motor.distinct_phases
    return parts * -(-wanted // parts)


def piston_around(cycle: Cycle, count: int, ahead: float = 0.0) -> PistonState:
    """The reference piston at places round the period, equally far apart, arrays (place, batch).

    Parameters
    ----------
    ahead
        Where the first of them lies, in steps from angle 0, from 0 up to 1.
    """
    motor, orbit, period = cycle.motor, cycle.orbit, cycle.motor.cam.period
    members, step = orbit.node_state.shape[-1], period / count
    fraction = (np.arange(count) + ahead) / count
    angle = jnp.broadcast_to(jnp.asarray(fraction * period)[:, None], (count, members))
    if ahead:
        # Places a part of a step on, in a mesh that has been moved the other part of it.
        moved = orbit.mesh._replace(start=orbit.mesh.start + (1 - ahead) * step)
        both = locate_round(moved, count, period)
        element, within = (jnp.roll(each, -1, axis=0) for each in both)
    else:
        element, within = locate_round(orbit.mesh, count, period)
    powers = computed_once(orbit.coefficients)
    state = horner([take(each, element) for each in powers], within)
    radius = radius_around(radial(motor), fraction)
    chamber = chamber_at(motor, cycle.reference_radius, angle, radius)
    state, radius, chamber = computed_once((state, radius, chamber))
    return piston_state(cycle, angle, radius, chamber, state)


def of_all_pistons(
    wave: Float[Array, "place *batch"], motor: Motor
) -> Float[Array, "place_of_phase *batch"]:
    """All pistons together, over the period that their sum has."""
    phases = motor.distinct_phases
    parts = wave.reshape(phases, -1, *wave.shape[1:])
    return motor.pistons // phases * jnp.sum(parts, axis=0)


def _largest_sample(wave: Float[Array, "place batch"]) -> Float[Array, " batch"]:
    """Top of the parabolas through neighbouring samples of a periodic wave."""
    before, after = jnp.roll(wave, 1, axis=0), jnp.roll(wave, -1, axis=0)
    return largest(vertex_value(before, wave, after), axis=0)

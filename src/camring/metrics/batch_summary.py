"""The numbers of a data sheet for many motors side by side (`physics/batch_cycle.py`).

Integrals are taken with the collocation points' own quadrature, extremes from the
cubic through an element's start and its three points, spectra are `batch_spectra.py`.
"""

from dataclasses import replace
from typing import NamedTuple, TypeVar

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from camring.geometry.batch_cam import RoundTheCam
from camring.geometry.contour import pressure_angle, undercut_factor
from camring.metrics.batch_spectra import Waves, integrated_spectra, sampled_spectra
from camring.metrics.cavitation import cavitation
from camring.metrics.displacement import driving
from camring.metrics.power_balance import power_balance
from camring.metrics.rating_life import Endured, endured
from camring.metrics.summary import Measured, Metrics, results
from camring.numerics.batch_extremum import highest_of_cubics, highest_of_samples
from camring.numerics.compilation import computed_once
from camring.numerics.extremum import vertex_value
from camring.numerics.quantity import Q
from camring.numerics.radau import STAGES, combine
from camring.numerics.selection import largest
from camring.physics.batch_cycle import BatchCycle, operating_at
from camring.physics.cycle import Cycle
from camring.physics.heat.collocation import at_collocation_points
from camring.physics.motor import Motor
from camring.physics.piston_state import PistonState, piston_state

PLACES = np.concatenate([[0.0], STAGES])
_BOOLE = np.array([7, 32, 12, 32, 7]) / 90
"""Boole's rule on five places, exact to degree five."""

_THIRDS_TO_POWERS = np.linalg.inv(np.vander(np.arange(4) / 3, increasing=True))


def summarise_batch(
    found: BatchCycle, highest_order: int = 600, oversampling: int = 12, integrated: bool = False
) -> Metrics:
    """Every result of every member's cycle, leaves (batch,).

    Parameters
    ----------
    integrated
        Whether spectra are those of waves integrated before they are sampled.
    """
    cycle, cam = found.cycle, found.cam
    motor, point = cycle.motor, cycle.point
    samples = computed_once(at_collocation_points(found))
    piston = samples.piston
    starts = at_starts(cycle)
    corners = with_starts(Corners, starts, piston)
    if integrated:
        waves = with_starts(Waves, starts, piston)
        spectra = integrated_spectra(cycle, waves, highest_order, oversampling)
    else:
        spectra = sampled_spectra(cycle, highest_order, oversampling)

    lowest, highest = cam.extremes()
    zero = jnp.zeros_like(lowest)
    least_pressure = -highest_of_samples(-corners.chamber_pressure)
    measured = Measured(
        power=replace(power_balance(cycle, samples), line_loss=zero, return_line_loss=zero),
        mean_torque=motor.pistons * samples.mean(piston.torque),
        mean_gauge_pressure=samples.mean(piston.chamber_pressure) - point.return_pressure,
        torque_power=spectra.torque,
        pressure_power=spectra.chamber_pressure,
        flow_power=spectra.supply_flow,
        return_flow_power=spectra.return_flow,
        torque_span=spectra.torque_span,
        lowest_radius=lowest,
        highest_radius=highest,
        rises=motor.cam.repeats * cam.rises(_fed(motor, cam)),
        mean_volume=samples.mean(piston.chamber.volume),
        lowest_pressure=least_pressure,
        highest_pressure=highest_of_samples(corners.chamber_pressure),
        supply_pressure_swing=zero,
        return_pressure_swing=zero,
        cavitation=cavitation(cycle, corners.chamber_pressure, least_pressure, PLACES),
        least_force=-highest_of_samples(-corners.force),
        most_stress=highest_of_samples(corners.contact_stress),
        endured=Endured(*map(samples.mean, endured(piston, motor))),
        least_undercut=-_largest_part(-undercut_factor(cam.radius, motor.roller.radius)),
        most_tilt=_largest_part(jnp.abs(pressure_angle(cam.radius))),
        steepest=_largest_part(jnp.abs(cam.radius.first)),
        most_bent=_largest_part(jnp.abs(cam.radius.second)),
        most_jerky=_largest_part(jnp.abs(cam.radius.third)),
        mean_square_jerk=_mean_square(cam.radius.third),
    )
    return results(cycle, measured)


def _fed(motor: Motor, cam: RoundTheCam) -> Float[Array, "span batch"] | None:
    """One for each of the cam's spans on a lobe that is fed; None where no lobe idles."""
    if not motor.valve_plate.idle_lobes:
        return None
    count, spacing = cam.radius.value.shape[1], motor.cam.period / cam.radius.value.shape[1]
    middle = spacing * (np.arange(count) + 0.5 - (motor.cam.degree + 1) / 2)
    many = jnp.broadcast_to(middle[:, None], (count, cam.radius.value.shape[-1]))
    return driving(motor.valve_plate, many)


class Corners(NamedTuple):
    """What extremes are taken of, at an element's start and its collocation points."""

    chamber_pressure: Q[Float[Array, "4 element batch"], "Pa"]
    force: Q[Float[Array, "4 element batch"], "N"]
    contact_stress: Q[Float[Array, "4 element batch"], "Pa"]


def at_starts(cycle: Cycle) -> PistonState:
    """The reference piston where every element begins, arrays (1, element, batch)."""
    start = cycle.orbit.mesh.start[None]
    radius, chamber = operating_at(cycle.motor, cycle.reference_radius, start)
    return piston_state(cycle, start, radius, chamber, cycle.orbit.node_state[None])


Kind = TypeVar("Kind", Corners, Waves)


def with_starts(kind: type[Kind], starts: PistonState, piston: PistonState) -> Kind:
    """What a kind names, at an element's start and its collocation points."""
    pairs = [
        jnp.concatenate([getattr(starts, name), getattr(piston, name)]) for name in kind._fields
    ]
    return computed_once(kind(*pairs))


def _largest_part(samples: Float[Array, "point span batch"]) -> Float[Array, " batch"]:
    """The same within spans that nothing is smooth across, from equidistant samples.

    By cubics where the parts of a span divide by three, else by parabolas.
    """
    if (len(samples) - 1) % 3:
        return largest(vertex_value(samples[:-2], samples[1:-1], samples[2:]), axis=(0, 1))
    four = [samples[:-1:3], samples[1::3], samples[2::3], samples[3::3]]
    powers = [combine(row, four) for row in _THIRDS_TO_POWERS]
    return highest_of_cubics([each.reshape(-1, each.shape[-1]) for each in powers])


def _mean_square(samples: Float[Array, "point span batch"]) -> Float[Array, " batch"]:
    """Round the cam, by Boole's rule on runs of five places in each span."""
    runs = (len(samples) - 1) // (len(_BOOLE) - 1)
    weights = np.zeros(len(samples))
    for run in range(runs):
        first = run * (len(_BOOLE) - 1)
        weights[first : first + len(_BOOLE)] += _BOOLE / runs
    return jnp.mean(jnp.tensordot(jnp.asarray(weights), samples**2, axes=1), axis=0)

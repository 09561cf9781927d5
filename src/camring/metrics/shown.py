"""All that is shown of one operating point: results, waveforms and orders, in one function."""

from dataclasses import fields
from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.geometry.contour import undercut_factor
from camring.metrics.spectrum import order_spectrum
from camring.metrics.summary import Metrics, summarise
from camring.physics.cycle import Cycle
from camring.physics.piston_state import sample_angles
from camring.physics.waves.waveforms import sum_over_pistons

METRICS = tuple(each.name for each in fields(Metrics))

SAMPLES = 480  # of a lobe
MOST_SAMPLES = 2880
ORDERS = 12


class Waves(NamedTuple):
    """Over one period of the cam, SI; shaft torque with it, for it repeats sooner."""

    radius: Float[Array, " angle"]
    slope: Float[Array, " angle"]
    pressure: Float[Array, " angle"]
    volume: Float[Array, " angle"]
    supply_opening: Float[Array, " angle"]
    return_opening: Float[Array, " angle"]
    stress: Float[Array, " angle"]
    force: Float[Array, " angle"]
    undercut: Float[Array, " angle"]
    torque: Float[Array, " angle"]
    torque_orders: Float[Array, " order"]
    """Peak amplitudes of the shaft's torque, N m, at multiples of the surviving order."""
    flow_orders: Float[Array, " order"]


def sampled(cycle: Cycle, angle: Float[Array, " angle"], highest_order: int) -> Waves:
    """The reference piston at shaft angles of one period, and the orders of the whole motor."""
    motor = cycle.motor
    piston = sample_angles(cycle, angle)
    plate = motor.valve_plate
    orders = order_spectrum(cycle, highest_order)
    step, first = motor.cam.repeats, motor.surviving_order
    at = jnp.arange(first, highest_order + 1, first)[:ORDERS] // step - 1
    return Waves(
        radius=piston.radius.value,
        slope=piston.radius.first,
        pressure=piston.chamber_pressure,
        volume=piston.chamber.volume,
        supply_opening=plate.opening(plate.supply, angle),
        return_opening=plate.opening(plate.return_, angle),
        stress=piston.contact_stress,
        force=piston.contact_force,
        undercut=undercut_factor(piston.radius, motor.roller.radius),
        torque=sum_over_pistons(cycle, lambda at: sample_angles(cycle, at).torque, angle),
        torque_orders=orders.torque[at],
        flow_orders=orders.supply_flow[at],
    )


class Seen(NamedTuple):
    """One operating point.

    Attributes
    ----------
    row
        Every result in the order of `METRICS`, SI, then the verdict's code: one array, for each
        way out of JAX costs as much as a result.
    """

    row: Float[Array, " metric"]
    waves: Waves


def seen(cycle: Cycle, angle: Float[Array, " angle"], harmonics: int, highest_order: int) -> Seen:
    """All of it; `harmonics` as in `summarise`."""
    found = summarise(cycle, harmonics)
    numbers = [getattr(found, name) for name in METRICS]
    row = jnp.stack([*numbers, cycle.verdict.code.astype(float)])
    return Seen(row, sampled(cycle, angle, highest_order))


def sample_count(lobes_in_period: int) -> int:
    """Angles over one period, both ends among them."""
    return min(SAMPLES * lobes_in_period, MOST_SAMPLES) + 1

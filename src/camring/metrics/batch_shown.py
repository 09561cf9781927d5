"""What `shown.py` shows of an operating point, for many side by side (`physics/batch_cycle.py`)."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.geometry.contour import undercut_factor
from camring.metrics.batch_spectra import piston_around
from camring.metrics.batch_summary import summarise_batch
from camring.metrics.shown import METRICS
from camring.physics.batch_cycle import BatchResolution
from camring.physics.heat.batch_simulation import simulate_batch
from camring.physics.motor import Motor
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint

OF_ONE_PISTON = (
    "radius",
    "slope",
    "pressure",
    "volume",
    "supply_opening",
    "return_opening",
    "stress",
    "force",
    "undercut",
    "torque",
    "supply_flow",
)
"""Waves in the order of `SeenBatch`; torque and flow are those of the reference piston alone."""


class SeenBatch(NamedTuple):
    """Many motors, each with its oil at its operating point.

    Attributes
    ----------
    rows
        Every result in the order of `METRICS`, SI, then the verdict's code.
    waves
        `OF_ONE_PISTON` at places round the cam's period, equally far apart from angle 0 on, SI.
    """

    rows: Float[Array, "metric batch"]
    waves: Float[Array, "wave place batch"]


def seen_batch(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    harmonics: int,
    count: int,
    resolution: BatchResolution,
) -> SeenBatch:
    """Simulated, summarised and sampled.

    Parameters
    ----------
    motor, fluid, point
        Leaves (..., batch), of motors that `physics.batch_cycle.fits`.
    harmonics
        As in `summarise`.
    count
        Places round the period.
    """
    found = simulate_batch(motor, fluid, point, resolution)
    cycle = found.cycle
    results = summarise_batch(found, harmonics, resolution.oversampling, resolution.integrated)
    code = cycle.verdict.code.astype(float)
    piston = piston_around(cycle, count)
    plate = cycle.motor.valve_plate
    waves = (
        piston.radius.value,
        piston.radius.first,
        piston.chamber_pressure,
        piston.chamber.volume,
        plate.opening(plate.supply, piston.angle),
        plate.opening(plate.return_, piston.angle),
        piston.contact_stress,
        piston.contact_force,
        undercut_factor(piston.radius, cycle.motor.roller.radius),
        piston.torque,
        piston.supply_flow / cycle.fluid.content(cycle.point.supply_pressure),
    )
    rows = [*(getattr(results, name) for name in METRICS), code]
    return SeenBatch(jnp.stack(rows), jnp.stack(waves))

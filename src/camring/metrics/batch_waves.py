"""What many motors show at ports and shaft, side by side: means and waves over an angle."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from camring.metrics.batch_spectra import of_all_pistons, piston_around
from camring.numerics.compilation import computed_once
from camring.numerics.quantity import Q
from camring.numerics.selection import smallest
from camring.physics.batch_cycle import BatchResolution
from camring.physics.heat.batch_simulation import simulate_batch
from camring.physics.heat.collocation import at_collocation_points
from camring.physics.motor import Motor
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint
from camring.physics.waves.port_waves import of_one_piston


class Shown(NamedTuple):
    """Torque, supply, return and case flow (`physics.waves.port_waves`) of all pistons together."""

    means: Float[Array, "4 batch"]
    waves: Float[Array, "4 angle batch"]
    """Over the period that the sum of all pistons has."""
    faults: Int[Array, " batch"]
    lowest_pressure: Q[Float[Array, " batch"], "Pa"]
    least_force: Q[Float[Array, " batch"], "N"]


def simulate_shown(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    count: int,
    ahead: float,
    resolution: BatchResolution,
) -> Shown:
    """Many motors, each with its oil at its operating point.

    Parameters
    ----------
    motor, fluid, point
        Leaves (..., batch), of motors that `physics.batch_cycle.fits`.
    count, ahead
        Angles in a period of the sum, and where the first of them lies, in steps from 0.
    """
    found = simulate_batch(motor, fluid, point, resolution)
    cycle = found.cycle
    samples = computed_once(at_collocation_points(found))
    shares = of_one_piston(cycle, samples.piston)
    means = [cycle.motor.pistons * samples.mean(share) for share in shares]
    around = piston_around(cycle, count * cycle.motor.distinct_phases, ahead)
    waves = [of_all_pistons(wave, cycle.motor) for wave in of_one_piston(cycle, around)]
    return Shown(
        jnp.stack(means),
        jnp.stack(waves),
        cycle.verdict.code,
        smallest(samples.piston.chamber_pressure, axis=(0, 1)),
        smallest(samples.piston.force, axis=(0, 1)),
    )

"""A motor simulated at places of a table: means and waves of torque and flows."""

from dataclasses import dataclass, replace
from math import ceil, log2, pi

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from camring.evaluation.simulations import in_chunks, of_one, on_all_cores, repeated
from camring.metrics.batch_waves import simulate_shown
from camring.physics.batch_cycle import BatchResolution, fits
from camring.physics.cycle import Cycle
from camring.physics.mirror import mirrored
from camring.physics.motor import Motor
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint
from camring.physics.piston_state import quadrature_samples
from camring.physics.waves.port_waves import of_one_piston, port_waves
from camring.programs.batch_program import BatchProgram
from camring.programs.compiled import simulate_compiled
from camring.programs.motor_program import motor_program

__all__ = ["Found", "angles_of", "simulated_places"]

IN_A_PITCH = 2048
"""Samples of one lobe pitch, which all pistons' phases share."""
FEWEST_ANGLES = 128

RESOLUTION = BatchResolution.fine()

_side_by_side = BatchProgram(simulate_shown)


@dataclass(frozen=True, eq=False)
class Found:
    """Simulations at places (speed, drop, low); speeds signed."""

    means: Float[np.ndarray, "place 4"]
    waves: Float[np.ndarray, "place 4 angle"]
    faults: np.ndarray
    lowest_pressure: np.ndarray
    least_force: np.ndarray

    def at(self, which: np.ndarray) -> "Found":
        return Found(*(each[which] for each in vars(self).values()))


def angles_of(motor: Motor) -> int:
    """Samples of one period of the ripple."""
    wanted = IN_A_PITCH * (motor.lobes // motor.cam.repeats) / motor.distinct_phases
    return max(FEWEST_ANGLES, 2 ** ceil(log2(wanted)))


def simulated_places(
    motor: Motor,
    fluid: AbstractFluid,
    case_pressure: float,
    places: Float[np.ndarray, "place 3"],
    count: int,
    ahead: float = 0.0,
) -> Found:
    """Means and waves at places (speed, drop, low); negative speeds by the mirror image.

    Parameters
    ----------
    count
        Angles at which waves are sampled, equal steps of one period of the ripple.
    ahead
        Where the first of them lies, in steps from angle 0.
    """
    speed, drop, low = places.T
    lower = case_pressure + low
    points = OperatingPoint(
        shaft_speed=np.abs(speed),
        supply_pressure=lower + np.maximum(drop, 0),
        return_pressure=lower + np.maximum(-drop, 0),
        case_pressure=np.full_like(low, case_pressure),
        weight=np.ones_like(low),
    )
    parts = []
    for backwards in (False, True):
        chosen = np.flatnonzero((places[:, 0] < 0) == backwards)
        if not len(chosen):
            continue
        some = jax.tree.map(lambda leaf, c=chosen: np.asarray(leaf)[c], points)
        if backwards:
            # Seen in a mirror the angles count the other way: -(k + a) = -(k + 1) + (1 - a).
            part = _simulated(mirrored(motor), fluid, some, count, 1 - ahead if ahead else 0.0)
            part = _turned_back(part, bool(ahead))
        else:
            part = _simulated(motor, fluid, some, count, ahead)
        parts.append((chosen, part))
    order = np.argsort(np.concatenate([chosen for chosen, _ in parts]))
    joined = [
        np.concatenate(leaves)[order]
        for leaves in zip(*(vars(part).values() for _, part in parts), strict=True)
    ]
    return Found(*joined)


def _turned_back(part: Found, beyond: bool) -> Found:
    """The mirror image's torque acts the other way, and its angles count the other way."""
    sign = np.array([-1.0, 1.0, 1.0, 1.0])
    count = part.waves.shape[-1]
    opposite = (-np.arange(count) - int(beyond)) % count
    waves = part.waves[..., opposite]
    return replace(part, means=part.means * sign, waves=waves * sign[:, None])


def _simulated(
    motor: Motor, fluid: AbstractFluid, points: OperatingPoint, count: int, ahead: float
) -> Found:
    """Forwards; side by side where that can be, one by one what has a fault there."""
    places = len(points.shaft_speed)
    angle = (np.arange(count) + ahead) * (2 * pi / motor.surviving_order / count)

    def alone(which: np.ndarray) -> list[tuple]:
        def one(place: int) -> tuple:
            cycle = simulate_compiled(motor, fluid, of_one(points, place))
            means, waves, *least = jax.device_get(_shown(cycle, jnp.asarray(angle)))
            return means, waves, np.asarray(cycle.verdict.code), *least

        return on_all_cores(one, which.tolist())

    if not fits(motor):
        return Found(*(np.stack(each) for each in zip(*alone(np.arange(places)), strict=True)))

    def together(some: tuple) -> tuple:
        motors, fluids, here = some
        return tuple(jax.device_get(_side_by_side(motors, fluids, here, count, ahead, RESOLUTION)))

    given = repeated(motor, places), repeated(fluid, places), points
    found = [np.moveaxis(each, -1, 0) for each in in_chunks(together, given)]
    again = np.flatnonzero(found[2])
    for place, better in zip(again, alone(again), strict=True):
        for kept, value in zip(found, better, strict=True):
            kept[place] = value
    return Found(*found)


@motor_program
def _shown(cycle: Cycle, angle: Array) -> tuple[Array, ...]:
    samples = quadrature_samples(cycle)
    shares = of_one_piston(cycle, samples.piston)
    means = jnp.stack([cycle.motor.pistons * samples.mean(wave) for wave in shares])
    waves = jnp.stack(port_waves(cycle, angle))
    piston = samples.piston
    return means, waves, jnp.min(piston.chamber_pressure), jnp.min(piston.force)

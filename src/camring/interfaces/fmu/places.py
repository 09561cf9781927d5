"""A motor simulated at places of a table: means and waves of torque and flows."""

from dataclasses import dataclass, replace
from math import ceil, log2, pi

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from camring.interfaces.motor_program import motor_program
from camring.metrics.spectrum import quadrature_samples
from camring.physics.cycle import simulate
from camring.physics.fluid import AbstractFluid
from camring.physics.mirror import mirrored
from camring.physics.motor import Motor
from camring.physics.operating_point import OperatingPoint
from camring.physics.port_waves import of_one_piston, port_waves
from camring.physics.resolution import Resolution

__all__ = ["Found", "angles_of", "simulated_places"]

IN_A_PITCH = 2048
"""Samples of one lobe pitch, which all pistons' phases share."""
FEWEST_ANGLES = 128
CHUNK = 64


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
    angle = (np.arange(count) + ahead) * (2 * pi / motor.surviving_order / count)
    speed, drop, low = (jnp.asarray(each) for each in places.T)
    lower = case_pressure + low
    points = OperatingPoint(
        shaft_speed=jnp.abs(speed),
        supply_pressure=lower + jnp.maximum(drop, 0),
        return_pressure=lower + jnp.maximum(-drop, 0),
        case_pressure=jnp.full_like(low, case_pressure),
        weight=jnp.ones_like(low),
    )
    parts = []
    for backwards in (False, True):
        chosen = np.flatnonzero((places[:, 0] < 0) == backwards)
        if not len(chosen):
            continue
        own, at = (mirrored(motor), -angle) if backwards else (motor, angle)
        some = jax.tree.map(lambda leaf, c=chosen: leaf[c], points)
        part = _in_chunks(own, fluid, some, at)
        parts.append((chosen, _turned_back(part) if backwards else part))
    order = np.argsort(np.concatenate([chosen for chosen, _ in parts]))
    joined = [
        np.concatenate(leaves)[order]
        for leaves in zip(*(vars(part).values() for _, part in parts), strict=True)
    ]
    return Found(*joined)


def _turned_back(part: Found) -> Found:
    """The mirror image's torque acts the other way."""
    sign = np.array([-1.0, 1.0, 1.0, 1.0])
    return replace(part, means=part.means * sign, waves=part.waves * sign[:, None])


def _in_chunks(
    motor: Motor, fluid: AbstractFluid, points: OperatingPoint, angle: np.ndarray
) -> Found:
    count = len(points.shaft_speed)
    parts = []
    for start in range(0, count, CHUNK):
        chosen = np.minimum(np.arange(start, start + CHUNK), count - 1)
        chunk = jax.tree.map(lambda leaf, c=chosen: jnp.asarray(leaf)[c], points)
        parts.append(jax.device_get(_cycles(motor, fluid, chunk, jnp.asarray(angle))))
    return Found(*(np.concatenate(leaves)[:count] for leaves in zip(*parts, strict=True)))


@motor_program
def _cycles(motor: Motor, fluid: AbstractFluid, points: OperatingPoint, angle: Array) -> tuple:
    def one(point: OperatingPoint) -> tuple[Array, ...]:
        cycle = simulate(motor, fluid, point, Resolution())
        samples = quadrature_samples(cycle)
        shares = of_one_piston(cycle, samples.piston)
        means = jnp.stack([motor.pistons * samples.mean(wave) for wave in shares])
        waves = jnp.stack(port_waves(cycle, angle))
        piston = samples.piston
        least = jnp.min(piston.chamber_pressure), jnp.min(piston.force)
        return means, waves, cycle.verdict.code, *least

    return jax.vmap(one)(points)

"""The table of a motor: which operating points, their simulation, and the error between."""

from dataclasses import dataclass, field, replace
from math import ceil, log2, pi

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from camring.interfaces.config import MotorFile
from camring.interfaces.errors import InputError
from camring.interfaces.fmu.axes import BAR, RPM, Axes
from camring.interfaces.fmu.table import QUANTITIES, Table
from camring.metrics.spectrum import quadrature_samples
from camring.numerics.verdict import Verdict
from camring.physics.cycle import simulate
from camring.physics.fluid import AbstractFluid
from camring.physics.mirror import has_mirror_image, mirrored
from camring.physics.motor import Motor
from camring.physics.operating_point import OperatingPoint
from camring.physics.port_waves import of_one_piston, port_waves
from camring.physics.resolution import Resolution

__all__ = ["Errors", "Filled", "angles_of", "filled_table", "simulated_places"]

ROUND_THE_CAM = 2048
"""Samples of one period of the cam, which all pistons' phases share."""
FEWEST_ANGLES = 128
CHUNK = 64
MOST_HELD_OUT = 512


@dataclass(frozen=True)
class Errors:
    """How far the table strays from the simulation half-way between its points and angles.

    For each of torque, supply, return and case flow, as shares of its largest
    absolute mean (`mean`) or value (`rms`, `most`) in the table, worst of all places.
    """

    mean: tuple[float, ...]
    rms: tuple[float, ...]
    most: tuple[float, ...]
    places: int

    def figures(self) -> dict[str, float]:
        """All of them by name."""
        kinds = {"mean": self.mean, "rms": self.rms, "most": self.most}
        return {
            f"{name}_{kind}_error": value
            for kind, values in kinds.items()
            for name, value in zip(QUANTITIES, values, strict=True)
        }

    def sentences(self) -> list[str]:
        """One for each quantity."""
        return [
            f"{name.replace('_', ' ')}: mean {100 * mean:.2g} %, rms of the wave "
            f"{100 * rms:.2g} %, worst instant {100 * most:.2g} %"
            for name, mean, rms, most in zip(
                QUANTITIES, self.mean, self.rms, self.most, strict=True
            )
        ]


@dataclass(frozen=True)
class Filled:
    """A table with what should be known about it."""

    table: Table
    errors: Errors
    case_pressure: float
    wave_mean_error: tuple[float, ...]
    """Means of the waves' samples against exact means, as shares of the largest mean."""
    warnings: list[str] = field(default_factory=list)


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


def filled_table(file: MotorFile, axes: Axes) -> Filled:
    """Simulates a motor at the axes' points and half-way between.

    Raises
    ------
    InputError
        Where a point with speed and pressure drop of the motor's own sign has no
        periodic solution.
    """
    motor, fluid, case = file.system.motor, file.system.fluid, axes.case_pressure
    speeds, drops, warnings = axes.speeds, axes.drops, []
    if has_mirror_image(motor):
        speeds = np.concatenate([-speeds[::-1], speeds])
    else:
        warnings.append(
            "Only forward speeds are in the table: a relief notch lies at the opening edge, and "
            "backwards it would lie at the closing edge, which no law here describes."
        )
    drops = np.concatenate([-drops[:0:-1], drops])
    places = _grid(speeds, drops, axes.lows)
    found = simulated_places(motor, fluid, case, places, angles_of(motor))
    if found.faults.any():
        places, found, drops = _motoring_only(places, found, drops, warnings)
    shape = (len(speeds), len(drops), len(axes.lows))
    table = Table(
        speeds,
        drops,
        axes.lows,
        found.means.reshape(*shape, -1),
        found.waves.reshape(*shape, len(QUANTITIES), -1),
        motor.surviving_order,
    )
    warnings += _beyond_the_model(places, found, float(fluid.vapour_pressure))
    scale = np.abs(found.means).max(axis=0)
    wave_error = np.abs(found.waves.mean(axis=-1) - found.means).max(axis=0) / scale
    errors = _errors(motor, fluid, case, table)
    return Filled(table, errors, case, tuple(map(float, wave_error)), warnings)


def angles_of(motor: Motor) -> int:
    """Samples of one period of the ripple."""
    wanted = ROUND_THE_CAM / motor.distinct_phases
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


@eqx.filter_jit
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


def _grid(*axes: np.ndarray) -> Float[np.ndarray, "place axis"]:
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))


def _motoring_only(
    places: np.ndarray, found: Found, drops: np.ndarray, warnings: list[str]
) -> tuple[np.ndarray, Found, np.ndarray]:
    """Without the negative pressure drops, which only some motors can be simulated at.

    Raises
    ------
    InputError
        When the others have faults as well.
    """
    kept = places[:, 1] >= 0
    broken = np.flatnonzero(kept & (found.faults != 0))
    if len(broken):
        speed, drop, low = places[broken[0]]
        why = Verdict(jnp.asarray(found.faults[broken[0]])).explain()
        raise InputError(
            "the table",
            f"has {len(broken)} of {np.count_nonzero(kept)} points without a result, the first at "
            f"{speed / RPM:.4g} rpm, a pressure drop of {drop / BAR:.4g} bar and {low / BAR:.4g} "
            f"bar of the lower port above the case: {why}",
            "narrow --speed, --pressure or --low-pressure",
        )
    warnings.append(
        "Only positive pressure drops are in the table: where the return port is the higher one, "
        f"{np.count_nonzero(found.faults)} points have no periodic solution."
    )
    return places[kept], found.at(kept), drops[drops >= 0]


def _beyond_the_model(places: np.ndarray, found: Found, vapour: float) -> list[str]:
    """Where the numbers of the table leave what the model describes, driving and braking."""
    speed, drop, _ = places.T
    drives = speed * drop > 0
    said = []
    for where, name in ((drives, "Driving"), (speed * drop < 0, "Braking")):
        for unsound, what in (
            (found.least_force < 0, "the roller lifts off the ring"),
            (found.lowest_pressure < vapour, "the oil would cavitate"),
        ):
            hit = where & unsound
            if hit.any():
                slow, fast = np.abs(speed[hit]).min() / RPM, np.abs(speed[hit]).max() / RPM
                said.append(
                    f"{name}, {what} for a part of the cycle at {np.count_nonzero(hit)} of "
                    f"{np.count_nonzero(where)} points, which the table takes no notice of: "
                    f"{slow:.3g} to {fast:.3g} rpm, pressure drops up to "
                    f"{np.abs(drop[hit]).max() / BAR:.3g} bar."
                )
    return said


def _errors(motor: Motor, fluid: AbstractFluid, case: float, table: Table) -> Errors:
    """Half-way between neighbouring points, along all axes at once."""
    between = [_middles(axis) for axis in table.axes]
    # Between the slowest speeds of both directions lies no steady state to compare with.
    crossing = (table.speed[:-1] < 0) & (table.speed[1:] > 0)
    between[0] = between[0][~crossing] if len(table.speed) > 1 else between[0]
    places = _grid(*between)
    if len(places) > MOST_HELD_OUT:
        every = np.linspace(0, len(places) - 1, MOST_HELD_OUT).round().astype(int)
        places = places[every]
    truth = simulated_places(motor, fluid, case, places, table.waves.shape[-1], ahead=0.5)
    sound = truth.faults == 0
    places, truth = places[sound], truth.at(sound)
    of_means = np.abs(table.means).max(axis=(0, 1, 2))
    of_waves = np.abs(table.waves).max(axis=(0, 1, 2, 4))
    away = table.waves_between(places) - truth.waves
    mean = np.abs(table.means_at(places) - truth.means).max(axis=0) / of_means
    rms = np.sqrt(np.mean(away**2, axis=-1)).max(axis=0) / of_waves
    most = np.abs(away).max(axis=(0, 2)) / of_waves
    return Errors(
        tuple(map(float, mean)), tuple(map(float, rms)), tuple(map(float, most)), len(places)
    )


def _middles(axis: np.ndarray) -> np.ndarray:
    return (axis[:-1] + axis[1:]) / 2 if len(axis) > 1 else axis

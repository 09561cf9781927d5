"""The table of a motor: which operating points, their simulation, and the error between."""

from dataclasses import dataclass, field

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from camring.analyses.oil_use import unread_viscosity
from camring.exchange.fmu.axes import BAR, RPM, Axes
from camring.exchange.fmu.places import Found, angles_of, simulated_places
from camring.exchange.fmu.table import QUANTITIES, Table
from camring.exchange.fmu.unsound import unsound_places
from camring.files.errors import InputError
from camring.files.motor import MotorFile
from camring.numerics.verdict import Verdict
from camring.physics.mirror import has_mirror_image
from camring.physics.motor import Motor
from camring.physics.oil.fluid import AbstractFluid

__all__ = ["Errors", "Filled", "filled_table"]

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
    warnings += unsound_places(file, places, found, case)
    warnings += unread_viscosity(file)
    scale = np.abs(found.means).max(axis=0)
    wave_error = np.abs(found.waves.mean(axis=-1) - found.means).max(axis=0) / scale
    errors = _errors(motor, fluid, case, table)
    return Filled(table, errors, case, tuple(map(float, wave_error)), warnings)


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
    if not sound.any():
        raise InputError(
            "the table",
            f"has no result at any of {len(places)} places half-way between its points, so that "
            "its error cannot be given",
            "narrow --speed, --pressure or --low-pressure, or give more --points",
        )
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

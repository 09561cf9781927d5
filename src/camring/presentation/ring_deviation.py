"""A measured ring against the drawn one: distances along the normal, in micrometres when shown."""

import json
from dataclasses import dataclass
from math import degrees, pi
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float
from rich.table import Table

from camring.files.errors import InputError
from camring.files.json_numbers import finite
from camring.files.motor import MotorFile
from camring.files.motor.document import printable
from camring.files.shapes.fitted import read_curve
from camring.files.shapes.given_curve import SURFACE, covered
from camring.geometry.outline import outline_of
from camring.presentation.console import console
from camring.presentation.simulation import versions

__all__ = ["Deviation", "document", "measured_against", "print_deviation"]

CLOSES = 1e-3  # m; whether a measured curve closes is for its deviations to say
Around = Float[np.ndarray, " point"]


@dataclass(frozen=True, eq=False)
class Deviation:
    """How far a measured ring lies from the drawn one.

    Attributes
    ----------
    angles
        Polar angle on the pitch curve of each point's normal, rad.
    distances
        Of each point outside the drawn curve along its normal, m.
    aligned
        The same after the best turn and, round the whole ring, the best shift, m.
    turn, shift_x, shift_y
        That lay the drawn curve on the measured one, rad and m.
    on
        Of which curve: `pitch` or `surface`.
    lobes
        Mean and root mean square of the aligned distances on each lobe that was measured, m.
    notes
        What was taken for granted.
    """

    path: Path
    angles: Around
    distances: Around
    aligned: Around
    turn: float
    shift_x: float
    shift_y: float
    on: str
    lobes: tuple[tuple[float, float], ...]
    notes: tuple[str, ...]


def measured_against(file: MotorFile, path: Path, on: str | None = None) -> Deviation:
    """A measured ring, or lobe, against that of a motor file.

    Parameters
    ----------
    on
        `pitch` or `surface`; where neither this nor the file says so, the ring's working surface,
        as that is what a measuring machine touches.

    Raises
    ------
    InputError
        For a table that cannot be read or covers no lobe, and for one that lies so far from the
        drawn ring that it is of another one.
    """
    motor = file.system.motor
    reference = outline_of(motor.cam)
    base = reference.extreme_radius(-1)[0]
    curve = read_curve(path, on, base)
    if curve.guessed:
        curve = read_curve(path, SURFACE, base)
    on = curve.on
    curve, period = covered(curve, 2 * pi / motor.lobes, CLOSES)
    distance = float(motor.roller.radius) if on == SURFACE else 0.0
    points = curve.points
    foot = reference.foot(points, reference.parameter_at(np.angle(points)))
    place = reference.places(foot)
    stray = np.real(np.conj(place.normal) * (points - place.point)) - distance
    polar = np.angle(place.point) % (2 * pi)
    if not np.max(np.abs(stray)) < _far(reference):
        raise InputError(
            printable(path),
            f"lies up to {1e3 * float(np.max(np.abs(stray))):.3g} mm from the {on} curve of "
            f"{printable(file.path)}",
            "check its unit and angle 0; --curve pitch or surface says which curve it is of",
        )
    whole = period > 1.5 * 2 * pi / motor.lobes or motor.lobes == 1
    moved, aligned = _aligned(place.point + distance * place.normal, place.normal, stray, whole)
    return Deviation(
        path=path,
        angles=polar,
        distances=stray,
        aligned=aligned,
        turn=moved[0],
        shift_x=moved[1],
        shift_y=moved[2],
        on=on,
        lobes=_by_lobe(polar, aligned, motor.lobes),
        notes=curve.notes,
    )


def _far(reference: Any) -> float:
    """As far as points of another ring lie: a tenth of the smallest radius."""
    return 0.1 * float(reference.extreme_radius(-1)[0])


def _aligned(
    point: np.ndarray, normal: np.ndarray, stray: Around, whole: bool
) -> tuple[tuple[float, float, float], Around]:
    """The small turn and shift of the drawn curve that leave the least squares of distances."""
    columns = [np.real(np.conj(normal) * 1j * point)]
    if whole:
        columns += [normal.real, normal.imag]
    matrix = np.stack(columns, axis=1)
    moved = np.linalg.lstsq(matrix, stray, rcond=None)[0]
    turn, x, y = (*moved.tolist(), 0.0, 0.0)[:3]
    return (turn, x, y), stray - matrix @ moved


def _by_lobe(polar: Around, aligned: Around, lobes: int) -> tuple[tuple[float, float], ...]:
    which = np.floor((polar * lobes / (2 * pi) + 0.5) % lobes).astype(int)
    there = [aligned[which == lobe] for lobe in sorted(set(which.tolist()))]
    return tuple((float(np.mean(each)), float(np.sqrt(np.mean(each**2)))) for each in there)


def print_deviation(found: Deviation, file: MotorFile) -> None:
    """The deviations as a table for people."""
    out = console()
    curve = "working surface" if found.on == SURFACE else "pitch curve"
    out.print(
        f"{len(found.distances)} points of the {curve} in {printable(found.path)} against "
        f"{printable(file.path)}, um along the normal, positive away from the shaft:",
        markup=False,
    )
    table = Table("", "as it lies", "best fit", box=None, pad_edge=False)
    for name, value in _FIGURES.items():
        table.add_row(
            name, *(f"{1e6 * value(each):.2f}" for each in (found.distances, found.aligned))
        )
    out.print(table)
    worst = int(np.argmax(np.abs(found.aligned)))
    out.print(
        f"Best fit: turned by {degrees(found.turn) + 0.0:.5f} deg, shifted by "
        f"{_micrometres(found.shift_x)} um in x and {_micrometres(found.shift_y)} um in y; then "
        "the largest deviation, "
        f"{_micrometres(found.aligned[worst])} um, is at {degrees(found.angles[worst]):.3f} deg."
    )
    if len(found.lobes) > 1:
        out.print("By lobe, mean and rms after the best fit:")
        for number, (mean, rms) in enumerate(found.lobes, start=1):
            out.print(f"  lobe {number}: {_micrometres(mean)}, {_micrometres(rms)} um")
    for note in found.notes:
        out.print(f"Note: {note}", markup=False)


def _micrometres(metres: float) -> str:
    return f"{round(1e6 * float(metres), 2) + 0.0:.2f}"  # adding zero turns -0 into 0


_FIGURES = {
    "outermost": lambda e: float(np.max(e)),
    "innermost": lambda e: float(np.min(e)),
    "mean (size)": lambda e: float(np.mean(e)),
    "rms": lambda e: float(np.sqrt(np.mean(e**2))),
}


def document(found: Deviation, file: MotorFile) -> str:
    """One JSON document, SI."""

    def figures(distances: Around) -> dict[str, float]:
        names = ("outermost", "innermost", "mean", "rms")
        return {n: f(distances) for n, f in zip(names, _FIGURES.values(), strict=True)}

    return json.dumps(
        finite(
            {
                "versions": versions(),
                "motor": printable(file.path),
                "measured": printable(found.path),
                "curve": found.on,
                "points": len(found.distances),
                "as_it_lies": figures(found.distances),
                "best_fit": {
                    "turn": found.turn,
                    "shift_x": found.shift_x,
                    "shift_y": found.shift_y,
                    **figures(found.aligned),
                },
                "lobes": [{"mean": mean, "rms": rms} for mean, rms in found.lobes],
                "angles": found.angles.tolist(),
                "distances": found.distances.tolist(),
                "notes": list(found.notes),
            }
        ),
        allow_nan=False,
    )

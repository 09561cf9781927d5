"""A table of angle and lift or radius, or of x and y, with units in its header.

CSV or the first sheet of a workbook, as benches and spreadsheets write them
(`files/cells`). `ring_points.csv` of `camring
export` is such a table, with columns of both curves.
"""

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np

from camring.files.cells.cells import read_cells
from camring.files.cells.numbers import decimal_sign, number
from camring.files.errors import InputError, quote
from camring.files.motor.document import printable
from camring.files.shapes.given_curve import MOST_POINTS, PITCH, SURFACE, GivenCurve
from camring.files.units import UnitError, measured, parse_unit, unit_of

__all__ = ["read_cam_table"]

_HEADER = re.compile(r"(?P<name>[^\[(/]*?)\s*(?:[\[(](?P<open>[^\])]*)[\])]|/\s*(?P<bare>\S+))?\s*")
_NAMES = {
    "angle": ("angle", "theta", "phi", "cam angle", "shaft angle", "pitch angle", "winkel"),
    "lift": ("lift", "pitch lift", "rise", "s", "hub"),
    "radius": ("radius", "r", "polar radius"),
    "pitch_radius": ("pitch radius",),
    "surface_angle": ("surface angle",),
    "surface_radius": ("surface radius", "ring radius"),
    "x": ("x",),
    "y": ("y",),
    "pitch_x": ("pitch x",),
    "pitch_y": ("pitch y",),
    "surface_x": ("surface x",),
    "surface_y": ("surface y",),
}
_MEANING = {name: meant for meant, names in _NAMES.items() for name in names}
# First, second column and the curve they are of; None for what the file cannot say.
_PAIRS = (
    ("angle", "pitch_radius", PITCH),
    ("pitch_x", "pitch_y", PITCH),
    ("surface_angle", "surface_radius", SURFACE),
    ("surface_x", "surface_y", SURFACE),
    ("angle", "surface_radius", SURFACE),
    ("angle", "radius", None),
    ("angle", "lift", PITCH),
    ("x", "y", None),
)
_HIGHEST_HEADER = 20
_HOW = 'begin with a header such as "angle [deg], lift [mm]" and give a row for each point'


class _Column(NamedTuple):
    meant: str
    factor: float
    place: int
    header: str


def read_cam_table(path: Path, on: str | None, base_radius: float | None) -> GivenCurve:
    """The points of a table.

    Parameters
    ----------
    on
        Which curve the table holds, where it does not say so or holds both; None for the pitch
        curve, or the one it holds.
    base_radius
        Pitch radius at lift zero, m; needed where the table holds lifts.

    Raises
    ------
    InputError
        For a file that is no such table, with its line.
    """
    cells, shown = read_cells(path), printable(path)
    rows = [(line, row) for line, row in cells.rows]
    columns, below = _header(rows, shown)
    first, second, curve = _pair(columns, on, shown)
    body = rows[below:]
    if not body:
        raise InputError(shown, "has a header and no rows", _HOW)
    if len(body) > 2 * MOST_POINTS:
        raise InputError(shown, f"has {len(body):,} rows", f"thin them out to {MOST_POINTS:,}")
    sign = decimal_sign(row[each.place] for _, row in body for each in (first, second)
                        if each.place < len(row)) if cells.separator else "."  # fmt: skip
    if sign == "both":
        raise InputError(shown, "has decimal points and commas", "write all with decimal points")
    values = np.array([
        [_value(row, each, sign, f"{shown} line {line}") for each in (first, second)]
        for line, row in body
    ])  # fmt: skip
    places = tuple(f"line {line}" for line, _ in body)
    one, two = values.T
    notes: tuple[str, ...] = () if curve or on else (
        f"Its {second.meant if second.meant != 'y' else 'points'} are taken for the path of the "
        'roller centre; if they are of the ring itself, write profile_curve = "surface".',
    )  # fmt: skip
    guessed, on = not (curve or on), on or curve or PITCH
    if first.meant.endswith("x"):
        turned = np.unwrap(np.angle(one + 1j * two))
        falls = turned[-1] < turned[0]
        if falls:
            turned, places = turned[::-1], places[::-1]
            notes += ("Its points run clockwise and are read in order of rising angle.",)
        radii = np.hypot(one, two)
        return GivenCurve(
            shown, turned, radii[::-1] if falls else radii, on, places, guessed=guessed, notes=notes
        )
    if second.meant == "lift":
        if base_radius is None:
            raise InputError(
                "motor.cam.base_radius",
                f"is missing: {shown} holds lifts",
                'give the pitch radius at lift zero, for example "84.9 mm"',
            )
        two = two + base_radius
    return GivenCurve(shown, one, two, on, places, guessed=guessed, notes=notes)


def _header(rows: list[tuple[int, list[str]]], shown: str) -> tuple[list[_Column], int]:
    for place, (line, row) in enumerate(rows[:_HIGHEST_HEADER]):
        names = [_HEADER.fullmatch(cell) for cell in row]
        meant = [
            _MEANING.get(found["name"].lower().replace("_", " ").strip()) if found else None
            for found in names
        ]
        if sum(each is not None for each in meant) >= 2:
            where = f"{shown} line {line}"
            return [
                _column(each, found["open"] or found["bare"] or "", at, cell, where)
                for at, (each, found, cell) in enumerate(zip(meant, names, row, strict=True))
                if each is not None and found is not None
            ], place + 1
    raise InputError(
        shown, "has no header that names an angle and a lift or radius, or x and y", _HOW
    )


def _column(meant: str, unit: str, place: int, header: str, where: str) -> _Column:
    wanted, example = ("rad", "deg") if meant.endswith("angle") else ("m", "mm")
    if not unit.strip():
        raise InputError(
            where, f"has the column {quote(header)} without a unit", f"write {header} [{example}]"
        )
    try:
        found = unit_of(unit.strip(), wanted)
    except UnitError as error:
        raise InputError(
            where, f"has the column {quote(header)}, which {error}", f"write {header} [{example}]"
        ) from None
    if found.powers != parse_unit(wanted).powers or found.offset:
        raise InputError(
            where,
            f"has the column {quote(header)}, which measures {measured(found)}",
            f"give it in {example}",
        )
    return _Column(meant, found.factor, place, header)


def _pair(
    columns: list[_Column], on: str | None, shown: str
) -> tuple[_Column, _Column, str | None]:
    there = {each.meant: each for each in reversed(columns)}
    for one, two, curve in _PAIRS:
        if one in there and two in there and (on is None or curve is None or curve == on):
            return there[one], there[two], curve
    listed = ", ".join(each.header for each in columns)
    wanted = f" of the {on} curve" if on else ""
    raise InputError(
        shown,
        f"has no pair of angle and radius{wanted} among its columns ({listed})",
        "add the one that is missing, or change profile_curve" if on else _HOW,
    )


def _value(row: list[str], of: _Column, sign: str, where: str) -> float:
    if of.place >= len(row):
        raise InputError(where, f"has no cell for {of.header}", "give it, or take the row out")
    value, _ = number(row[of.place], sign, f"{where}, {of.header},")
    if not np.isfinite(value):
        raise InputError(f"{where}, {of.header},", "is missing", "give it, or take the row out")
    return value * of.factor

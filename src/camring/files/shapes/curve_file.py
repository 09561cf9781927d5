"""A curve through points as SolidWorks and others read and write it: rows of x, y, z.

No header; blanks, tabs or commas separate; each number is in millimetres unless
a unit stands behind it. The curve lies in a plane across the shaft.
"""

import re
from pathlib import Path

import numpy as np

from camring.files.errors import InputError, quote
from camring.files.motor.document import decode, printable
from camring.files.shapes.given_curve import MOST_POINTS, PITCH, GivenCurve
from camring.files.units import UnitError, to_si

__all__ = ["curve_text", "read_curve_file"]

LARGEST_FILE = 4_000_000  # bytes
_FLAT = 1e-6  # m, by which z may change
_CELL = re.compile(r"[^\s,;]+")


def read_curve_file(path: Path, on: str | None) -> GivenCurve:
    """The points of a curve file.

    Raises
    ------
    InputError
        For a file that is none, with its line.
    """
    shown = printable(path)
    try:
        content = path.read_bytes() if path.is_file() else None
    except OSError as error:
        raise InputError(shown, f"cannot be read ({error.strerror})", "name another") from None
    if content is None:
        raise InputError(shown, "does not exist", "name a curve file")
    if len(content) > LARGEST_FILE:
        raise InputError(shown, f"has more than {LARGEST_FILE:,} bytes", "thin its rows out")
    rows, places = [], []
    for line, text in enumerate(decode(content, shown).splitlines(), start=1):
        cells = _CELL.findall(text)
        if cells:
            rows.append(_row(cells, f"{shown} line {line}"))
            places.append(f"line {line}")
        if len(rows) > 2 * MOST_POINTS:
            raise InputError(shown, "has too many rows", f"thin them out to {MOST_POINTS:,}")
    if not rows:
        raise InputError(shown, "holds no points", "give rows of x y z in millimetres")
    x, y, z = np.array(rows).T
    for at in np.flatnonzero(~np.isfinite(x + y + z))[:1].tolist():
        raise InputError(f"{shown} {places[at]}", "has a number beyond all others", "correct it")
    bent = int(np.argmax(np.abs(z - z[0])))
    if abs(z[bent] - z[0]) > _FLAT:
        raise InputError(
            f"{shown} {places[bent]}",
            f"has z = {1e3 * z[bent]:.6g} mm where the first row has {1e3 * z[0]:.6g} mm",
            "give a curve in a plane across the shaft, with x and y as the first two",
        )
    angles, notes = np.unwrap(np.angle(x + 1j * y)), []
    radii, named = np.hypot(x, y), tuple(places)
    if angles[-1] < angles[0]:
        angles, radii, named = angles[::-1], radii[::-1], named[::-1]
        notes.append("Its points run clockwise and are read in order of rising angle.")
    if on is None:
        notes.append(
            "Its points are taken for the path of the roller centre; if they are of the ring "
            'itself, write profile_curve = "surface".'
        )
    return GivenCurve(
        shown, angles, radii, on or PITCH, named, guessed=on is None, notes=tuple(notes)
    )


def _row(cells: list[str], where: str) -> list[float]:
    if len(cells) != 3:
        raise InputError(where, f"has {len(cells)} numbers", "give x y z in each row, no header")
    found = []
    for cell in cells:
        try:
            # A bare number is in millimetres here, not in SI.
            bare = cell.replace(".", "").lstrip("+-")
            plain = re.fullmatch(r"\d+([eE][+-]?\d+)?", bare) is not None
            found.append(to_si(f"{cell} mm" if plain else cell, "m"))
        except UnitError as error:
            raise InputError(
                where, f"has {quote(cell)}, which {error}", "give x y z in millimetres, no header"
            ) from None
    return found


def curve_text(points: np.ndarray) -> str:
    """A curve file of points of the plane (complex, m), closed: the first row stands last again."""
    closed = 1e3 * np.append(points, points[:1])
    return "".join(f"{p.real + 0.0:.6f}\t{p.imag + 0.0:.6f}\t0.000000\n" for p in closed)

"""The ring as a table of points at equal angles, for grinding machine and spreadsheet."""

import numpy as np

from camring.exchange.drawings.about import About
from camring.exchange.drawings.ring import Ring
from camring.files.csv_table import Decimal, csv_table, named
from camring.files.errors import InputError
from camring.geometry.outline import Outline

__all__ = ["COLUMNS", "chord_error", "ring_points", "row_step"]

_STEPS = (1.0, 0.5, 0.25, 0.2, 0.1, 0.05, 0.025, 0.02, 0.01, 0.005)  # deg, parts of a turn
_INSIDE = np.arange(1, 10) / 10

# Column -> unit.
COLUMNS = {
    "angle": "deg",
    "pitch_radius": "mm",
    "pitch_x": "mm",
    "pitch_y": "mm",
    "normal_x": "1",
    "normal_y": "1",
    "normal_angle": "deg",
    "pitch_curvature": "1/m",
    "surface_angle": "deg",
    "surface_radius": "mm",
    "surface_x": "mm",
    "surface_y": "mm",
    "surface_curvature": "1/m",
}


def ring_points(
    ring: Ring, about: About, chord: float, decimal: Decimal = Decimal.POINT
) -> tuple[bytes, float]:
    """The table as CSV, and the step of its angle in degrees.

    Parameters
    ----------
    chord
        How far straight lines from row to row may stray from either curve, m. The
        largest step that keeps it is taken of 1, 0.5, 0.25, 0.2, 0.1 ... 0.005 deg.

    Raises
    ------
    InputError
        When no such step keeps it.
    """
    step, strays = row_step(ring, chord)
    angle = step * np.arange(round(360 / step))
    parameter = ring.outline.parameter_at(np.radians(angle))
    pitch = ring.outline.places(parameter)
    surface = ring.outline.places(parameter, ring.roller_radius)
    columns = (
        (angle, 6),
        (1e3 * np.abs(pitch.point), 6),
        (1e3 * pitch.point.real, 6),
        (1e3 * pitch.point.imag, 6),
        (pitch.normal.real, 9),
        (pitch.normal.imag, 9),
        (np.degrees(np.angle(pitch.normal)) % 360, 6),
        (pitch.curvature, 6),
        (np.degrees(np.angle(surface.point)) % 360, 6),
        (1e3 * np.abs(surface.point), 6),
        (1e3 * surface.point.real, 6),
        (1e3 * surface.point.imag, 6),
        (surface.curvature, 6),
    )
    remarks = [
        *about.lines(),
        f"Roller radius {1e3 * ring.roller_radius:.6g} mm. Rows stand at equal angles of the "
        f"pitch curve, {step:g} deg apart; straight lines between them stray at most "
        f"{1e6 * strays:.3g} um (asked for: {1e6 * chord:g} um).",
        "Normals point away from the shaft; a curvature is positive where the curve bends round "
        "the shaft.",
    ]
    # Adding zero turns a rounded -0 into 0.
    written = (
        [f"{value:.{digits}f}" for value in np.round(each, digits) + 0.0]
        for each, digits in columns
    )
    names = [named(name, unit) for name, unit in COLUMNS.items()]
    rows = zip(*written, strict=True)
    return csv_table(names, rows, remarks=remarks, decimal=decimal).encode("utf-8"), step


def chord_error(outline: Outline, distance: float, angles: np.ndarray, step: float) -> float:
    """How far straight lines over `step` (rad) from polar angles stray from a curve, m.

    The curve is the one `distance` (m) outside the pitch curve, looked at in nine
    places of each line.
    """
    within = angles[:, None] + step * np.concatenate([[0.0], _INSIDE, [1.0]])
    point = outline.places(outline.parameter_at(within), distance).point
    along = point[:, -1:] - point[:, :1]
    across = np.imag(np.conj(along) * (point[:, 1:-1] - point[:, :1])) / np.abs(along)
    return float(np.abs(across).max())


def row_step(ring: Ring, chord: float) -> tuple[float, float]:
    """The largest step, deg, over which chords stray at most `chord` (m), and how far they do.

    Raises
    ------
    InputError
        When no step keeps it.
    """
    strays = 0.0
    for step in _STEPS:
        angles = np.radians(step) * np.arange(round(360 / step))
        # One period says it all, where the step fits it.
        within = angles[angles < ring.period - 1e-9]
        if abs(len(within) * np.radians(step) - ring.period) > 1e-9:
            within = angles
        strays = max(
            chord_error(ring.outline, distance, within, np.radians(step))
            for distance in (0.0, ring.roller_radius)
        )
        if strays <= chord:
            return step, strays
    raise InputError(
        "--chord",
        f"is {1e6 * chord:g} um, but {_STEPS[-1]:g} deg from row to row still leaves "
        f"{1e6 * strays:.3g} um between them",
        "give a larger one, or take the exact curves of the DXF",
    )

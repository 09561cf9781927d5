"""Where in its envelope a motor is close to which limit, and how much its torque ripples there."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from camring.drawing.chart import Chart, draw
from camring.drawing.frame import Frame
from camring.drawing.palette import INK, LIMIT, Style, pressure_colour
from camring.drawing.scale import Axis
from camring.drawing.svg import element, group, words
from camring.files.quantities import significant
from camring.presentation.envelope import (
    ROUNDING,
    Condition,
    InEnvelope,
    WholeEnvelope,
    rounded,
    worst,
)
from camring.report.figure import Figure
from camring.report.pictures.margins import plain_name

__all__ = ["letters", "margin_figures", "ripple_figures"]

_LETTERS = {
    "min_contact_force": "L",
    "min_pressure": "C",
    "max_pressure": "P",
    "max_contact_stress": "S",
    "max_ripple_ratio": "R",
    "max_efficiency_loss": "E",
}
_SHADES = (
    (0.02, "below 2 %", "#f6dca6"),
    (0.10, "2 to 10 %", "#dfe9f2"),
    (np.inf, "above 10 %", "#aec3da"),
)
_BROKEN = "#f9e0df"
SPARE = "ABDFGHIJKMNOQTUVWXYZ"
DARK = 0.55  # share of the ripple's scale from which letters are white


def letters(envelope: WholeEnvelope) -> dict[str, str]:
    """A letter for each limit that binds anywhere, the same in every picture of the page."""
    names = dict.fromkeys(name for design in envelope.designs for name in design.binding)
    spare = iter(SPARE)
    return {name: _LETTERS.get(name) or next(spare, "·") for name in names}


def margin_figures(envelope: WholeEnvelope, row: int, condition: Condition) -> list[Figure]:
    """For each design the least margin at every point, with the letter of its limit."""
    chosen = letters(envelope)
    return [_margins(envelope, row, condition, design, chosen) for design in envelope.designs]


def ripple_figures(envelope: WholeEnvelope, row: int, condition: Condition) -> list[Figure]:
    """For each design the torque ripple at every point, in shades common to all."""
    seen = np.concatenate([each.torque_ripple for each in envelope.designs])
    seen = seen[np.isfinite(seen) & (seen > 0)]
    ends = (float(seen.min()), float(seen.max())) if seen.size else (1e-3, 1.0)
    return [_ripple(envelope, row, condition, design, ends) for design in envelope.designs]


def _margins(
    envelope: WholeEnvelope,
    row: int,
    condition: Condition,
    design: InEnvelope,
    chosen: dict[str, str],
) -> Figure:
    margin, binding = design.margin, design.binding
    cells = []
    for point in condition.points:
        value, broken = float(margin[point]), bool(design.broken[point])
        shade = next(colour for most, _, colour in _SHADES if not value >= most)
        letter = chosen[binding[point]] if np.isfinite(value) else ""
        cells.append(
            Cell(
                (letter, _percent(value)),
                _BROKEN if broken else shade,
                LIMIT if broken else INK,
                broken,
                _cell_words(envelope, design, int(point), "broken" if broken else ""),
            )
        )
    keys = [(label, Style(colour, marker="square", key="mark")) for _, label, colour in _SHADES]
    if design.broken.any():
        keys.insert(0, ("broken", Style(LIMIT, marker="square", key="mark")))
    name = f"envelope-margin-{design.label}-{row}"
    svg = _drawn(
        envelope,
        condition,
        name,
        f"Least margin of the {design.label} design in the envelope",
        cells,
        keys,
        310.0,
    )
    title = _title(design, condition, "least margin")
    return Figure(name, title, svg, _margin_words(envelope, condition, design))


def _ripple(
    envelope: WholeEnvelope,
    row: int,
    condition: Condition,
    design: InEnvelope,
    ends: tuple[float, float],
) -> Figure:
    low, high = ends
    cells = []
    for point in condition.points:
        ripple = float(design.torque_ripple[point])
        if not (np.isfinite(ripple) and ripple > 0):
            cells.append(Cell(("", "–"), "#ffffff", INK, True, ()))
            continue
        share = float(np.log(ripple / low) / np.log(high / low)) if high > low else 0.0
        ink = "#ffffff" if share > DARK else INK
        written = significant(100 * ripple, 2)
        cells.append(
            Cell(
                ("", written),
                pressure_colour(share),
                ink,
                False,
                _cell_words(envelope, design, int(point), ""),
            )
        )
    name = f"envelope-ripple-{design.label}-{row}"
    title = f"Torque ripple of the {design.label} design in the envelope, %"
    svg = _drawn(envelope, condition, name, title, cells, [], 250.0)
    ripple = design.torque_ripple[condition.points]
    sentence = "No results."
    if np.isfinite(ripple).any():
        most = int(condition.points[worst(np.nan_to_num(ripple))])
        sentence = (
            f"{design.label.capitalize()}: {significant(100 * float(np.nanmean(ripple)), 3)} % in "
            f"the mean over these points, at most {significant(100 * float(np.nanmax(ripple)), 3)} "
            f"% at {envelope.place(most)}."
        )
    return Figure(name, _title(design, condition, "torque ripple"), svg, sentence)


def _title(design: InEnvelope, condition: Condition, what: str) -> str:
    which = ", ".join(filter(None, (design.label.capitalize(), condition.words)))
    return f"{which}: {what}, %"


def _percent(share: float) -> str:
    """Two digits, and no minus before a zero."""
    return significant(100 * share, 2) if abs(share) > ROUNDING else "0"


def _cell_words(
    envelope: WholeEnvelope, design: InEnvelope, point: int, note: str
) -> tuple[tuple[str, str], ...]:
    """What the page's script shows of a cell."""
    margin = float(design.margin[point])
    name = plain_name(design.binding[point])
    rows = [(design.label.capitalize(), envelope.place(point))]
    if np.isfinite(margin):
        least = f"{significant(100 * margin, 3)} %, {name}"
        rows.append(("Least margin", f"{least}: broken" if note else least))
    rows.append(("Torque ripple", f"{significant(100 * float(design.torque_ripple[point]), 3)} %"))
    rows.append(("Efficiency", f"{significant(100 * float(design.efficiency[point]), 4)} %"))
    if point in envelope.seen_twice and design is envelope.designs[-1]:
        rows.append(("Seen", "by the second solver too"))
    return tuple(rows)


def _margin_words(envelope: WholeEnvelope, condition: Condition, design: InEnvelope) -> str:
    points = condition.points
    margin, broken = design.margin[points], design.broken[points]
    if broken.any():
        binding = [design.binding[point] for point in points[broken]]
        names = dict.fromkeys(binding)
        readings = "; ".join(f"{plain_name(each)} at {binding.count(each)}" for each in names)
        return f"Limits are broken at {int(broken.sum())} of {len(points)} points: {readings}."
    place = int(points[worst(-margin)])
    return (
        f"Every limit is kept at {len(points)} points; the tightest is “"
        f"{plain_name(design.binding[place])}” with {_percent(float(margin.min()))} % "
        f"at {envelope.place(place)}."
    )


def _drawn(
    envelope: WholeEnvelope,
    condition: Condition,
    name: str,
    title: str,
    cells: Sequence["Cell"],
    keys: Sequence[tuple[str, Style]],
    height: float,
) -> str:
    speed = envelope.speed[condition.points] * 30 / np.pi
    supply = envelope.supply_pressure[condition.points] / 1e5
    across, up = _edges(np.unique(speed), log=True), _edges(np.unique(supply), log=False)
    return draw(
        Chart(
            name,
            title,
            f"{title}: a cell for each point, over shaft speed and supply pressure.",
            _axis("Shaft speed", "rpm", across, np.unique(speed), log=True),
            _axis("Supply pressure", "bar", up, np.unique(supply), log=False),
            [Cells(speed, supply, across, up, tuple(cells))],
            keys,
            height=height,
            readable=False,
        )
    )


def _axis(label: str, unit: str, edges: np.ndarray, values: np.ndarray, *, log: bool) -> Axis:
    marked = tuple(rounded(value) for value in values)
    kind: Literal["linear", "log"] = "log" if log else "linear"
    return Axis(label, unit, float(edges[0]), float(edges[-1]), kind, marked=marked)


def _edges(values: np.ndarray, *, log: bool) -> np.ndarray:
    """Borders of cells round ascending values, one more than there are."""
    at = np.log(values) if log else values
    if len(at) == 1:
        half = np.array([0.1]) if log else 0.05 * at
        found = np.concatenate([at - half, at + half])
    else:
        middle = (at[1:] + at[:-1]) / 2
        found = np.concatenate([[2 * at[0] - middle[0]], middle, [2 * at[-1] - middle[-1]]])
    return np.exp(found) if log else found


@dataclass(frozen=True)
class Cell:
    """One point: a letter and a number on a shade, and rows for those who ask."""

    text: tuple[str, str]
    fill: str
    ink: str
    framed: bool
    readings: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Cells:
    """A cell for each point; the frame of a broken one is red."""

    x: np.ndarray
    y: np.ndarray
    across: np.ndarray
    up: np.ndarray
    cells: tuple[Cell, ...]

    def draw(self, frame: Frame) -> str:
        xs, ys = frame.x(self.across), frame.y(self.up)
        pieces = []
        for x, y, cell in zip(self.x, self.y, self.cells, strict=True):
            column = int(np.searchsorted(self.across, x)) - 1
            line = int(np.searchsorted(self.up, y)) - 1
            left, right = float(xs[column]), float(xs[column + 1])
            bottom, top = float(ys[line]), float(ys[line + 1])
            pieces.append(_cell(left, right, top, bottom, cell))
        return "".join(pieces)


def _cell(left: float, right: float, top: float, bottom: float, cell: Cell) -> str:
    middle, wide, tall = (left + right) / 2, right - left, bottom - top
    parts = [
        element(
            "rect",
            x=left,
            y=top,
            width=wide,
            height=tall,
            fill=cell.fill,
            stroke=LIMIT if cell.framed else "#ffffff",
            stroke_width=1.2,
        )
    ]
    letter, number = cell.text
    line = f"{letter} {number}".strip()
    style = {"class_": "cell-text", "text_anchor": "middle", "fill": cell.ink}
    if letter and (wide < 5.9 * len(line) or tall > 30):
        parts.append(words(middle, (top + bottom) / 2 - 2, letter, **style))
        parts.append(words(middle, (top + bottom) / 2 + 10, number, **style))
    else:
        parts.append(words(middle, (top + bottom) / 2 + 4, line, **style))
    readings = "\n".join(f"{name}: {value}" for name, value in cell.readings)
    return group(*parts, class_="cell", data_words=readings or None)

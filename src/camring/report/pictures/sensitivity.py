"""What each variable does to a result when it is moved a little: the tornado."""

from collections.abc import Sequence

import numpy as np

from camring.drawing.chart import picture
from camring.drawing.palette import QUIET
from camring.drawing.scale import Axis
from camring.drawing.svg import element, words
from camring.files.quantities import QUANTITIES
from camring.presentation.records import Sensitivity
from camring.report.figure import Figure
from camring.report.pictures.bars import WIDTH, Bars

__all__ = ["tornado_figures"]

MOST_ROWS = 14
LEAST = 0.005  # of the largest effect; what does less is not drawn
_FILLS = (("#ffffff", QUIET), ("#0b5cad", "#0b5cad"))  # moved down, moved up


def tornado_figures(sensitivities: Sequence[Sensitivity]) -> list[Figure]:
    """One picture for each result, the largest effect on top."""
    figures = []
    for result in dict.fromkeys(s.result for s in sensitivities):
        chosen = [s for s in sensitivities if s.result == result]
        chosen.sort(key=_effect, reverse=True)
        seen = [row for row in chosen if _effect(row) > LEAST * _effect(chosen[0])]
        if seen:
            figures.append(_tornado(result, seen[:MOST_ROWS], len(chosen)))
    return figures


def _effect(row: Sensitivity) -> float:
    return float(np.nanmax([abs(row.low - row.centre), abs(row.high - row.centre), 0.0]))


def _tornado(result: str, rows: Sequence[Sensitivity], count: int) -> Figure:
    quantity = QUANTITIES.get(result)
    factor, unit = (quantity.factor, quantity.unit) if quantity else (1.0, "")
    label = quantity.label.lower() if quantity else result.replace("_", " ")
    moved = factor * np.array([[s.low - s.centre, s.high - s.centre] for s in rows])
    moved = np.where(np.isfinite(moved), moved, 0.0)
    reach = 1.08 * float(np.abs(moved).max()) or 1.0
    unit = "percentage points" if unit == "%" else unit
    axis = Axis(f"Change of {label}", unit, -reach, reach, tick_count=8)
    bars = Bars(axis, len(rows), 26.0)
    pieces = []
    for k, (row, ends) in enumerate(zip(rows, moved, strict=True)):
        y = bars.y(k) + 5
        pieces.append(bars.label(y + 8, short_name(row.variable)))
        pieces.append(words(WIDTH - 8, y + 12, row.step, class_="tick", text_anchor="end"))
        for half, (value, (fill, edge)) in enumerate(zip(ends, _FILLS, strict=True)):
            left, right = sorted((bars.x(0.0), bars.x(float(value))))
            pieces.append(
                element(
                    "rect",
                    x=left,
                    y=y + 8 * half,
                    width=right - left,
                    height=8.0,
                    fill=fill,
                    stroke=edge,
                    stroke_width=1,
                )
            )
    name = f"tornado-{result.replace('_', '-')}"
    svg = picture(
        name,
        f"Sensitivity of {label}",
        f"How {label} of the last design moves with each variable.",
        bars.size,
        bars.grid(),
        _keys(bars.left),
        *pieces,
        bars.wall(0.0),
    )
    others = count - len(rows)
    shown = {0: "", 1: " The other one does little."}.get(others, f" The other {others} do little.")
    return Figure(
        name,
        f"What moves {label}",
        svg,
        f"Each variable is moved by the step on the right, all others held. "
        f"“{short_name(rows[0].variable)}” matters most here.{shown}",
        wide=True,
    )


def _keys(x: float) -> str:
    (low, edge), (high, _) = _FILLS
    return (
        element("rect", x=x, y=6.0, width=14.0, height=8.0, fill=low, stroke=edge)
        + words(x + 20, 15.0, "variable lower", class_="legend")
        + element("rect", x=x + 130, y=6.0, width=14.0, height=8.0, fill=high)
        + words(x + 150, 15.0, "variable higher", class_="legend")
    )


def short_name(path: str) -> str:
    """The last two words of a path in the motor file, enough to know the variable."""
    return ": ".join(path.split(".")[-2:]).replace("_", " ")

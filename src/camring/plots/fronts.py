"""A front of compromises: one result over another, and the motor as it stands."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from camring.drawing.palette import INK, LIMIT, QUIET
from camring.files.result_names import quantity
from camring.plots.style import drawing_board, styled

if TYPE_CHECKING:
    from camring.studies.pareto import TradeOff

BESIDE = 1.0  # widths of the front: a given motor farther off is named, not drawn
NUMBERED = 12  # designs that carry their number


@styled
def front(found: "TradeOff", axes: Axes | None = None) -> Figure:
    """The designs of a front, the third result as colour, and where the given motor stands."""
    figure, board = drawing_board(axes)
    shown = [quantity(name) for name in found.names]
    values = found.values * [each.factor for each in shown]
    if len(shown) == 2:
        board.plot(*values.T, color=QUIET, linewidth=0.8, zorder=1)
        board.scatter(
            values[:, 0], values[:, 1], s=18, color="#0b5cad", zorder=2, label="best compromises"
        )
    else:
        dots = board.scatter(
            values[:, 0], values[:, 1], c=values[:, 2], s=24, cmap="viridis", zorder=2
        )
        figure.colorbar(dots, ax=board, label=_label(found.names[2]))
    _number(board, values)
    given = found.given * [each.factor for each in shown]
    words = "given motor" if found.given_keeps_limits else "given motor (breaks a limit)"
    low, high = values.min(axis=0), values.max(axis=0)
    spare = BESIDE * (high - low)
    if all((given >= low - spare)[:2]) and all((given <= high + spare)[:2]):
        board.scatter(given[0], given[1], marker="D", s=30, color=LIMIT, zorder=3, label=words)
    else:
        at = ", ".join(each.written(si) for each, si in zip(shown, found.given, strict=True))
        board.plot([], [], "D", color=LIMIT, label=f"{words} lies off the picture, at {at}")
    board.set_xlabel(_label(found.names[0]))
    board.set_ylabel(_label(found.names[1]))
    board.legend(loc="best")
    return figure


def _number(board: Axes, values: np.ndarray) -> None:
    """The numbers of some designs, those of their files."""
    step = max(1, -(-len(values) // NUMBERED))
    for place in range(0, len(values), step):
        board.annotate(
            f"{place + 1}",
            tuple(values[place][:2]),
            xytext=(4, -9),
            textcoords="offset points",
            fontsize=7,
            color=INK,
        )


def _label(name: str) -> str:
    shown = quantity(name)
    return f"{shown.label}, {shown.unit}" if shown.unit else shown.label

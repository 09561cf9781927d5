"""How results scatter: a histogram of each, and two designs beside each other."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from camring.drawing.palette import INK, LIMIT, QUIET
from camring.evaluation.built_motors import Scatter, labelled, shown
from camring.plots.style import sheet, styled

if TYPE_CHECKING:
    from camring.studies.robust import RobustDesign

BLUE, ORANGE = "#0b5cad", "#c45a00"
PANELS = (
    "torque_ripple",
    "flow_ripple",
    "efficiency",
    "max_contact_stress",
    "max_pressure",
    "min_contact_force",
)
BINS = 32
MARK = 0.95


@styled
def scatter_histograms(scatter: Scatter, names: Sequence[str] = PANELS) -> Figure:
    """A histogram of each result, with the motor as drawn and the 5 % and 95 % points."""
    rows = -(-len(names) // 3)
    figure = sheet(6.3, 0.3 + 1.75 * rows)
    boards = figure.subplots(rows, 3, squeeze=False).ravel()
    for board, name in zip(boards, names, strict=False):
        factor = shown(name).factor
        values = scatter.results[name][scatter.sound] * factor
        board.hist(values, bins=BINS, color=BLUE, alpha=0.55)
        drawn = board.axvline(scatter.nominal[name] * factor, color=INK, label="as drawn")
        for share in (1 - MARK, MARK):
            mark = board.axvline(
                np.quantile(values, share), color=LIMIT, linestyle="--", linewidth=1.0
            )
        board.set_xlabel(labelled(name), fontsize=8)
        board.set_yticks([])
        board.spines["left"].set_visible(False)
        board.grid(visible=False)
    for board in boards[len(names) :]:
        board.set_visible(False)
    figure.legend([drawn, mark], ["as drawn", "5 % and 95 %"], loc="outside upper left", ncols=2)
    return figure


@styled
def robust_comparison(found: "RobustDesign", names: Sequence[str] = ()) -> Figure:
    """Nominal optimum and robust design: which share of the motors lies below each value."""
    from camring.studies.robust import NOMINAL, ROBUST

    names = names or ("torque_ripple", "objective")
    figure = sheet(6.3, 2.9)
    styles: dict[str, tuple[str, Any]] = {NOMINAL: (ORANGE, "--"), ROBUST: (BLUE, "-")}
    boards = figure.subplots(1, len(names), squeeze=False, sharey=True).ravel()
    for board, name in zip(boards, names, strict=True):
        factor = shown(name).factor
        worst = max(styles, key=lambda each: found.scatters[each].quantile(name, MARK))
        for design, (colour, dash) in styles.items():
            scatter = found.scatters[design]
            values = np.sort(scatter.results[name][scatter.sound]) * factor
            _distribution(board, values, colour, dash, design == worst)
            drawn = scatter.nominal[name] * factor
            share = float(np.interp(drawn, values, np.linspace(0, 100, len(values))))
            board.plot(drawn, share, "o", color=colour, markersize=4, clip_on=False)
        board.set_xlabel(labelled(name))
        board.axhline(100 * MARK, color=QUIET, linewidth=0.8)
    boards[0].set_ylabel("Motors below, %")
    boards[0].set_ylim(0, 100)
    lines = [Line2D([], [], color=colour, linestyle=dash) for colour, dash in styles.values()]
    dot = Line2D([], [], color=QUIET, marker="o", linestyle="", markersize=4)
    figure.legend([*lines, dot], [*styles, "as drawn"], loc="outside upper left", ncols=3)
    return figure


def _distribution(
    board: Axes, values: Float[np.ndarray, " sample"], colour: str, dash: Any, behind: bool
) -> None:
    """The samples' distribution function; its 95 % point written behind or before its line."""
    shares = 100 * (np.arange(len(values)) + 0.5) / len(values)
    board.plot(values, shares, linestyle=dash, color=colour)
    mark = float(np.quantile(values, MARK))
    board.plot([mark, mark], [0, 100 * MARK], ":", color=colour, linewidth=1.0)
    board.annotate(
        f"{mark:.3g}",
        (mark, 4),
        xytext=(3 if behind else -3, 0),
        textcoords="offset points",
        horizontalalignment="left" if behind else "right",
        color=colour,
        fontsize=8,
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5},
    )


__all__ = ["robust_comparison", "scatter_histograms"]

"""One result over signed speed and pressure difference: a picture of four quadrants."""

from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from matplotlib.text import Text

from camring.analyses.grid import Grid
from camring.drawing.palette import INK, QUIET
from camring.files.errors import InputError
from camring.files.result_names import quantity
from camring.metrics.efficiency import BRAKE
from camring.plots.contours import number_contours
from camring.plots.grids import BOUNDARIES, levels_of
from camring.plots.style import drawing_board, styled

NAMES = {
    (1, 1): "drives\nforwards",
    (0, 1): "brakes\nbackwards",
    (0, 0): "drives\nbackwards",
    (1, 0): "brakes\nforwards",
}
"""By whether the shaft turns forwards, and whether the port that drives it so has the pressure."""


@styled
def quadrant_map(grid: Grid, name: str, axes: Axes | None = None) -> Figure:
    """One result in all four quadrants, each with contours of its own; bright is good.

    Hatched: the roller lifts off, the oil cavitates. Grey: shaft and oil both give power, so
    that there is no efficiency. White with crosses: no result.

    Parameters
    ----------
    grid
        From `camring.analyses.quadrants.quadrants`.
    name
        A result of docs/theory.md section 10, as the shaft turns: torque is negative where
        the load drives.
    axes
        Where to draw; a new figure unless given.

    Raises
    ------
    InputError
        For a grid that has no quadrants, or no value at any point.
    """
    if not grid.quadrants:
        raise InputError("a picture of quadrants", "needs both signs", "draw it with result_map")
    figure, axes = drawing_board(axes, 6.6, 5.6)
    across, up = (axis.shown for axis in grid.axes)
    shown = quantity(name)
    values = grid.shown(name)
    if name.endswith("efficiency"):
        values = np.where(grid.mode == BRAKE, np.nan, values)
    if name == "port_efficiency":  # in creeping brakes all that comes in may leave by the case
        values = np.where(values < 0, np.nan, values)
    finite = values[np.isfinite(values)]
    if not finite.size:
        raise InputError(
            name, "has no value at any point", "look at the warnings, and narrow the ranges"
        )
    levels = levels_of(finite, shown.unit, name)
    colours = "cividis_r" if shown.better < 0 else "cividis"
    if len(levels) < 2:
        levels = np.linspace(finite.min(), finite.max() + 1e-9 * abs(finite.max()) + 1e-30, 3)
    norm = BoundaryNorm(levels, 256, extend="both")
    filled: Any = None
    numbered = []
    for right, top in NAMES:
        columns, rows = (across > 0) == right, (up > 0) == top
        part = np.ma.masked_invalid(values[np.ix_(columns, rows)]).T
        x, y = across[columns], up[rows]
        _grey(axes, grid, columns, rows)
        if part.count() < 4:
            continue
        filled = axes.contourf(x, y, part, levels, cmap=colours, norm=norm, extend="both")
        lines = axes.contour(x, y, part, levels, colors=INK, linewidths=0.5, alpha=0.7)
        numbered.append(lines)
        _hatch(axes, grid, columns, rows)
    if filled is not None:
        bar = figure.colorbar(filled, ax=axes, label=f"{shown.label}, {shown.unit or '–'}")
        bar.ax.tick_params(labelsize=8)
    names = _name(axes, across, up)
    lost = ~np.isfinite(grid.results[name])
    if np.any(lost):
        x, y = np.meshgrid(across, up, indexing="ij")
        axes.plot(x[lost], y[lost], "x", color=QUIET, markersize=3)
    axes.grid(False)
    axes.set(
        xlabel=f"{grid.axes[0].label} (negative: backwards)",
        ylabel="Pressure of the port that drives forwards over the other, bar",
        title=grid.title,
    )
    for lines in numbered:
        number_contours(axes, lines, 7, words=names)
    handles = _legend(grid)
    if handles:
        figure.legend(handles=handles, loc="outside lower center", ncols=3, fontsize=8)
    return figure


def _grey(axes: Axes, grid: Grid, columns: np.ndarray, rows: np.ndarray) -> None:
    """Where both ends give power."""
    x, y = grid.axes[0].shown[columns], grid.axes[1].shown[rows]
    both = (grid.mode[np.ix_(columns, rows)] == BRAKE).astype(float)
    if np.any(both) and both.shape[0] > 1 and both.shape[1] > 1:
        axes.contourf(x, y, both.T, [0.5, 1.5], colors=["#d5d8dc"])


def _hatch(axes: Axes, grid: Grid, columns: np.ndarray, rows: np.ndarray) -> None:
    x, y = grid.axes[0].shown[columns], grid.axes[1].shown[rows]
    for result, (_, colour, hatch) in BOUNDARIES.items():
        values = np.ma.masked_invalid(grid.results[result][np.ix_(columns, rows)]).T
        if not np.any(values < 0):
            continue
        lowest = float(values.min())
        hatching = axes.contourf(
            x, y, values, [min(2 * lowest, lowest - 1), 0], colors="none", hatches=[hatch]
        )
        hatching.set(edgecolor=colour, linewidth=0)


def _legend(grid: Grid) -> list[Any]:
    handles: list[Any] = [
        Patch(facecolor="none", edgecolor=colour, hatch=hatch, label=words)
        for result, (words, colour, hatch) in BOUNDARIES.items()
        if np.any(grid.results[result] < 0)
    ]
    if np.any(grid.mode == BRAKE):
        handles.append(Patch(facecolor="#d5d8dc", label="shaft and oil both give power"))
    return handles


def _name(
    axes: Axes, across: Float[np.ndarray, " place"], up: Float[np.ndarray, " place"]
) -> list[Text]:
    """The two zero lines, and what the machine does on each side of them."""
    axes.axhline(0, color=INK, linewidth=1.0)
    axes.axvline(0, color=INK, linewidth=1.0)
    axes.set(xlim=(across.min(), across.max()), ylim=(up.min(), up.max()))
    return [
        axes.text(
            0.75 if right else 0.25,
            0.75 if top else 0.25,
            words,
            transform=axes.transAxes,
            ha="center",
            va="center",
            fontsize=12,
            fontweight="bold",
            color=INK,
            path_effects=[withStroke(linewidth=4.0, foreground="white")],
            zorder=5,
        )
        for (right, top), words in NAMES.items()
    ]

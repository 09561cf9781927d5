"""Maps over two numbers and curves over one, with the limits of the motor drawn in."""

from collections.abc import Mapping, Sequence
from itertools import cycle
from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm
from matplotlib.contour import QuadContourSet
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator

from camring.analyses.grid import Axis, Grid
from camring.drawing.palette import INK, LIMIT, QUIET
from camring.files.errors import InputError
from camring.files.result_names import quantity
from camring.plots.contours import number_contours
from camring.plots.style import drawing_board, sheet, styled

PERCENTS = np.array(
    [*range(0, 70, 10), 70, 75, *range(80, 88, 2), *range(88, 98), 98, 98.5, 99, 99.5]
)
STEPS = np.outer(10.0 ** np.arange(-6, 10), [1, 2, 3, 5, 7]).ravel()
FEWEST_LEVELS = 5
WIDE = 15  # times from the lowest to the highest: then levels stand in steps of a factor

# Where the result falls below zero: what is said, the colour, the hatching.
BOUNDARIES = {
    "min_contact_force": ("roller lifts off", "#7b3294", "///"),
    "vapour_margin": ("oil cavitates", "#000000", "..."),
}
LIMIT_DASHES: tuple[Any, ...] = ("--", "-.", ":", (0, (6, 2, 1, 2, 1, 2)))


@styled
def result_map(grid: Grid, name: str, axes: Axes | None = None) -> Figure:
    """One result over two numbers, with contours; bright is good.

    Hatched: the roller lifts off, the oil cavitates. Dashed: upper limits of the motor
    file. Framed: its envelope, where the map goes beyond it. White with crosses: no
    periodic solution, so no result.

    Parameters
    ----------
    grid
        From `camring.operating_map` or `camring.sweep` over two numbers.
    name
        A result of docs/theory.md section 10.
    axes
        Where to draw; a new figure unless given.

    Raises
    ------
    InputError
        For a grid over one number, or one without a single sound point.
    """
    own = axes is None
    figure, axes = drawing_board(axes, 6.3, 4.6)
    handles = _fill(figure, [axes], [grid], name)
    if handles and own:
        figure.legend(handles=handles, loc="outside lower center", ncols=2, fontsize=8)
    elif handles:
        axes.legend(handles=handles, fontsize=8)
    return figure


@styled
def result_maps(grids: Sequence[Grid], name: str) -> Figure:
    """One result of several motors, panel by panel on one scale: as given and the best.

    Parameters
    ----------
    grids
        Over the same two numbers; see `result_map`.

    Raises
    ------
    InputError
        As `result_map`, where none of the motors has a value.
    """
    figure = sheet(1.2 + 4.2 * len(grids), 4.8)
    panels = figure.subplots(1, len(grids), sharey=True, squeeze=False)[0]
    handles = _fill(figure, list(panels), grids, name)
    for panel in panels[1:]:
        panel.set_ylabel("")
    if handles:
        figure.legend(handles=handles, loc="outside lower center", ncols=3, fontsize=8)
    return figure


def _fill(figure: Any, panels: list[Axes], grids: Sequence[Grid], name: str) -> list[Any]:
    """A map in each panel, colours and contours of all alike; what a legend says of them."""
    if any(len(grid.axes) != 2 for grid in grids):
        raise InputError("a map", "needs two numbers that vary", "draw one with sweep_curves")
    shown = quantity(name)
    all_values = np.concatenate([grid.shown(name).ravel() for grid in grids])
    finite = all_values[np.isfinite(all_values)]
    if not finite.size:
        raise InputError(
            name, "has no value at any point", "look at the warnings, and narrow the ranges"
        )
    levels = levels_of(finite, shown.unit, name)
    crossed = dict.fromkeys(each for grid in grids for each in grid.limits if _crossed(grid, each))
    dashes = dict(zip(crossed, cycle(LIMIT_DASHES)))
    legend: dict[Any, Any] = {}
    filled = None
    for axes, grid in zip(panels, grids, strict=True):
        if len(levels) < 2:
            picture = np.ma.masked_invalid(grid.shown(name)).T
            axes.contourf(*_places(grid), picture, colors=["#b9b9a0"], levels=1)
            _say_inside(axes, f"{finite.mean():.4g} {shown.unit} everywhere")
        else:
            filled = _contours(axes, grid, name, levels) or filled
        legend |= {each.get_label(): each for each in _boundaries(axes, grid, name, dashes)}
        axes.grid(False)
        axes.set(xlabel=grid.axes[0].label, ylabel=grid.axes[1].label)
        axes.set_title(grid.title, parse_math=False)
    if filled is not None:
        label = f"{shown.label}, {shown.unit or '–'}"
        bar = figure.colorbar(filled, ax=panels, label=label, ticks=levels, format="%.4g")
        bar.ax.tick_params(labelsize=8)
    return list(legend.values())


def _places(grid: Grid) -> list[Float[np.ndarray, " place"]]:
    return [each.shown for each in grid.axes]


def _contours(
    axes: Axes, grid: Grid, name: str, levels: Float[np.ndarray, " level"]
) -> QuadContourSet | None:
    """Colours between levels and numbered lines on them; without a line the range in words."""
    shown, picture = quantity(name), np.ma.masked_invalid(grid.shown(name)).T
    if not picture.count():
        return None
    colours = "cividis_r" if shown.better < 0 else "cividis"
    norm = BoundaryNorm(levels, 256, extend="both")
    filled = axes.contourf(*_places(grid), picture, levels, cmap=colours, norm=norm, extend="both")
    lines = axes.contour(*_places(grid), picture, levels, colors=INK, linewidths=0.6, alpha=0.75)
    number_contours(axes, lines, 7.5, grid.envelope)
    if not np.any((picture.min() < levels) & (levels < picture.max())):
        ends = np.nanmin(grid.results[name]), np.nanmax(grid.results[name])
        low, high = (shown.written(float(end)) for end in ends)
        _say_inside(axes, f"{low} to {high} {shown.unit}")
    return filled


def _say_inside(axes: Axes, words: str) -> None:
    """In the middle of a map, on whatever colour it has there."""
    stroke = [withStroke(linewidth=3.0, foreground="white")]
    axes.text(0.5, 0.5, words, transform=axes.transAxes, ha="center", path_effects=stroke)


def efficiency_map(grid: Grid, axes: Axes | None = None) -> Figure:
    """Overall efficiency over two numbers; see `result_map`."""
    return result_map(grid, "efficiency", axes)


def ripple_map(grid: Grid, axes: Axes | None = None) -> Figure:
    """One-sided torque ripple over two numbers; see `result_map`."""
    return result_map(grid, "torque_ripple", axes)


@styled
def sweep_curves(grid: Grid, names: Sequence[str]) -> Figure:
    """Results over one number, one below the other.

    Raises
    ------
    InputError
        For a grid over two numbers.
    """
    if len(grid.axes) != 1:
        raise InputError("a curve", "needs one number that varies", "draw two with result_map")
    figure = sheet(6.3, 0.9 + 1.75 * len(names))
    panels = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
    axis = grid.axes[0]
    for panel, name in zip(panels, names, strict=True):
        shown = quantity(name)
        panel.plot(axis.shown, grid.shown(name), color="#0b5cad", marker=".", markersize=4)
        panel.set_ylabel(shown.unit or "–")
        panel.set_title(f"{shown.label}, {shown.unit or '–'}")
        limit = grid.limits.get(name)
        if limit is not None:
            panel.axhline(limit * shown.factor, color=LIMIT, linestyle="--", linewidth=1.2)
            panel.annotate(
                "limit of the motor file",
                (1, limit * shown.factor),
                xycoords=("axes fraction", "data"),
                xytext=(-2, 2),
                textcoords="offset points",
                ha="right",
                color=LIMIT,
                fontsize=8,
                path_effects=[withStroke(linewidth=2.5, foreground="white")],
            )
        if not np.any(np.isfinite(grid.shown(name))):
            panel.text(0.5, 0.5, "no value", transform=panel.transAxes, ha="center")
        _shade(panel, axis, grid)
    figure.align_ylabels(panels)
    panels[-1].set_xlabel(axis.label)
    panels[-1].set_xlim(axis.shown.min(), axis.shown.max())
    handles = [
        Patch(facecolor="white", edgecolor=colour, hatch=hatch, label=words)
        for result, (words, colour, hatch) in BOUNDARIES.items()
        if np.any(grid.results[result] < 0)
    ]
    if handles:
        figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
    figure.suptitle(grid.title, x=0.01, ha="left", fontsize=9.5, parse_math=False)
    return figure


def levels_of(
    finite: Float[np.ndarray, " place"], unit: str, name: str
) -> Float[np.ndarray, " level"]:
    """Round numbers where contours stand: denser near 100 % for efficiencies."""
    low, high = np.percentile(finite, [2, 98])
    if high - low <= 1e-9 * max(abs(low), abs(high)):
        return np.array([])
    if unit == "%" and name.endswith("efficiency"):
        highest = float(finite.max())
        inside = np.array([level for level in PERCENTS if low < level < highest])
        if len(inside) >= FEWEST_LEVELS:
            return inside
    if low > 0 and high > WIDE * low:
        inside = STEPS[(low <= STEPS) & (high >= STEPS)]
        every = 1 if len(inside) <= 14 else 2
        if len(inside) >= FEWEST_LEVELS:
            return inside[::every]
    levels = MaxNLocator(9).tick_values(low, high)
    return levels[(levels > finite.min()) & (levels < finite.max())]


def _crossed(grid: Grid, result: str) -> bool:
    """Whether a limit runs across the map."""
    values, limit = grid.results[result], grid.limits[result]
    return bool(np.any(values > limit) and np.any(values < limit))


def _boundaries(axes: Axes, grid: Grid, name: str, dashes: Mapping[str, Any]) -> list[Any]:
    """The hatched and dashed limits, and what the legend says of them."""
    across, up = (axis.shown for axis in grid.axes)
    handles: list[Any] = []
    for result, (words, colour, hatch) in BOUNDARIES.items():
        values = np.ma.masked_invalid(grid.results[result]).T
        if not np.any(values < 0):
            continue
        lowest = float(values.min())
        hatching = axes.contourf(
            across, up, values, [min(2 * lowest, lowest - 1), 0], colors="none", hatches=[hatch]
        )
        hatching.set(edgecolor=colour, linewidth=0)
        if np.any(values > 0):
            axes.contour(across, up, values, [0], colors=colour, linewidths=1.8)
        handles.append(Patch(facecolor="none", edgecolor=colour, hatch=hatch, label=words))
    for result, dash in dashes.items():
        limit = grid.limits.get(result)
        if limit is None or not _crossed(grid, result):
            continue
        values = np.ma.masked_invalid(grid.results[result]).T
        shown = quantity(result)
        axes.contour(across, up, values, [limit], colors=LIMIT, linestyles=[dash], linewidths=1.4)
        words = f"limit: {shown.label.lower()} {limit * shown.factor:.4g} {shown.unit}"
        handles.append(Line2D([], [], color=LIMIT, linestyle=dash, label=words))
    handles += _envelope(axes, grid)
    if not np.all(np.isfinite(grid.results[name])):
        x, y = np.meshgrid(across, up, indexing="ij")
        lost = ~np.isfinite(grid.results[name])
        marks = axes.plot(
            x[lost], y[lost], "x", color=QUIET, markersize=3, label="no result", clip_on=False
        )
        handles += marks
    return handles


def _envelope(axes: Axes, grid: Grid) -> list[Any]:
    """A frame round where the motor must run, if the picture goes beyond it."""
    if grid.envelope is None or np.all(grid.in_envelope):
        return []
    (left, right), (bottom, top) = grid.envelope
    frame = Rectangle(
        (left, bottom),
        right - left,
        top - bottom,
        fill=False,
        edgecolor=INK,
        linewidth=2.0,
        path_effects=[withStroke(linewidth=4.0, foreground="white")],
        label="envelope",
        zorder=3,
    )
    axes.add_patch(frame)
    axes.set(xlim=(grid.axes[0].shown.min(), grid.axes[0].shown.max()))
    axes.set(ylim=(grid.axes[1].shown.min(), grid.axes[1].shown.max()))
    return [frame]


def _shade(panel: Axes, axis: Axis, grid: Grid) -> None:
    """Hatch where the roller lifts off or the oil cavitates."""
    for result, (_, colour, hatch) in BOUNDARIES.items():
        panel.fill_between(
            axis.shown,
            0,
            1,
            where=grid.results[result] < 0,
            transform=panel.get_xaxis_transform(),
            facecolor="none",
            edgecolor=colour,
            hatch=hatch,
            linewidth=0,
            alpha=0.4,
        )

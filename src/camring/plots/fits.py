"""A fit: modelled over measured, and what is left of each result over pressure."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from camring.drawing.palette import INK, QUIET
from camring.files.quantities import Quantity
from camring.plots.style import sheet, styled

if TYPE_CHECKING:
    from camring.fitting.fit import Fit

MOST_RESULTS = 4  # beside each other
WIDTH, HEIGHT = 3.1, 5.2  # inches, of one result
COLOURS = "viridis"
BAR = 1e5
ASIDE = 0.1  # of the range of pressures, from the lowest speed to the highest
GIVEN = "#b4540a"


@styled
def fitted(found: "Fit") -> Figure:
    """Modelled over measured above, modelled minus measured over pressure below.

    A column for each measured result, four at most; colour is speed. Open diamonds are
    the motor as given; the band, or the bars, two
    standard deviations each way.
    """
    from camring.fitting.doubts import shown

    names = list(found.table.values)[:MOST_RESULTS]
    figure = sheet(WIDTH * max(len(names), 2), HEIGHT)
    board = figure.subplots(2, len(names), squeeze=False, height_ratios=(3, 2))
    speed = 30 / np.pi * found.table.conditions["shaft_speed"]
    limits = dict(vmin=float(speed.min()), vmax=float(speed.max()), cmap=COLOURS)
    for place, name in enumerate(names):
        here, result = found.of(name), shown(name)
        colour = speed[found.rows[here]]
        dots = _over_measured(board[0][place], found, here, result, colour, limits)
        _left_over(board[1][place], found, here, result, colour, limits)
    board[0][0].legend(loc="upper left")
    if np.ptp(speed) > 0:
        figure.colorbar(dots, ax=board[:, -1], label="Shaft speed, rpm", aspect=40)
    return figure


def _over_measured(
    axes: Axes,
    found: "Fit",
    here: np.ndarray,
    result: Quantity,
    colour: np.ndarray,
    limits: dict,
) -> PathCollection:
    measured, modelled, before = (
        result.factor * each[here] for each in (found.measured, found.modelled, found.before)
    )
    ends = [measured.min(), measured.max()]
    axes.plot(ends, ends, color=QUIET, linewidth=0.8, zorder=1)
    axes.scatter(
        measured,
        before,
        marker="D",
        s=16,
        facecolors="none",
        edgecolors=GIVEN,
        linewidths=0.8,
        zorder=2,
        label="as given",
    )
    dots = axes.scatter(measured, modelled, c=colour, s=18, zorder=3, label="fitted", **limits)
    unit = f", {result.unit}" if result.unit else ""
    axes.set_title(f"{result.label}{unit}")
    axes.set_xlabel("measured")
    axes.set_ylabel("modelled")
    axes.xaxis.set_major_locator(MaxNLocator(4))
    return dots


def _aside(speed: np.ndarray) -> np.ndarray:
    """A little to the side by speed, so that rows of one pressure do not hide each other."""
    _, rank = np.unique(speed, return_inverse=True)
    return ASIDE * (rank / max(rank.max(), 1) - 0.5)


def _left_over(
    axes: Axes,
    found: "Fit",
    here: np.ndarray,
    result: Quantity,
    colour: np.ndarray,
    limits: dict,
) -> None:
    conditions = found.table.conditions
    of_supply = "supply_pressure" in conditions
    pressure = (
        conditions["supply_pressure" if of_supply else "pressure_drop"][found.rows[here]] / BAR
    )
    pressure = pressure + _aside(colour) * (np.ptp(pressure) or pressure[0])
    left = result.factor * (found.modelled - found.measured)[here]
    reach = result.factor * 2 * found.deviation[here]
    axes.axhline(0, color=QUIET, linewidth=0.8, zorder=1)
    if np.ptp(reach) <= 1e-9 * reach.max():
        axes.axhspan(-reach[0], reach[0], color=QUIET, alpha=0.12, linewidth=0, zorder=0)
    else:
        axes.errorbar(pressure, left, yerr=reach, fmt="none", ecolor=INK, elinewidth=0.5)
    axes.scatter(pressure, left, c=colour, s=18, zorder=3, **limits)
    axes.set_xlabel("Supply pressure, bar" if of_supply else "Pressure drop, bar")
    axes.set_ylabel("modelled − measured")
    axes.xaxis.set_major_locator(MaxNLocator(4))

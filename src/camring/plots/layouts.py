"""Layouts side by side: what each best design ripples and what it wastes."""

from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from camring.drawing.palette import INK, QUIET
from camring.plots.style import sheet, styled

if TYPE_CHECKING:
    from camring.analyses.layouts.studied import Studies

COLOUR = "#0b5cad"


@styled
def layouts_ranked(found: "Studies") -> Figure:
    """Worst torque ripple, efficiency and contact stress of each layout, the best on top.

    Layouts whose radial load turns with the shaft are hollow.
    """
    from camring.analyses.layouts.studied import worst
    from camring.files.result_names import quantity

    shown = [each for each in found.ranked if each.best is not None]
    places = list(range(len(shown)))
    figure = sheet(7.2, 1.3 + 0.32 * len(shown))
    panels = figure.subplots(1, 3, sharey=True)
    for panel, name in zip(
        panels, ("torque_ripple", "efficiency", "max_contact_stress"), strict=True
    ):
        result = quantity(name)
        values = [worst(each, name) * result.factor for each in shown]
        if name == "torque_ripple":
            panel.set_xscale("log")
            panel.xaxis.set_major_formatter("{x:g}")
        for place, value, each in zip(places, values, shown, strict=True):
            face = COLOUR if each.layout.balanced else "white"
            panel.plot(value, place, "o", markersize=6, color=COLOUR, markerfacecolor=face)
            panel.annotate(
                result.written(value / result.factor),
                (value, place),
                xytext=(0, 6),
                textcoords="offset points",
                ha="center",
                fontsize=7,
                color=INK,
            )
        panel.margins(x=0.2)
        panel.set_xlabel(f"{result.label}, {result.unit}", color=INK)
        panel.xaxis.set_minor_locator(NullLocator())
        panel.tick_params(axis="x", labelsize=7, labelcolor=QUIET)
    panels[0].set_yticks(places, [f"{each.layout.pistons} × {each.layout.lobes}" for each in shown])
    panels[0].set_ylim(len(shown) - 0.5, -0.7)
    panels[0].set_ylabel("pistons × lobes")
    figure.suptitle(
        "Best design of each layout, by rank; hollow: the radial load turns", fontsize=9
    )
    return figure

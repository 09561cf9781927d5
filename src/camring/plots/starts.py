"""Torque at standstill over the angle, and charge pressure over speed."""

from math import pi
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from camring.plots.style import drawing_board, line, styled

if TYPE_CHECKING:
    from camring.analyses.charge import ChargeCurve
    from camring.metrics.starting import Starting


@styled
def starting(found: "Starting", axes: Axes | None = None) -> Figure:
    """Starting torque of both directions over the angle, each with its least and efficiency."""
    figure, axes = drawing_board(axes)
    angle = np.degrees(np.asarray(found.angle))
    for place, (name, reverse) in enumerate((("forward", False), ("backward", True))):
        torque = np.asarray(found.torque(reverse))
        least, share = float(found.starting_torque(reverse)), found.starting_efficiency(reverse)
        said = f"{name}: at least {least:.4g} N·m, {100 * float(share):.3g} % of ideal"
        style = line(place, 2)
        axes.plot(angle, torque, label=said, **style)
        at = int(np.argmin(torque))
        axes.plot(angle[at], torque[at], "o", color=style["color"], markersize=5)
    axes.axhline(float(found.ideal_torque), color="#888888", linewidth=0.9, linestyle=":")
    axes.set(xlabel="Shaft angle, deg", ylabel="Starting torque, N·m", ylim=(0, None))
    axes.set_xlim(0, angle[-1])
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1.0), fontsize=8, borderaxespad=0.2)
    return figure


@styled
def charge(found: "ChargeCurve", axes: Axes | None = None) -> Figure:
    """The least return pressure over speed, and what asks for it."""
    figure, axes = drawing_board(axes)
    rpm, bar = found.speed * 30 / pi, found.pressure / 1e5
    parts = (("rollers stay on the ring", found.by_contact), ("no air release", ~found.by_contact))
    axes.plot(rpm, bar, **line(0, 1))
    for place, (name, where) in enumerate(parts):
        if np.any(where):
            marks: dict[str, Any] = {"marker": "os"[place], "markersize": 4, "linestyle": "none"}
            axes.plot(rpm[where], bar[where], label=name, color=line(place, 2)["color"], **marks)
    axes.set(xlabel="Shaft speed, rpm", ylabel="Least return pressure, bar absolute")
    axes.set_ylim(0, None)
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1.0), fontsize=8, borderaxespad=0.2)
    return figure

"""The ring as it is ground, and the cam unrolled with the windows that serve it."""

from math import pi
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from camring.drawing.palette import RETURN, SUPPLY
from camring.files.errors import InputError
from camring.plots.samples import Unrolled, unrolled
from camring.plots.style import line, sheet, styled

if TYPE_CHECKING:
    from camring.physics.motor import Motor

AROUND = 2881
PERIOD = 1441


@styled
def cam(*motors: "Motor", labels: tuple[str, ...] = ()) -> Figure:
    """Working surface and pitch curve; lift, pressure angle and undercut factor over the angle.

    The thick line is the ring's inside, one roller radius outside the thin pitch curve.
    Below the lift stand the angles over which supply and return windows are open, of the
    first motor.

    Parameters
    ----------
    motors
        Several are drawn over each other.
    labels
        A name for each; the motors' own unless given.
    """
    if not motors:
        raise InputError("a figure", "was asked for without a motor", "give one")
    names = list(labels) or [motor.name or f"motor {n + 1}" for n, motor in enumerate(motors)]
    if len(names) != len(motors):
        raise InputError(
            "labels", f"has {len(names)} names for {len(motors)} motors", "give one for each"
        )
    figure = sheet(8.2, 5.0)
    halves: Any = figure.subfigures(1, 2, width_ratios=[1.05, 1])
    left, right = halves
    ring = left.subplots()
    lift, tilt, margin = right.subplots(3, 1, sharex=True, height_ratios=[1.3, 1, 1])
    for place, (motor, name) in enumerate(zip(motors, names, strict=True)):
        line_style = line(place, len(motors))
        _draw_ring(ring, motor, name, line_style)
        _draw_unrolled((lift, tilt, margin), unrolled(motor, motor.cam.period, PERIOD), line_style)
    _draw_windows(lift, unrolled(motors[0], motors[0].cam.period, PERIOD))
    ring.set(aspect="equal", xlabel="x, mm", ylabel="y, mm")
    ring.set_title("Working surface (thick) and pitch curve (thin)")
    left.legend(loc="outside lower center", fontsize=8)
    lift.set(ylabel="mm", title="Lift, mm, and the windows' opening")
    tilt.set(ylabel="deg", title="Pressure angle, deg")
    margin.set(ylabel="–", title="Undercut factor (dimensionless)", xlabel="Cam angle, deg")
    margin.axhline(0, color="#a3262b", linewidth=1.0, linestyle="--")
    right.align_ylabels([lift, tilt, margin])
    lift.set_xlim(0, 360 / min(motor.cam.repeats for motor in motors))
    return figure


def _draw_ring(axes: Axes, motor: "Motor", name: str, line_style: dict) -> None:
    seen = unrolled(motor, 2 * pi, AROUND)
    angle, radius, slope = (np.asarray(each) for each in (seen.angle, seen.radius, seen.slope))
    length, roller = np.hypot(radius, slope), float(motor.roller.radius)
    along, across = radius + radius / length * roller, -slope / length * roller
    x = along * np.cos(angle) - across * np.sin(angle)
    y = along * np.sin(angle) + across * np.cos(angle)
    axes.plot(1e3 * x, 1e3 * y, label=name, **line_style)
    thin = {**line_style, "linewidth": 0.7}
    axes.plot(1e3 * radius * np.cos(angle), 1e3 * radius * np.sin(angle), **thin)


def _draw_unrolled(panels: tuple[Axes, Axes, Axes], seen: Unrolled, line_style: dict) -> None:
    millimetres, degrees = 1e3 * np.asarray(seen.lift), np.degrees(seen.pressure_angle)
    shown = (millimetres, degrees, np.asarray(seen.undercut_factor))
    for axes, values in zip(panels, shown, strict=True):
        axes.plot(np.degrees(seen.angle), values, **line_style)


def _draw_windows(axes: Axes, seen: Unrolled) -> None:
    low, high = axes.get_ylim()
    for opening, colour, hatch, name in (
        (np.asarray(seen.supply_opening), SUPPLY, "///", "supply"),
        (np.asarray(seen.return_opening), RETURN, "\\\\\\", "return"),
    ):
        axes.fill_between(
            np.degrees(seen.angle),
            0,
            0.22 * opening,
            where=opening > 0,
            transform=axes.get_xaxis_transform(),
            facecolor=colour + "22",
            edgecolor=colour,
            hatch=hatch,
            linewidth=0.8,
            label=f"{name} window",
        )
    axes.set_ylim(low - 0.32 * (high - low), high + 0.22 * (high - low))
    axes.legend(fontsize=8, ncols=2, loc="upper center")

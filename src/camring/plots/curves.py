"""Curves of one cycle or of several side by side: over the shaft's angle, by order, p over V."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from camring.drawing.palette import RETURN, SUPPLY
from camring.files.errors import InputError
from camring.files.point_names import name_of
from camring.numerics.quantity import real
from camring.plots.samples import spectra
from camring.plots.style import as_written, drawing_board, line, sheet, styled

if TYPE_CHECKING:
    from camring.physics.cycle import Cycle
    from camring.physics.waves.waveforms import Waveforms

SAMPLES = 1441
HEARD_MULTIPLES = 8  # of the surviving order, in a spectrum

# What a panel shows: name in `Waveforms`, label, unit, factor from SI.
PANELS = (
    ("chamber_pressure", "Chamber pressure", "bar", 1e-5),
    ("supply_flow", "Flow from the supply port into a chamber", "L/min", 6e4),
    ("contact_force", "Force between a roller and the ring", "kN", 1e-3),
    ("torque", "Shaft torque", "N·m", 1.0),
)
SPECTRA = {
    "torque": ("Shaft torque, peak amplitude", "N·m", 1.0),
    "chamber_pressure": ("Chamber pressure, peak amplitude", "bar", 1e-5),
    "supply_flow": ("Supply flow of all pistons, peak amplitude", "L/min", 6e4),
}
ANGLE = "Shaft angle, deg"


@styled
def waveforms(*cycles: "Cycle", labels: Sequence[str] = ()) -> Figure:
    """Pressure, flow and force of one chamber and the shaft's torque, over a period of the cam.

    Parameters
    ----------
    cycles
        From `camring.simulate`; several are drawn over each other.
    labels
        A name for each; the motors' own unless given.
    """
    figure = sheet(6.3, 7.6)
    panels = figure.subplots(len(PANELS), 1, sharex=True)
    waves = _sampled(cycles)
    for panel, (name, label, unit, factor) in zip(panels, PANELS, strict=True):
        for place, (wave, named) in enumerate(zip(waves, _names(cycles, labels), strict=True)):
            values = factor * np.asarray(getattr(wave, name))
            panel.plot(_degrees(wave), values, label=named, **line(place, len(cycles)))
        panel.set(ylabel=unit, title=f"{label}, {unit}")
    for pressure, port, colour in _ports(cycles):
        panels[0].axhline(pressure / 1e5, color=colour, linewidth=0.9, linestyle=":", label=port)
    handles, said = panels[0].get_legend_handles_labels()
    as_written(figure.legend(handles, said, loc="outside upper left", fontsize=8, ncols=2))
    figure.align_ylabels(panels)
    panels[-1].set_xlabel(ANGLE)
    panels[-1].set_xlim(0, _degrees(waves[0])[-1])
    return figure


@styled
def torque(*cycles: "Cycle", labels: Sequence[str] = (), axes: Axes | None = None) -> Figure:
    """Shaft torque over a period of the cam, with its mean and ripple in the legend."""
    figure, axes = drawing_board(axes)
    for place, (wave, name) in enumerate(
        zip(_sampled(cycles), _names(cycles, labels), strict=True)
    ):
        values = np.asarray(wave.torque)
        mean, swing = values[:-1].mean(), np.ptp(values)
        said = f"{name}: mean {mean:.4g} N·m, peak to peak {100 * swing / abs(mean):.3g} %"
        axes.plot(_degrees(wave), values, label=said, **line(place, len(cycles)))
        axes.set_xlim(0, _degrees(wave)[-1])
    axes.set(xlabel=ANGLE, ylabel="Shaft torque, N·m")
    _key_above(axes)
    return figure


@styled
def pressure_volume(
    *cycles: "Cycle", labels: Sequence[str] = (), axes: Axes | None = None
) -> Figure:
    """Chamber pressure over chamber volume: the loop whose area is a piston's work."""
    figure, axes = drawing_board(axes)
    for place, (wave, name) in enumerate(
        zip(_sampled(cycles), _names(cycles, labels), strict=True)
    ):
        volume, pressure = 1e6 * np.asarray(wave.volume), np.asarray(wave.chamber_pressure) / 1e5
        axes.plot(volume, pressure, label=name, **line(place, len(cycles)))
    for port, said, colour in _ports(cycles):
        axes.axhline(port / 1e5, color=colour, linewidth=0.9, linestyle=":", label=said)
    axes.set(xlabel="Chamber volume, cm³", ylabel="Chamber pressure, bar (absolute)")
    _key_above(axes)
    return figure


@styled
def spectrum(
    *cycles: "Cycle",
    of: str = "torque",
    highest_order: int | None = None,
    labels: Sequence[str] = (),
    axes: Axes | None = None,
) -> Figure:
    """Peak amplitudes by order of the shaft's rotation.

    Parameters
    ----------
    of
        `torque`, `chamber_pressure` or `supply_flow`.
    highest_order
        Unless given, eight multiples of the lowest order that the torque can hold.
    """
    if of not in SPECTRA:
        raise InputError("of", f"is {of!r}", f"give one of {', '.join(SPECTRA)}")
    label, unit, factor = SPECTRA[of]
    figure, axes = drawing_board(axes)
    lowest = max(cycle.motor.surviving_order for cycle in cycles)
    highest = highest_order or HEARD_MULTIPLES * lowest
    for place, (cycle, name) in enumerate(zip(cycles, _names(cycles, labels), strict=True)):
        found = spectra(cycle, highest)
        every = np.asarray(found.orders)
        heard = every % cycle.motor.surviving_order == 0
        if of == "chamber_pressure":
            heard = np.ones_like(heard)
        orders, height = every[heard], factor * np.asarray(getattr(found, of))[heard]
        line_style = line(place, len(cycles))
        # Side by side, so that no bar hides another.
        aside = 0.012 * highest * (place - (len(cycles) - 1) / 2)
        axes.vlines(orders + aside, 0, height, color=line_style["color"], linewidth=2.2)
        marker = "osD^v"[place % 5]
        style: dict[str, Any] = dict(color=line_style["color"], linestyle="none", markersize=4)
        axes.plot(orders + aside, height, marker, label=name, **style)
    axes.set(xlabel="Order, per shaft revolution", ylabel=f"{label}, {unit}")
    axes.set_ylim(bottom=0)
    step = lowest * -(-highest // (HEARD_MULTIPLES * lowest))
    axes.set_xticks(range(step, highest + 1, step))
    _key_above(axes)
    return figure


def _sampled(cycles: Sequence["Cycle"]) -> "list[Waveforms]":
    from camring.programs.compiled import waveforms as sample

    if not cycles:
        raise InputError("a figure", "was asked for without a cycle", "give camring.simulate(...)")
    period = max(cycle.motor.cam.period for cycle in cycles)
    angle = real(np.linspace(0, period, SAMPLES))
    return [sample(cycle, angle) for cycle in cycles]


def _names(cycles: Sequence["Cycle"], labels: Sequence[str]) -> list[str]:
    """What each curve is called: as asked, else what the cycles differ in."""
    if labels:
        if len(labels) != len(cycles):
            raise InputError(
                "labels", f"has {len(labels)} names for {len(cycles)} cycles", "give one for each"
            )
        return list(labels)
    names = [cycle.motor.name or "motor" for cycle in cycles]
    if len(set(names)) < len(names):
        points = [name_of(cycle.point) for cycle in cycles]
        names = (
            points if len(set(points)) == len(points) else [f"{n + 1}" for n in range(len(names))]
        )
    return names


def _ports(cycles: Sequence["Cycle"]) -> list[tuple[float, str, str]]:
    """The ports' pressures where all cycles have the same, with their words and colour."""
    points = [cycle.point for cycle in cycles]
    supply = {float(point.supply_pressure) for point in points}
    back = {float(point.return_pressure) for point in points}
    said = []
    if len(supply) == 1:
        said.append((supply.pop(), "supply pressure", SUPPLY))
    if len(back) == 1:
        said.append((back.pop(), "return pressure", RETURN))
    return said


def _degrees(wave: "Waveforms") -> np.ndarray:
    return np.degrees(np.asarray(wave.angle))


def _key_above(axes: Axes) -> None:
    as_written(
        axes.legend(loc="lower left", bbox_to_anchor=(0, 1.0), fontsize=8, borderaxespad=0.2)
    )

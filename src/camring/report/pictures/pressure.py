"""Chamber pressure: over a lobe, magnified at the dead centres, against volume."""

from collections.abc import Sequence

import numpy as np

from camring.drawing.chart import Chart, draw
from camring.drawing.layers import Curve, Loop, Rule
from camring.drawing.scale import Axis, covering
from camring.drawing.strips import HEIGHT, Strip
from camring.files.quantities import significant
from camring.presentation.records import Design
from camring.report.figure import Figure, around, degrees, design_styles, legend, period_axis

__all__ = ["pressure_figures"]


def _bar(designs: Sequence[Design], index: int) -> list[np.ndarray]:
    return [1e-5 * d.results[index].waves.chamber_pressure for d in designs]


def _port_rules(designs: Sequence[Design], index: int) -> list[Rule]:
    point = designs[-1].results[index].point
    return [
        Rule(1e-5 * point.supply_pressure, f"supply {1e-5 * point.supply_pressure:.4g} bar"),
        Rule(1e-5 * point.return_pressure, f"return {1e-5 * point.return_pressure:.4g} bar"),
    ]


def _strips(designs: Sequence[Design], index: int, low: float, high: float) -> list[Strip]:
    strips = []
    for design, style in zip(designs, design_styles(designs), strict=True):
        waves = design.results[index].waves
        angle, supply = around(waves.angle, waves.supply_opening, low, high)
        _, return_ = around(waves.angle, waves.return_opening, low, high)
        label = design.label if len(designs) > 1 else "ports"
        strips.append(Strip(degrees(angle), supply, return_, label[:8], style))
    return strips


def _over_lobe(designs: Sequence[Design], index: int) -> Figure:
    curves = _bar(designs, index)
    axis = period_axis(designs)
    layers: list = [*_port_rules(designs, index)]
    layers += [
        Curve(degrees(d.results[index].waves.angle), y, d.label, style)
        for d, y, style in zip(designs, curves, design_styles(designs), strict=True)
    ]
    name = f"pressure-{index}"
    point = designs[-1].results[index].point
    ports = (1e-5 * point.supply_pressure, 1e-5 * point.return_pressure)
    svg = draw(
        Chart(
            name,
            "Chamber pressure over one lobe",
            "Absolute chamber pressure against shaft angle, with the openings of supply and "
            "return ports below.",
            axis,
            covering("Chamber pressure (absolute)", "bar", curves, include=ports),
            layers,
            legend(designs),
            width=1064.0,
            height=330.0 + HEIGHT * len(designs),
            strips=_strips(designs, index, 0.0, np.radians(axis.high)),
        )
    )
    return Figure(
        name,
        "Chamber pressure and port windows",
        svg,
        "A chamber is filled at supply pressure while its roller runs outward and emptied at "
        "return pressure while it runs inward; the hatched areas show how far each port is open.",
        wide=True,
    )


def _glass(design: Design) -> float:
    """Half width of the magnified view, rad: twice the gap between the windows, within reason."""
    waves = design.results[0].waves
    pitch = 2 * np.pi / design.facts.lobes
    closed = float(np.mean((waves.supply_opening <= 0) & (waves.return_opening <= 0)))
    both = float(np.mean((waves.supply_opening > 0) & (waves.return_opening > 0)))
    return float(np.clip(0.055 + max(closed, both), 0.06, 0.16)) * pitch


def _dead_centre(designs: Sequence[Design], index: int, which: str) -> Figure:
    last = designs[-1]
    waves = last.results[index].waves
    sample = np.argmin(waves.lift) if which == "inner" else np.argmax(waves.lift)
    centre, half = float(waves.angle[sample]), _glass(last)
    if which == "inner" and last.facts.repeats == last.facts.lobes:
        centre = 0.0 if centre > 0.5 * waves.angle[-1] or centre == 0 else centre
    low, high = centre - half, centre + half
    layers: list = [*_port_rules(designs, index)]
    seen = []
    for design, style in zip(designs, design_styles(designs), strict=True):
        wave = design.results[index].waves
        angle, pressure = around(wave.angle, 1e-5 * wave.chamber_pressure, low, high)
        near = (angle >= low) & (angle <= high)
        seen.append(pressure[near])
        layers.append(Curve(degrees(angle - centre), pressure, design.label, style))
    layers.append(Rule(0.0, "", upright=True))
    point = last.results[index].point
    ports = (1e-5 * point.supply_pressure, 1e-5 * point.return_pressure)
    name = f"{which}-{index}"
    strips = [
        Strip(s.x - float(np.degrees(centre)), s.supply, s.return_, s.label, s.style)
        for s in _strips(designs, index, low, high)
    ]
    span = float(np.degrees(half))
    svg = draw(
        Chart(
            name,
            f"Chamber pressure around the {which} dead centre",
            f"Chamber pressure within {span:.1f} degrees of the {which} dead centre, with the "
            "port openings.",
            Axis(f"Angle from {which} dead centre", "deg", -span, span, "angle", 6),
            covering("Chamber pressure (absolute)", "bar", seen, include=ports),
            layers,
            legend(designs),
            height=310.0 + HEIGHT * len(designs),
            strips=strips,
        )
    )
    return Figure(
        name,
        f"{which.capitalize()} dead centre, magnified",
        svg,
        _change_over(designs, seen, which),
    )


def _change_over(designs: Sequence[Design], seen: list[np.ndarray], which: str) -> str:
    direction = "from return to supply" if which == "inner" else "from supply to return"
    ranges = " and ".join(
        f"{'' if len(designs) == 1 else design.label + ' '}between {significant(y.min(), 3)} and "
        f"{significant(y.max(), 3)} bar"
        for design, y in zip(designs, seen, strict=True)
    )
    return (
        f"Change-over {direction}. While both ports are shut the pressure follows the trapped "
        f"volume; a port that opens before the pressures have met lets oil rush. In this view: "
        f"{ranges}."
    )


def _flows(designs: Sequence[Design], index: int) -> Figure:
    layers: list = [Rule(0.0)]
    seen = []
    for design, style in zip(designs, design_styles(designs), strict=True):
        waves = design.results[index].waves
        for field in ("supply_flow", "return_flow"):
            flow = 6e4 * getattr(waves, field)
            seen.append(flow)
            name = f"{design.label}, {field.partition('_')[0]}"
            layers.append(Curve(degrees(waves.angle), flow, name, style))
    svg = draw(
        Chart(
            f"flows-{index}",
            "Flow through the ports of one chamber",
            "Flow into one chamber from the supply port and from the return port over one period "
            "of the cam; negative flow leaves the chamber.",
            period_axis(designs),
            covering("Flow into one chamber", "L/min", seen),
            layers,
            legend(designs),
        )
    )
    return Figure(
        f"flows-{index}",
        "Flow of one chamber",
        svg,
        "Supply flows in (above zero), return flows out (below). A spike at a change-over is oil "
        "that rushes through a port just opened, heard as noise; a smooth hump is work.",
    )


def _loop(designs: Sequence[Design], index: int) -> Figure:
    curves = _bar(designs, index)
    volumes = [1e6 * d.results[index].waves.volume for d in designs]
    name = f"indicator-{index}"
    layers: list = [*_port_rules(designs, index)]
    layers += [
        Loop(v, p, d.label, style)
        for v, p, d, style in zip(volumes, curves, designs, design_styles(designs), strict=True)
    ]
    svg = draw(
        Chart(
            name,
            "Pressure against volume",
            "Chamber pressure against chamber volume over one cycle.",
            covering("Chamber volume", "cm³", volumes, margin=0.04),
            covering("Chamber pressure (absolute)", "bar", curves),
            layers,
            legend(designs),
            readable=False,
        )
    )
    return Figure(
        name,
        "Work of one chamber",
        svg,
        "The area inside the loop is the work of one chamber in one stroke; square corners waste "
        "nothing, slanted ones show compression and throttling.",
    )


def pressure_figures(designs: Sequence[Design], index: int) -> list[Figure]:
    """Chamber pressure at one operating point, four ways."""
    return [
        _over_lobe(designs, index),
        _dead_centre(designs, index, "inner"),
        _dead_centre(designs, index, "outer"),
        _loop(designs, index),
        _flows(designs, index),
    ]

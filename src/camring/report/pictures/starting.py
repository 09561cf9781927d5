"""Torque with which the shaft starts under pressure, wherever it stands, both ways."""

from collections.abc import Sequence

import numpy as np

from camring.drawing.chart import Chart, draw
from camring.drawing.layers import Curve, Rule
from camring.drawing.scale import Axis, covering
from camring.files.quantities import significant
from camring.presentation.records import Design, Start
from camring.report.figure import Figure, degrees, design_styles, legend

__all__ = ["starting_figures"]


def starting_figures(designs: Sequence[Design], point: int) -> list[Figure]:
    """One picture for each direction; none where nothing is known of the start."""
    starts = [design.results[point].start for design in designs]
    known = [start for start in starts if start is not None]
    if len(known) < len(designs):
        return []
    ways = (("start", "Starting torque", ""), ("start-back", "The same backwards", "_back"))
    return [_one_way(designs, known, point, *way) for way in ways]


def _one_way(
    designs: Sequence[Design], starts: Sequence[Start], point: int, name: str, title: str, way: str
) -> Figure:
    waves = [start.backwards if way else start.torque for start in starts]
    layers: list = [Rule(starts[-1].ideal_torque)]
    for design, style, start, torque in zip(
        designs, design_styles(designs), starts, waves, strict=True
    ):
        layers.append(Curve(degrees(start.angle), torque, design.label, style))
    reach = float(np.degrees(starts[-1].angle[-1]))
    ideal = starts[-1].ideal_torque
    vertical = covering("Torque at standstill", "N·m", waves, include=[0.0, ideal])
    svg = draw(
        Chart(
            f"{name}-{point}",
            title,
            "Torque of all pistons at standstill over the angle of the shaft; the rule is the "
            "ideal torque.",
            Axis("Shaft angle", "deg", 0.0, reach, "angle", 6),
            vertical,
            layers,
            legend(designs),
        )
    )
    least = [float(np.min(torque)) for torque in waves]
    shares = [low / start.ideal_torque for low, start in zip(least, starts, strict=True)]
    names = [f"{each.label}: " if len(designs) > 1 else "" for each in designs]
    said = ", ".join(
        f"{name}{significant(low)} N·m ({significant(100 * share, 3)} % of ideal)"
        for name, low, share in zip(names, least, shares, strict=True)
    )
    said = said.replace("\u2009", "\u202f")  # a number stays on its line
    sentence = f"The least that the shaft starts with, wherever it stands (ISO 4392): {said}."
    return Figure(f"{name}-{point}", title, svg, sentence)

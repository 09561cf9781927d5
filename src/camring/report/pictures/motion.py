"""Piston motion: lift and its three derivatives in time."""

from collections.abc import Sequence

import numpy as np

from camring.drawing.chart import Chart, draw
from camring.drawing.layers import Curve, Rule
from camring.drawing.scale import covering
from camring.presentation.records import Design
from camring.report.figure import Figure, degrees, design_styles, legend, period_axis

__all__ = ["motion_figures"]

_MOTIONS = (
    ("lift", "Lift", "mm", 1e3, "Piston travel out of its innermost position."),
    (
        "velocity",
        "Velocity",
        "m/s",
        1.0,
        "What each chamber swallows and gives back: where the velocities of all pistons on "
        "supply add up to a constant, flow and torque are smooth.",
    ),
    (
        "acceleration",
        "Acceleration",
        "m/s²",
        1.0,
        "Inertia of piston and roller; it pulls the roller off the ring where it is negative at "
        "high lift.",
    ),
    (
        "jerk",
        "Jerk",
        "km/s³",
        1e-3,
        "Steps of jerk belong to the knots of a cubic spline; their height says how harshly the "
        "mechanism is treated.",
    ),
)


def motion_figures(designs: Sequence[Design], index: int) -> list[Figure]:
    """Four charts over one period of the cam at one operating point."""
    figures = []
    for field, title, unit, factor, sentence in _MOTIONS:
        curves: list[np.ndarray] = [
            factor * getattr(design.results[index].waves, field) for design in designs
        ]
        layers: list = [] if field == "lift" else [Rule(0.0)]
        layers += [
            Curve(degrees(d.results[index].waves.angle), y, d.label, style)
            for d, y, style in zip(designs, curves, design_styles(designs), strict=True)
        ]
        svg = draw(
            Chart(
                f"{field}-{index}",
                f"Piston {title.lower()}",
                f"Piston {title.lower()} over one period of the cam.",
                period_axis(designs),
                covering(title, unit, curves, include=(0.0,) if field == "lift" else ()),
                layers,
                legend(designs),
                height=250.0,
            )
        )
        figures.append(Figure(f"{field}-{index}", title, svg, sentence))
    return figures

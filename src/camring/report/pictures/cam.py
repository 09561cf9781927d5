"""The ring: as a whole, and unrolled against the angle."""

from collections.abc import Sequence
from math import pi

import numpy as np

from camring.drawing.chart import Chart, draw, picture
from camring.drawing.layers import Curve, Rule
from camring.drawing.marks import row_of_keys
from camring.drawing.path import polyline
from camring.drawing.scale import covering
from camring.drawing.svg import element, group, number, words
from camring.files.quantities import significant
from camring.presentation.records import Design, Profile
from camring.report.figure import Figure, around, degrees, design_styles, legend, period_axis

__all__ = ["cam_figures", "pitch_curve", "working_surface"]

SIZE = 520.0


def pitch_curve(profile: Profile) -> tuple[np.ndarray, np.ndarray]:
    """Roller centre round the whole ring, x and y in m."""
    angle, radius = around(profile.angle, profile.radius, 0.0, 2 * pi - 1e-9)
    return radius * np.cos(angle), radius * np.sin(angle)


def working_surface(profile: Profile, roller_radius: float) -> tuple[np.ndarray, np.ndarray]:
    """The ring's inside, one roller radius outside the pitch curve along its normal, m."""
    angle, radius = around(profile.angle, profile.radius, 0.0, 2 * pi - 1e-9)
    _, slope = around(profile.angle, profile.slope, 0.0, 2 * pi - 1e-9)
    length = np.hypot(radius, slope)
    outward, forward = radius / length * roller_radius, -slope / length * roller_radius
    along, across = radius + outward, forward
    return (
        along * np.cos(angle) - across * np.sin(angle),
        along * np.sin(angle) + across * np.cos(angle),
    )


def _ring(designs: Sequence[Design]) -> Figure:
    styles = design_styles(designs)
    surfaces = [working_surface(d.profile, d.facts.roller_radius) for d in designs]
    reach = 1.09 * max(float(np.hypot(*surface).max()) for surface in surfaces)
    middle, scale = SIZE / 2, (SIZE / 2 - 8) / reach

    def place(x: np.ndarray, y: np.ndarray) -> str:
        return polyline(middle + scale * x, middle - scale * y, plane=True)

    body = element("circle", cx=middle, cy=middle, r=reach * scale, class_="steel")
    bore = element("path", d=place(*surfaces[-1]) + "Z", fill="#ffffff", stroke="none")
    lines = []
    for design, line_style, surface in zip(designs, styles, surfaces, strict=True):
        style = {"fill": "none", "stroke": line_style.colour, "stroke_dasharray": line_style.dash}
        lines += [
            element("path", d=place(*surface) + "Z", stroke_width=line_style.width, **style),
            element("path", d=place(*pitch_curve(design.profile)) + "Z", stroke_width=0.8, **style),
        ]
    cross = element(
        "path",
        d=f"M{number(middle - 9)} {middle:g}h18M{middle:g} {number(middle - 9)}v18",
        class_="axis",
        fill="none",
    )
    last = designs[-1]
    low, high = 1e3 * last.profile.radius.min(), 1e3 * last.profile.radius.max()
    middle_words = group(
        words(middle, middle - 46, "pitch curve (thin)", class_="note", text_anchor="middle"),
        words(middle, middle - 32, f"radius {low:.2f} to {high:.2f} mm", class_="note",
              text_anchor="middle"),
        words(middle, middle + 36, "working surface (thick)", class_="note", text_anchor="middle"),
        words(middle, middle + 50, f"roller radius {1e3 * last.facts.roller_radius:.4g} mm",
              class_="note", text_anchor="middle"),
    )  # fmt: skip
    keys = legend(designs)
    lift = 24.0 if keys else 0.0
    drawing = group(body, bore, cross, *lines, middle_words, transform=f"translate(0 {lift:g})")
    svg = picture(
        "ring",
        "Cam ring, true shape",
        "The whole ring with its working surface and the path of the roller centre.",
        (SIZE, SIZE + lift),
        drawing,
        row_of_keys(keys, SIZE, 16.0),
    )
    lobes = last.facts.lobes
    return Figure(
        "ring",
        "The ring, to scale",
        svg,
        f"The ring's inside with {lobes} lobes (thick) and the path of the roller centres (thin); "
        "the tinted body is steel.",
        tall=True,
    )


def _unrolled(designs: Sequence[Design]) -> Figure:
    curves = [1e3 * d.profile.radius for d in designs]
    layers = [
        Curve(degrees(d.profile.angle), y, d.label, line_style)
        for d, y, line_style in zip(designs, curves, design_styles(designs), strict=True)
    ]
    svg = draw(
        Chart(
            "radius",
            "Pitch radius against shaft angle",
            "Radius of the roller centre over one period of the cam.",
            period_axis(designs),
            covering("Pitch radius", "mm", curves),
            layers,
            legend(designs),
        )
    )
    sentence = "The path of a roller centre over one lobe, from one inner dead centre to the next."
    if len(designs) == 2 and len(curves[0]) == len(curves[1]):
        moved = float(np.abs(curves[1] - curves[0]).max())
        sentence += f" The two cams differ by at most {significant(moved, 2)} mm."
    return Figure("radius", "Pitch radius", svg, sentence)


def _pressure_angle(designs: Sequence[Design]) -> Figure:
    curves = [degrees(d.profile.pressure_angle) for d in designs]
    layers: list = [Rule(0.0)]
    layers += [
        Curve(degrees(d.profile.angle), y, d.label, line_style)
        for d, y, line_style in zip(designs, curves, design_styles(designs), strict=True)
    ]
    svg = draw(
        Chart(
            "pressure-angle",
            "Pressure angle",
            "Angle between the contact normal and the piston axis over one period of the cam.",
            period_axis(designs),
            covering("Pressure angle", "deg", curves),
            layers,
            legend(designs),
        )
    )
    most = float(np.abs(curves[-1]).max())
    return Figure(
        "pressure-angle",
        "Pressure angle",
        svg,
        "How far the ring leans against the piston's axis. The lean makes the torque, and presses "
        f"the piston sideways in its bore; at most {significant(most, 3)} deg here.",
    )


def cam_figures(designs: Sequence[Design]) -> list[Figure]:
    """The ring to scale, and three things about it against the angle."""
    return [_ring(designs), _unrolled(designs), _pressure_angle(designs)]

"""The motor in cross-section, ready to be turned: chambers by pressure, forces on the rollers.

Drawn at shaft angle zero here; the page's script moves the same parts, from
the same tables, which ride along as attributes.
"""

import json
from collections.abc import Sequence
from math import cos, pi, sin

import numpy as np

from camring.drawing.chart import picture
from camring.drawing.palette import INK, PRESSURE_STOPS, RETURN, SUPPLY, pressure_colour
from camring.drawing.path import polyline
from camring.drawing.svg import element, group, number, words
from camring.presentation.records import Design, Result
from camring.report.figure import Figure, around
from camring.report.pictures.cam import working_surface

__all__ = ["machine_figure"]

SIZE, HEAD, FOOT = 520.0, 26.0, 40.0
MIDDLE = SIZE / 2
SAMPLES = 720
ARROW = 34.0  # px of the largest contact force


class _Layout:
    """Lengths of one machine on paper; what the model does not know is chosen to look right."""

    def __init__(self, design: Design) -> None:
        facts, profile = design.facts, design.profile
        surface = working_surface(profile, facts.roller_radius)
        self.reach = 1.10 * float(np.hypot(*surface).max())
        self.scale = (SIZE / 2 - 8) / self.reach
        least = float(profile.radius.min())
        roller, bore = facts.roller_radius, facts.bore
        # Neighbouring bores must not meet at the block's core, nor the crown sit in the roller.
        free = least - 0.5 * bore / np.tan(pi / max(facts.pistons, 3)) - 0.12 * bore
        self.skirt = float(np.clip(free, 0.9 * roller, roller + 0.9 * bore))
        self.floor = least - self.skirt - 0.12 * bore
        self.bore, self.roller = bore, roller
        self.block = least - 0.55 * roller
        self.plate_in = max(0.34 * self.floor, 0.2 * least)
        self.plate_out = max(0.62 * self.floor, self.plate_in + 0.08 * least)

    def px(self, length: float) -> float:
        return float(length * self.scale)


def _sector(layout: _Layout, centre: float, width: float) -> str:
    """An annular sector between the plate's radii, as a path."""
    inner, outer = layout.px(layout.plate_in), layout.px(layout.plate_out)
    start, end = centre - width / 2, centre + width / 2
    corners = [
        (MIDDLE + r * cos(a), MIDDLE - r * sin(a))
        for r, a in ((inner, start), (outer, start), (outer, end), (inner, end))
    ]
    a, b, c, d = (f"{number(x)} {number(y)}" for x, y in corners)
    large = int(width > pi)
    return (
        f"M{a}L{b}A{number(outer)} {number(outer)} 0 {large} 0 {c}"
        f"L{d}A{number(inner)} {number(inner)} 0 {large} 1 {a}Z"
    )


def _ports(design: Design, layout: _Layout, result: Result) -> str:
    """Windows of the valve plate, where the openings of a chamber are above zero."""
    pieces = []
    for share, name, colour in (
        (result.waves.supply_opening, "supply", SUPPLY),
        (result.waves.return_opening, "return", RETURN),
    ):
        angle, opening = around(result.waves.angle, share, 0.0, 4 * pi - 1e-9)
        inside = np.concatenate([[False], opening > 1e-9, [False]])
        edges = np.flatnonzero(inside[1:] != inside[:-1])
        for start, end in zip(edges[::2], edges[1::2], strict=True):
            first, last = float(angle[start]), float(angle[min(end, len(angle) - 1)])
            if start == 0 or first >= 2 * pi + angle[1] / 2:
                continue
            pieces.append(
                element(
                    "path",
                    d=_sector(layout, (first + last) / 2, last - first),
                    fill=f"url(#hatch-{name})",
                    stroke=colour,
                    stroke_width=1,
                )
            )
    return group(*pieces)


def _tables(design: Design, result: Result, layout: _Layout) -> dict[str, object]:
    """One period of radius, pressure share, force share and torque for the script."""
    period = 2 * pi / design.facts.repeats
    angle = np.linspace(0, period, SAMPLES, endpoint=False)

    def sampled(source: np.ndarray, values: np.ndarray) -> np.ndarray:
        return np.interp(angle, source, values)

    waves, point = result.waves, result.point
    lower = min(point.supply_pressure, point.return_pressure)
    share = (sampled(waves.angle, waves.chamber_pressure) - lower) / abs(point.pressure_drop)
    radius = sampled(design.profile.angle, design.profile.radius)
    normal = sampled(waves.angle, waves.contact_force)
    return {
        "pistons": design.facts.pistons,
        "repeats": design.facts.repeats,
        "radius": np.round(radius * layout.scale, 2).tolist(),
        "pressure": np.round(1000 * share).astype(int).tolist(),
        "force": np.round(1000 * normal / float(np.abs(normal).max())).astype(int).tolist(),
        "torque": np.round(sampled(waves.angle, waves.torque), 1).tolist(),
        "skirt": round(layout.px(layout.skirt), 2),
        "floor": round(layout.px(layout.floor), 2),
        "roller": round(layout.px(layout.roller), 2),
        "stops": [[place, list(colour)] for place, colour in PRESSURE_STOPS],
        "arrow": ARROW,
    }


def _unit(table: dict, layout: _Layout, place: float) -> str:
    """One piston with chamber, roller and force at its polar angle `place`."""
    count = SAMPLES * table["repeats"]
    index = round(place / (2 * pi) * count)
    radius = table["radius"][index % SAMPLES]
    slope = (
        (table["radius"][(index + 1) % SAMPLES] - table["radius"][(index - 1) % SAMPLES])
        * count
        / (4 * pi)
    )
    lean = np.arctan2(slope, radius)
    force = table["force"][index % SAMPLES] / 1000
    bore, roller = layout.px(layout.bore), table["roller"]
    crown = radius - table["skirt"]
    out_x, out_y = roller * float(np.cos(lean)), roller * float(np.sin(lean))
    far = (roller + 5 + ARROW * max(force, 0.0)) / roller
    return group(
        element(
            "rect",
            x=table["floor"],
            y=-bore / 2,
            width=max(crown - table["floor"], 0.0),
            height=bore,
            fill=pressure_colour(table["pressure"][index % SAMPLES] / 1000),
            class_="chamber",
        ),
        group(
            element(
                "rect", x=-table["skirt"], y=-bore / 2, width=table["skirt"], height=bore,
                class_="piston",
            ),
            element("circle", cx=0.0, cy=0.0, r=roller, class_="roller"),
            element(
                "line",
                x1=out_x * far,
                y1=out_y * far,
                x2=out_x * (roller + 3) / roller,
                y2=out_y * (roller + 3) / roller,
                class_="force",
                marker_end="url(#arrow-head)",
                visibility="visible" if force > 0.02 else "hidden",
            ),
            class_="slide",
            transform=f"translate({number(radius)} 0)",
        ),
        class_="unit",
        transform=f"rotate({number(float(-np.degrees(place)))})",
    )  # fmt: skip


def _pressure_key(result: Result) -> str:
    """The scale of chamber colours, from return to supply."""
    left, width, y = MIDDLE - 90, 180.0, SIZE + HEAD + 8
    cells = [
        element(
            "rect", x=left + width * k / 36, y=y, width=width / 36 + 0.3, height=10.0,
            fill=pressure_colour((k + 0.5) / 36),
        )
        for k in range(36)
    ]  # fmt: skip
    point = result.point
    low = words(left - 8, y + 9, f"return {1e-5 * point.return_pressure:.4g} bar", class_="note",
                text_anchor="end")  # fmt: skip
    high = words(left + width + 8, y + 9, f"supply {1e-5 * point.supply_pressure:.4g} bar",
                 class_="note")  # fmt: skip
    return group(*cells, low, high)


def _section(design: Design, index: int, number_of_designs: int, which: int) -> str:
    result = design.results[index]
    layout = _Layout(design)
    table = _tables(design, result, layout)
    surface = working_surface(design.profile, design.facts.roller_radius)
    inside = polyline(
        MIDDLE + layout.scale * surface[0], MIDDLE - layout.scale * surface[1], plane=True
    )
    pistons = design.facts.pistons
    units = [_unit(table, layout, 2 * pi * k / pistons) for k in range(pistons)]
    name = f"machine-{index}-{which}"
    title = words(4.0, 15.0, design.label.capitalize(), class_="label strong")
    drawing = group(
        element("circle", cx=MIDDLE, cy=MIDDLE, r=layout.px(layout.reach), class_="steel"),
        element("path", d=inside + "Z", class_="ring-inside"),
        element("circle", cx=MIDDLE, cy=MIDDLE, r=layout.px(layout.block), class_="block"),
        group(*units, class_="units", transform=f"translate({number(MIDDLE)} {number(MIDDLE)})"),
        element("circle", cx=MIDDLE, cy=MIDDLE, r=layout.px(layout.plate_out) + 5, class_="plate"),
        _ports(design, layout, result),
        _turning(layout.px(layout.plate_in)),
        transform=f"translate(0 {number(HEAD)})",
    )
    return picture(
        name,
        f"Cross-section of the {design.label} motor",
        "The motor seen along its shaft: the ring with its lobes, the turning block with pistons "
        "and rollers, chambers coloured by pressure, and arrows for the forces on the rollers.",
        (SIZE, SIZE + HEAD + FOOT - 12),
        title if number_of_designs > 1 else "",
        drawing,
        _pressure_key(result),
        class_="chart section",
        data_machine=json.dumps(table, separators=(",", ":")),
    )


def _turning(radius: float) -> str:
    """A bent arrow in the middle: which way the block turns."""
    r = 0.62 * radius
    start, end = 0.2 * pi, 1.55 * pi
    a = f"{number(MIDDLE + r * cos(start))} {number(MIDDLE - r * sin(start))}"
    b = f"{number(MIDDLE + r * cos(end))} {number(MIDDLE - r * sin(end))}"
    x, y = MIDDLE + r * cos(end), MIDDLE - r * sin(end)
    tip = element(
        "path",
        d="M-4 -5L5 0L-4 5Z",
        fill=INK,
        transform=f"translate({number(x)} {number(y)}) rotate(-9)",
    )
    bow = element(
        "path",
        d=f"M{a}A{number(r)} {number(r)} 0 1 0 {b}",
        fill="none",
        stroke=INK,
        stroke_width=1.4,
    )
    return bow + tip


def _turns(result: Result) -> bool:
    waves = result.waves
    needed = (waves.chamber_pressure, waves.contact_force, waves.torque)
    return all(bool(np.isfinite(values).all()) for values in needed)


def machine_figure(designs: Sequence[Design], index: int) -> Figure | None:
    """At most two cross-sections side by side, with one slider that turns both.

    Designs whose simulation failed have no pressure to show and are left out.
    """
    working = [design for design in designs if _turns(design.results[index])]
    if not working:
        return None
    shown = working if len(working) <= 2 else [working[0], working[-1]]
    sections = "".join(
        element("div", _section(design, index, len(shown), k), class_="picture")
        for k, design in enumerate(shown)
    )
    label = f"Shaft angle at operating point {index + 1}"
    controls = element(
        "div",
        element("button", "▶ Turn", type="button", class_="play"),
        '<input type="range" min="0" max="360" step="0.25" value="0" '
        f'aria-label="{label}, degrees">',
        element("output", "0 deg"),
        class_="controls",
    )
    labels = json.dumps([design.label for design in shown])
    body = element("div", sections, class_="sections" if len(shown) > 1 else "sections lone")
    machine = element(
        "div", body, controls, class_="machine", data_labels=labels,
        data_lobes=designs[-1].facts.lobes,
    )  # fmt: skip
    return Figure(
        f"machine-{index}",
        "The motor in cross-section",
        machine,
        "Ring and valve plate stand still, the block with its pistons turns. Chambers are dark at "
        "supply pressure and light at return pressure; each arrow is the force of the ring on a "
        "roller, whose lean against the ring turns the shaft. Ring, rollers, bores and port "
        "windows are to scale; the block's inside is only indicated.",
        wide=True,
    )

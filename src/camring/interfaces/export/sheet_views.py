"""The views of the drawing sheet: ring, its section, valve plate."""

from math import degrees, pi, radians
from typing import NamedTuple

import numpy as np

from camring.geometry.port_shape import PlatePorts, Slot
from camring.interfaces.export.paper import CHAIN, THICK, THIN, Paper, around
from camring.interfaces.export.ring import Ring
from camring.interfaces.export.ring_svg import path_of
from camring.numerics.closed_spline import ClosedSpline

__all__ = ["Scale", "draw_plate", "draw_ring", "draw_section", "scale_for"]

Place = tuple[float, float]


class Scale(NamedTuple):
    """A scale of ISO 5455: millimetres on paper for each millimetre of the part."""

    factor: float
    name: str


def scale_for(radius: float, room: float) -> Scale:
    """The largest usual scale at which a radius (m) fits a room (mm)."""
    for enlarged in (10, 5, 2, 1):
        if 1e3 * radius * enlarged <= room:
            return Scale(float(enlarged), f"{enlarged}:1")
    for part in (2, 5, 10, 20, 50, 100):
        if 1e3 * radius / part <= room:
            return Scale(1 / part, f"1:{part}")
    return Scale(1 / 200, "1:200")


def draw_ring(paper: Paper, centre: Place, scale: float, ring: Ring, outer_radius: float) -> None:
    """The ring seen along the shaft."""
    outer = 1e3 * scale * outer_radius
    paper.circle(centre, outer, THICK)
    _curve(paper, centre, scale, ring.surface, THICK, "")
    _curve(paper, centre, scale, ring.pitch, 0.25, CHAIN)
    for dx, dy in ((1, 0), (0, 1)):
        x, y = dx * (outer + 4), dy * (outer + 4)
        paper.line(
            (centre[0] - x, centre[1] - y), (centre[0] + x, centre[1] + y), width=0.13, dash=CHAIN
        )
    paper.text(centre[0] + outer + 5, centre[1] + 0.9, "0°", 2.8)
    _roller(paper, centre, scale, ring)
    _radii(paper, centre, scale, ring, outer)
    _angles(paper, centre, scale, ring)


def _curve(
    paper: Paper, centre: Place, scale: float, curve: ClosedSpline, width: float, dash: str
) -> None:
    shifted = ClosedSpline(
        curve.arc, curve.point + complex(centre[0], -centre[1]) / (1e3 * scale), curve.error
    )
    paper.path(path_of(shifted, scale, 4), width, dash)


def _near(ring: Ring, angle: float, wanted: float) -> float:
    """An extreme's angle in the period nearest to a wanted one, degrees."""
    period = degrees(ring.period)
    return degrees(angle) + period * round((wanted - degrees(angle)) / period)


def _roller(paper: Paper, centre: Place, scale: float, ring: Ring) -> None:
    angle = _near(ring, ring.outer[1], 315.0)
    place = around(centre, 1e3 * scale * ring.outer[0], angle)
    radius = 1e3 * scale * ring.roller_radius
    paper.circle(place, radius, 0.25)
    paper.circle(place, 0.4, 0.25, fill="#000")
    corner = (centre[0] + 52, centre[1] + 79)
    paper.arrow(around(place, radius, -60), corner, (corner[0] + 2, corner[1]))
    paper.text(corner[0] + 3, corner[1] + 0.9, f"roller Ø {2e3 * ring.roller_radius:.4g}", 2.8)


def _radii(paper: Paper, centre: Place, scale: float, ring: Ring, outer: float) -> None:
    """Leaders from the surface to its smallest and largest radius, and to the pitch curve."""
    leaders = (
        (ring.surface_outer, ring.outer[1], 125.0, (-82.0, -84.0),
         f"R {1e3 * ring.surface_outer:.4f} largest"),
        (ring.surface_inner, ring.inner[1], 55.0, (36.0, -84.0),
         f"R {1e3 * ring.surface_inner:.4f} smallest"),
        (ring.outer[0], ring.outer[1], 225.0, (-82.0, 80.0),
         f"pitch curve R {1e3 * ring.inner[0]:.4f} … {1e3 * ring.outer[0]:.4f}"),
    )  # fmt: skip
    for radius, angle, wanted, (dx, dy), told in leaders:
        place = around(centre, 1e3 * scale * radius, _near(ring, angle, wanted))
        corner = (centre[0] + dx, centre[1] + dy)
        paper.text(*corner, told, 2.8)
        width = 1.45 * len(told)
        end = corner[0] + (width if place[0] > corner[0] + width else 0.0)
        end = min(max(place[0], corner[0]), corner[0] + width) if dx > 0 else end
        below = corner[1] + 1.0 if dy < 0 else corner[1] - 3.0
        paper.arrow(place, (end, below))
        paper.line((corner[0], below), (corner[0] + width, below))
    side = around(centre, outer, 180 + 18)
    paper.arrow(side, (centre[0] - 84, side[1] + 8))
    paper.text(centre[0] - 84, side[1] + 11.4, f"Ø {2 * outer / scale:.5g}", 2.8)


def _angles(paper: Paper, centre: Place, scale: float, ring: Ring) -> None:
    """Angle of one lobe, and the sense of rotation."""
    inner = 1e3 * scale * ring.inner[0]
    if ring.repeats > 1:
        start = degrees(ring.inner[1])
        end = start + degrees(ring.period)
        for angle in (start, end):
            paper.line(centre, around(centre, inner, angle), width=0.13)
        paper.arc(centre, 0.72 * inner, start, end, "se")
        x, y = around(centre, 0.8 * inner, (start + end) / 2)
        told = f"{ring.repeats} × {degrees(ring.period):.6g}°"
        paper.text(x, y + 1, told, 2.8, anchor="middle")
    else:
        x, y = around(centre, 0.72 * inner, 45)
        paper.text(x, y, "free ring", 2.8, anchor="middle")
    paper.arc(centre, 0.36 * inner, 200, 290, "e")
    x, y = around(centre, 0.36 * inner, 245)
    paper.text(x - 2, y + 4, "rotation +", 2.5, anchor="middle")


def draw_section(
    paper: Paper, centre: Place, scale: float, ring: Ring, outer_radius: float, width: float
) -> None:
    """The ring cut along the shaft; the cut goes up and down from the shaft."""
    parameter = ring.outline.parameter_at(np.radians([90.0, 270.0]))
    radii = np.abs(ring.outline.places(parameter, ring.roller_radius).point)
    half, outer = 1e3 * scale * width / 2, 1e3 * scale * outer_radius
    half = min(half, 12.0)
    x, y = centre
    for side, radius in zip((-1, 1), radii, strict=True):
        edge, inside = y + side * outer, y + side * 1e3 * scale * radius
        path = f"M{x - half:.3f} {edge:.3f}h{2 * half:.3f}V{inside:.3f}h{-2 * half:.3f}Z"
        paper.path(path, THICK, fill="url(#hatch)")
    top, bottom = y - 1e3 * scale * radii[0], y + 1e3 * scale * radii[1]
    for place in (x - half, x + half):
        paper.line((place, top), (place, bottom), width=0.25)
        paper.line((place, y + outer + 1), (place, y + outer + 6))
    paper.line((x - half - 3, y), (x + half + 3, y), width=0.13, dash=CHAIN)
    line = y + outer + 5
    paper.arrow((x - half, line), (x, line))
    paper.arrow((x + half, line), (x, line))
    paper.text(x, line + 4, f"{1e3 * width:.4g}", 2.8, anchor="middle")


def draw_plate(paper: Paper, centre: Place, scale: float, ports: PlatePorts) -> None:
    """All slots, lettered S for supply and R for return; timing of the first of each."""
    grown = 1e3 * scale
    for slot in ports.slots:
        paper.path(_slot_path(centre, grown, ports, slot), 0.35)
        x, y = around(centre, grown * ports.circle, degrees(slot.centre))
        paper.text(x, y + 0.9, slot.kind[0].upper(), 2.5, anchor="middle")
    paper.circle(centre, grown * ports.circle, 0.13, CHAIN)
    reach = grown * ports.outer
    for dx, dy in ((1, 0), (0, 1)):
        x, y = dx * (reach + 3), dy * (reach + 3)
        paper.line(
            (centre[0] - x, centre[1] - y), (centre[0] + x, centre[1] + y), width=0.13, dash=CHAIN
        )
    for kind in ("supply", "return"):
        slot = next(slot for slot in ports.slots if slot.kind == kind)
        for angle in (slot.opens, slot.closes):
            turned = degrees(angle) % 360
            paper.line(
                around(centre, grown * ports.inner, turned), around(centre, reach + 2.5, turned)
            )
            flip = 90 < turned < 270
            x, y = around(centre, reach + 3.2, turned - (0.75 if not flip else -0.75))
            paper.text(x, y, f"{turned:.2f}°", 2.2, anchor="end" if flip else "start",
                       turned=turned + 180 if flip else turned)  # fmt: skip
    told = f"port circle R {1e3 * ports.circle:.4g}, height {1e3 * ports.height:.4g}"
    paper.text(centre[0], centre[1] + 45.5, told, 2.5, anchor="middle")


def _slot_path(centre: Place, grown: float, ports: PlatePorts, slot: Slot) -> str:
    start, end = slot.start, slot.end
    cap = ""
    if ports.shape == "round":
        half = ports.chamber_width / 2
        start, end = start + half, end - half
        radius = grown * ports.height / 2
        cap = f"A{radius:.3f} {radius:.3f} 0 0 "
    inner, outer = grown * ports.inner, grown * ports.outer
    places = [
        around(centre, radius, degrees(angle))
        for radius, angle in ((outer, start), (outer, end), (inner, end), (inner, start))
    ]
    (a, b, c, d) = (f"{x:.3f} {y:.3f}" for x, y in places)
    large = int(end - start > pi)
    turn = f"A{outer:.3f} {outer:.3f} 0 {large} 0 {b}"
    back = f"A{inner:.3f} {inner:.3f} 0 {large} 1 {d}"
    to = (f"{cap}0 {c}", f"{cap}0 {a}") if cap else (f"L{c}", f"L{a}")
    return f"M{a}{turn}{to[0]}{back}{to[1]}Z"

"""The views of the drawing sheet: ring, its section, valve plate."""

from math import degrees, pi, radians
from typing import NamedTuple

import numpy as np

from camring.exchange.drawings.paper import CHAIN, THICK, Paper, around
from camring.exchange.drawings.ring import Ring
from camring.exchange.drawings.ring_svg import path_of
from camring.geometry.port_shape import PlatePorts, Slot
from camring.numerics.closed_spline import ClosedSpline

__all__ = ["Scale", "draw_plate", "draw_ring", "draw_section", "scale_for"]

Place = tuple[float, float]


class Scale(NamedTuple):
    """A scale of ISO 5455: millimetres on paper for each millimetre of the part."""

    factor: float
    name: str


def scale_for(radius: float, size: float) -> Scale:
    """The largest usual scale at which a radius (m) fits a size (mm)."""
    for enlarged in (10, 5, 2, 1):
        if 1e3 * radius * enlarged <= size:
            return Scale(float(enlarged), f"{enlarged}:1")
    for part in (2, 5, 10, 20, 50, 100):
        if 1e3 * radius / part <= size:
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
    _leaders(paper, centre, scale, ring, outer)
    _angles(paper, centre, scale, ring)


def _curve(
    paper: Paper, centre: Place, scale: float, curve: ClosedSpline, width: float, dash: str
) -> None:
    shifted = ClosedSpline(
        curve.arc, curve.point + complex(centre[0], -centre[1]) / (1e3 * scale), curve.error
    )
    paper.path(path_of(shifted, scale, 4), width, dash)


class _Corner(NamedTuple):
    """A place for words beside the ring: their left end from its centre, and what lies near."""

    dx: float
    dy: float
    angle: float


_CORNERS = [
    _Corner(-82.0, -80.0, 125.0),
    _Corner(36.0, -82.0, 55.0),
    _Corner(-82.0, 80.0, 225.0),
    _Corner(36.0, 80.0, 315.0),
]


def _nearest(ring: Ring, angle: float, free: list[_Corner]) -> tuple[float, _Corner]:
    """An extreme's angle in degrees, in the period that lies nearest to a free corner."""
    period = degrees(ring.period)
    found = []
    for corner in free:
        turns = round((corner.angle - degrees(angle)) / period)
        at = degrees(angle) + period * turns
        found.append((abs((at - corner.angle + 180) % 360 - 180), at, corner))
    near = [each for each in found if each[0] < period / 2 and ring.repeats > 1]
    _, at, corner = near[0] if near else min(found, key=lambda each: each[0])
    free.remove(corner)
    return at, corner


def _leaders(paper: Paper, centre: Place, scale: float, ring: Ring, outer: float) -> None:
    """Words with arrows: radii of the surface, pitch curve, roller, outer diameter."""
    free, grown = list(_CORNERS), 1e3 * scale
    angle, corner = _nearest(ring, ring.outer[1], free)
    text = f"R {1e3 * ring.surface_outer:.4f} largest"
    _leader(paper, centre, corner, around(centre, grown * ring.surface_outer, angle), text)
    angle, corner = _nearest(ring, ring.inner[1], free)
    text = f"R {1e3 * ring.surface_inner:.4f} smallest"
    _leader(paper, centre, corner, around(centre, grown * ring.surface_inner, angle), text)

    corner = free.pop(0)
    text = f"pitch curve R {1e3 * ring.inner[0]:.4f} … {1e3 * ring.outer[0]:.4f}"
    _leader(paper, centre, corner, _on_pitch_curve(centre, scale, ring, corner.angle), text)

    corner = free.pop(0)
    middle, radius = _on_pitch_curve(centre, scale, ring, corner.angle), grown * ring.roller_radius
    paper.circle(middle, radius, 0.25)
    paper.circle(middle, 0.4, 0.25, fill="#000")
    edge = around(middle, radius, corner.angle)
    _leader(paper, centre, corner, edge, f"roller Ø {2e3 * ring.roller_radius:.4g}")

    side, left = around(centre, outer, 180 + 12), centre[0] - 84
    paper.arrow(side, (left, side[1] + 8))
    paper.text(left, side[1] + 11.4, f"Ø {2 * outer / scale:.7g}", 2.8)
    paper.box(left, side[1] + 12.6, 4.4, 4.4, 0.25)
    paper.text(left + 2.2, side[1] + 15.9, "A", 2.8, anchor="middle")


def _on_pitch_curve(centre: Place, scale: float, ring: Ring, angle: float) -> Place:
    parameter = ring.outline.parameter_at(np.asarray(radians(angle)))
    radius = float(np.abs(ring.outline.places(parameter).point))
    return around(centre, 1e3 * scale * radius, angle)


def _leader(paper: Paper, centre: Place, corner: _Corner, place: Place, text: str) -> None:
    """Words over a line from which an arrow goes to a place."""
    x, y = centre[0] + corner.dx, centre[1] + corner.dy
    width = 1.45 * len(text)
    # Words stand between their line and the ring only above it.
    below = y + 1.0 if corner.dy < 0 else y - 3.2
    paper.text(x, y, text, 2.8)
    paper.line((x, below), (x + width, below))
    paper.arrow(place, (min(max(place[0], x), x + width), below))


def _angles(paper: Paper, centre: Place, scale: float, ring: Ring) -> None:
    """Angle of one lobe, and the sense of rotation."""
    inner = 1e3 * scale * ring.inner[0]
    if ring.repeats > 1:
        start = degrees(ring.inner[1])
        end = start + degrees(ring.period)
        for angle in (start, end):
            paper.line(centre, around(centre, inner, angle), width=0.13)
        paper.arc(centre, 0.72 * inner, start, end, "se")
        x, y = around(centre, 0.72 * inner - 1.5, (start + end) / 2)
        text = f"{ring.repeats} × {degrees(ring.period):.6g}°"
        paper.text(x, y + 1, text, 2.8, anchor="end", halo=1.2)
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
    grown, letters = 1e3 * scale, []
    for slot in ports.slots:
        paper.path(_slot_path(centre, grown, ports, slot), 0.35)
        radius = grown * (ports.circle if grown * ports.height > 4 else ports.inner)
        radius -= 0.0 if grown * ports.height > 4 else 2.2
        x, y = around(centre, radius, degrees(slot.centre))
        letters.append((x, y + 0.9, slot.kind[0].upper()))
    paper.circle(centre, grown * ports.circle, 0.13, CHAIN)
    for x, y, letter in letters:
        paper.text(x, y, letter, 2.5, anchor="middle", halo=1.0)
    reach = grown * ports.outer
    for dx, dy in ((1, 0), (0, 1)):
        x, y = dx * (reach + 3), dy * (reach + 3)
        paper.line(
            (centre[0] - x, centre[1] - y), (centre[0] + x, centre[1] + y), width=0.13, dash=CHAIN
        )
    _port_angles(paper, centre, grown, ports)
    what = "diameter" if ports.shape == "round" else "height"
    text = f"port circle R {1e3 * ports.circle:.4g}, {what} {1e3 * ports.height:.4g}"
    paper.text(centre[0], centre[1] + 45.5, text, 2.5, anchor="middle")


def _port_angles(paper: Paper, centre: Place, grown: float, ports: PlatePorts) -> None:
    """Ticks where the first supply and the first return window open and close, with degrees."""
    reach = grown * ports.outer
    pair = [next(s for s in ports.slots if s.kind == kind) for kind in ("supply", "return")]
    edges = sorted(degrees(a) % 360 for slot in pair for a in (slot.opens, slot.closes))
    apart = degrees(3.0 / (reach + 6))
    places = list(edges)
    for place in range(1, len(places)):
        places[place] = max(places[place], places[place - 1] + apart)
    # As far ahead as behind: pairs that were pushed apart stand about their middle.
    for place in range(1, len(places)):
        pushed = (places[place] - edges[place]) / 2
        if pushed > 0 and places[place - 1] == edges[place - 1]:
            places[place] -= pushed
            places[place - 1] -= pushed
    for turned, shown in zip(edges, places, strict=True):
        paper.line(
            around(centre, grown * ports.inner, turned),
            around(centre, reach + 2, turned),
            around(centre, reach + 5, shown),
        )
        flip = 90 < shown % 360 < 270
        x, y = around(centre, reach + 5.6, shown - (0.8 if not flip else -0.8))
        paper.text(x, y, f"{turned:.2f}°", 2.2, anchor="end" if flip else "start",
                   turned=shown + 180 if flip else shown)  # fmt: skip


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

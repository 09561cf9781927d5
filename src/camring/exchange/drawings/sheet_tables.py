"""The tables of the drawing sheet and its title block."""

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees, isfinite, pi

import numpy as np

from camring.exchange.drawings.about import About
from camring.exchange.drawings.paper import THICK, Paper
from camring.exchange.drawings.ring import Ring
from camring.geometry.port_shape import PlatePorts

__all__ = ["Body", "main_dimensions", "port_angles", "profile", "title_block"]

_ROW = 4.4
_PROFILE_TOLERANCE = 0.02  # mm; a usual starting point for ground cam rings


@dataclass(frozen=True)
class Body:
    """The ring's body around its working surface, m."""

    outer_radius: float
    width: float


def main_dimensions(paper: Paper, x: float, y: float, ring: Ring, body: Body) -> float:
    """The main dimensions with proposed tolerances; the table's lower edge, mm."""
    nose = f"{1e3 * ring.nose:.3f}" if isfinite(ring.nose) else "none"
    lobes = f"{ring.lobes} x {360 / ring.lobes:.6g}°" if ring.repeats > 1 else "free ring"
    form = f"profile {_PROFILE_TOLERANCE:g} | A"
    rows = [
        ("Working surface, smallest radius", f"{1e3 * ring.surface_inner:.4f}", form),
        ("Working surface, largest radius", f"{1e3 * ring.surface_outer:.4f}", form),
        ("Pitch curve, smallest radius", f"({1e3 * ring.inner[0]:.4f})", ""),
        ("Pitch curve, largest radius", f"({1e3 * ring.outer[0]:.4f})", ""),
        ("Stroke", f"({1e3 * ring.stroke:.4f})", ""),
        ("Lobes", lobes, "± 0.01° each" if ring.repeats > 1 else ""),
        ("Smallest hollow radius: limits the wheel", f"({1e3 * ring.hollow:.3f})", ""),
        ("Smallest bulging radius", f"({nose})", ""),
        ("Undercut factor, smallest", f"({ring.undercut.factor:.4f})", ""),
        ("Roller diameter", f"{2e3 * ring.roller_radius:.4f}", "h5"),
        ("Roller length", f"{1e3 * ring.roller_length:.3f}", "0 / −0.05"),
        ("Piston bore", f"{1e3 * ring.bore:.4f}", "H6"),
        ("Pistons", str(ring.pistons), ""),
        ("Ring outer diameter, datum A", f"{2e3 * body.outer_radius:.3f}", "h6"),
        ("Ring width", f"{1e3 * body.width:.3f}", "0 / −0.05"),
    ]
    paper.text(x, y, "Main dimensions, mm", 3.5, bold=True)
    head = ("Dimension", "Nominal", "Tolerance, proposed")
    return _table(paper, x, y + 2, (84, 38, 43), head, rows, "l r l")


def port_angles(paper: Paper, x: float, y: float, ports: PlatePorts) -> float:
    """Timing of the first pair of ports; the table's lower edge, mm."""
    rows = []
    for kind in ("supply", "return"):
        slot = next(slot for slot in ports.slots if slot.kind == kind)
        known = ports.shape != "timing"
        angles = (
            slot.opens,
            slot.full_from if known else None,
            slot.full_until if known else None,
            slot.closes,
            slot.start if known else None,
            slot.end if known else None,
        )
        written = ["–" if each is None else f"{degrees(each) % 360:.3f}" for each in angles]
        rows.append((kind, *written))
    count = len(ports.slots) // 2
    every = f"; then every {360 / count:.6g}°" if count > 1 else ""
    paper.text(x, y, f"Port angles, degrees{every}", 3.5, bold=True)
    head = ("Port", "opens", "full from", "full until", "closes", "slot from", "slot to")
    return _table(paper, x, y + 2, (21, 24, 24, 24, 24, 24, 24), head, rows, "l r r r r r r")


def profile(paper: Paper, x: float, y: float, ring: Ring) -> float:
    """Both curves at a few angles of one period; the table's lower edge, mm."""
    steps = 12 if ring.repeats > 1 else 18
    angle = ring.period * np.arange(steps + (ring.repeats > 1)) / steps
    parameter = ring.outline.parameter_at(angle)
    pitch = ring.outline.places(parameter)
    surface = ring.outline.places(parameter, ring.roller_radius)
    columns = (
        (np.degrees(angle), 3),
        (1e3 * np.abs(pitch.point), 4),
        (1e3 * surface.point.real, 4),
        (1e3 * surface.point.imag, 4),
        (1e3 * np.abs(surface.point), 4),
        (np.degrees(np.angle(surface.point) - angle + pi) % 360 - 180, 4),
    )
    rows = list(
        zip(*([_signed(v, digits) for v in np.round(c, digits) + 0.0] for c, digits in columns),
            strict=True)
    )  # fmt: skip
    paper.text(x, y, "Profile at some angles, mm; all points in ring_points.csv", 3.5, bold=True)
    head = ("Angle °", "Pitch radius", "Surface x", "Surface y", "Surface radius", "Ahead °")
    return _table(paper, x, y + 2, (22, 29, 29, 29, 32, 24), head, rows, "r r r r r r", 4.0)


def _signed(value: float, digits: int) -> str:
    return f"{value:.{digits}f}".replace("-", "−")


def title_block(
    paper: Paper, corners: tuple[float, float, float, float], about: About, scale: str
) -> None:
    """The fields of ISO 7200; those that a person must fill are left empty."""
    left, top, right, bottom = corners
    paper.box(left, top, right - left, bottom - top, THICK)
    width, height = right - left, bottom - top
    across = [left + width * part for part in (0.0, 0.25, 0.5, 0.72, 0.86)]
    down = [top + height * part for part in (0.0, 0.23, 0.46, 0.69)]
    for y in down[1:]:
        paper.line((left, y), (right, y))

    def entry(column: int, row: int, name: str, content: str, size: float = 2.8) -> None:
        x, y = across[column], down[row]
        if column:
            paper.line((x, y), (x, down[row + 1] if row < 3 else bottom))
        paper.text(x + 1.2, y + 2.6, name, 1.8)
        paper.text(x + 1.2, y + 7.6, content, size)

    entry(0, 0, "Legal owner", "")
    entry(2, 0, "Material, heat treatment", "")
    entry(0, 1, "Created by", about.program)
    entry(1, 1, "Date", about.day)
    entry(2, 1, "Checked by, date", "")
    entry(3, 1, "Approved by, date", "")
    entry(0, 2, "General tolerances", "ISO 2768-mK")
    entry(1, 2, "Motor file, sha256", about.digest)
    entry(2, 2, "Scale", scale)
    entry(3, 2, "Unit", "mm")
    entry(4, 2, "Projection", "")
    _first_angle(paper, across[4] + 14, down[2] + 5.6)
    entry(0, 3, "Title", "")
    entry(3, 3, "Drawing number", "")
    entry(4, 3, "Revision, sheet", "–, 1/1")
    name = textwrap.shorten(about.motor, 64, placeholder=" …")
    paper.text(left + 1.2, down[3] + 6.6, "Cam ring and valve plate ports", 3.5, bold=True)
    paper.text(left + 1.2, down[3] + 11.0, name, 2.8)


def _first_angle(paper: Paper, x: float, y: float) -> None:
    """The sign of first-angle projection, ISO 5456-2."""
    paper.line((x - 6, y - 1.2), (x - 6, y + 1.2), (x - 1.5, y + 2.4), (x - 1.5, y - 2.4),
               (x - 6, y - 1.2), width=0.25)  # fmt: skip
    paper.circle((x + 4, y), 2.4, 0.25)
    paper.circle((x + 4, y), 1.2, 0.25)
    paper.line((x - 7, y), (x + 7.4, y), dash="2 .5 .5 .5", width=0.13)


def _table(
    paper: Paper,
    x: float,
    y: float,
    widths: Sequence[float],
    head: Sequence[str],
    rows: Sequence[Sequence[str]],
    sides: str,
    row_height: float = _ROW,
) -> float:
    """A ruled table; its lower edge."""
    across, below = sum(widths), y
    edges = np.concatenate([[0.0], np.cumsum(widths)])
    for number, row in enumerate([head, *rows]):
        for side, start, end, content in zip(
            sides.split(), edges[:-1], edges[1:], row, strict=True
        ):
            place, anchor = (start + 1, "start") if side == "l" else (end - 1.2, "end")
            paper.text(x + place, below + row_height - 1.2, content, 2.4,
                       anchor=anchor, bold=number == 0)  # fmt: skip
        below += row_height
        if number < len(rows):
            paper.line((x, below), (x + across, below), width=0.35 if number == 0 else 0.1)
    paper.box(x, y, across, below - y, 0.35)
    for edge in edges[1:-1]:
        paper.line((x + edge, y), (x + edge, below), width=0.1)
    return below

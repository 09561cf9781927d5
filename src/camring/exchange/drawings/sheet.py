"""The drawing sheet: ring, section and valve plate with dimensions on an A3 frame, as SVG."""

import textwrap

from camring.exchange.drawings.about import FRAME, ROTATION, About
from camring.exchange.drawings.paper import THICK, Paper
from camring.exchange.drawings.plate import assumptions
from camring.exchange.drawings.ring import Ring
from camring.exchange.drawings.ring_curves import RingCurves, micrometres
from camring.exchange.drawings.sheet_tables import (
    Body,
    main_dimensions,
    port_angles,
    profile,
    title_block,
)
from camring.exchange.drawings.sheet_views import draw_plate, draw_ring, draw_section, scale_for
from camring.geometry.port_shape import PlatePorts

__all__ = ["sheet_svg"]

_WIDTH, _HEIGHT = 420.0, 297.0  # A3
_LEFT, _TOP, _RIGHT, _BOTTOM = 20.0, 10.0, 410.0, 287.0  # ISO 5457
_RING, _RING_SIZE = (108.0, 104.0), 70.0
_PLATE, _PLATE_SIZE = (64.0, 239.0), 33.0
_COLUMN = 240.0


def sheet_svg(
    ring: Ring,
    curves: RingCurves,
    ports: PlatePorts,
    about: About,
    outer_radius: float,
    width: float,
) -> bytes:
    """The sheet; views are to the scales that stand beside them.

    Parameters
    ----------
    outer_radius, width
        Of the ring's body, m.
    """
    body = Body(outer_radius, width)
    paper = Paper(_WIDTH, _HEIGHT)
    _frame(paper)
    scale = scale_for(outer_radius, _RING_SIZE)
    draw_ring(paper, _RING, scale.factor, ring, outer_radius)
    draw_section(paper, (_RING[0] + 100.0, _RING[1]), scale.factor, ring, outer_radius, width)
    plate_scale = scale_for(ports.outer, _PLATE_SIZE)
    draw_plate(paper, _PLATE, plate_scale.factor, ports)
    paper.text(_LEFT + 4, _TOP + 7, f"Cam ring  {scale.name}", 3.5, bold=True)
    paper.text(_LEFT + 4, 196, f"Valve plate ports  {plate_scale.name}", 3.5, bold=True)

    bottom = main_dimensions(paper, _COLUMN, _TOP + 7, ring, body)
    bottom = port_angles(paper, _COLUMN, bottom + 7, ports)
    profile(paper, _COLUMN, bottom + 7, ring)
    _notes(paper, curves, ports)
    title_block(paper, (_COLUMN - 10, 245.0, _RIGHT, _BOTTOM), about, scale.name)
    return paper.svg(f"{about.motor}: cam ring and valve plate", " ".join(about.lines()))


def _notes(paper: Paper, curves: RingCurves, ports: PlatePorts) -> None:
    remarks = [
        f"The working surface is the curve WORKING_SURFACE of ring.dxf, {curves.each}, normal "
        f"error at most {micrometres(curves.error)}, one roller radius outside the pitch curve.",
        FRAME,
        ROTATION,
        *assumptions(ports, asked=True)[1:],
        "Body, tolerances and port circle are proposals: the motor file fixes the curves, angles "
        "and port area only. Dimensions in brackets are for reference.",
    ]
    x, y = 124.0, 198.0
    paper.text(x, y - 1, "Notes", 3.5, bold=True)
    y += 4
    for number, sentence in enumerate(remarks, 1):
        rows = textwrap.wrap(sentence, 76)
        paper.text(x, y, str(number), 2.2)
        paper.lines(x + 4, y, rows, 2.2)
        y += 1.45 * 2.2 * len(rows) + 1.2


def _frame(paper: Paper) -> None:
    """Border, centring marks and zones."""
    paper.box(_LEFT, _TOP, _RIGHT - _LEFT, _BOTTOM - _TOP, 0.7)
    middle, half = (_LEFT + _RIGHT) / 2, (_TOP + _BOTTOM) / 2
    for start, end in (
        ((middle, _TOP - 5), (middle, _TOP + 5)),
        ((middle, _BOTTOM - 5), (middle, _BOTTOM + 5)),
        ((_LEFT - 5, half), (_LEFT + 5, half)),
        ((_RIGHT - 5, half), (_RIGHT + 5, half)),
    ):
        paper.line(start, end, width=THICK)
    step = (_RIGHT - _LEFT) / 8
    for number in range(8):
        x = _LEFT + step * (number + 0.5)
        for y in (_TOP - 1.5, _BOTTOM + 4):
            paper.text(x, y, str(number + 1), anchor="middle")
        if number:
            for y in (_TOP, _BOTTOM + 5):
                paper.line((_LEFT + step * number, y - 5), (_LEFT + step * number, y))
    step = (_BOTTOM - _TOP) / 6
    for number, letter in enumerate("ABCDEF"):
        y = _TOP + step * (number + 0.5)
        for x in (_LEFT - 2.5, _RIGHT + 2.5):
            paper.text(x, y + 1, letter, anchor="middle")
        if number:
            for x in (_LEFT - 5, _RIGHT):
                paper.line((x, _TOP + step * number), (x + 5, _TOP + step * number))

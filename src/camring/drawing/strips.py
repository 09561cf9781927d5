"""Low rows under a chart that show when a chamber is open to which port."""

from dataclasses import dataclass

import numpy as np

from camring.drawing.frame import Frame
from camring.drawing.palette import LIMIT, RETURN, SUPPLY, Style
from camring.drawing.path import polyline
from camring.drawing.svg import element, group, number, words

__all__ = ["HEIGHT", "Strip", "draw_strips", "patterns"]

HEIGHT = 24.0


@dataclass(frozen=True)
class Strip:
    """Openings of both ports, shares in [0, 1], against the chart's abscissa."""

    x: np.ndarray
    supply: np.ndarray
    return_: np.ndarray
    label: str
    style: Style


def patterns() -> str:
    """Hatchings that tell supply from return without colour, and an arrow head; once a page."""
    supply = element(
        "pattern",
        element("rect", width=5, height=5, fill="#f3e3ec"),
        element("path", d="M0 5L5 0", stroke=SUPPLY, stroke_width=1.1),
        id="hatch-supply",
        width=5,
        height=5,
        patternUnits="userSpaceOnUse",
    )
    return_ = element(
        "pattern",
        element("rect", width=5, height=5, fill="#e4f0eb"),
        element("circle", cx=2.5, cy=2.5, r=0.9, fill=RETURN),
        id="hatch-return",
        width=5,
        height=5,
        patternUnits="userSpaceOnUse",
    )
    arrow = element(
        "marker",
        element("path", d="M0 0L7 3.5L0 7Z", fill=LIMIT),
        id="arrow-head",
        markerWidth=7,
        markerHeight=7,
        refX=6,
        refY=3.5,
        orient="auto",
        markerUnits="userSpaceOnUse",
    )
    return element(
        "svg",
        element("defs", supply, return_, arrow),
        xmlns="http://www.w3.org/2000/svg",
        width=0,
        height=0,
        aria_hidden="true",
        class_="hidden",
    )


def _area(frame: Frame, strip: Strip, share: np.ndarray, base: float) -> str:
    low, high = frame.x_axis.low, frame.x_axis.high
    first = max(int(np.searchsorted(strip.x, low)) - 1, 0)
    last = min(int(np.searchsorted(strip.x, high, side="right")) + 1, len(strip.x))
    x = np.clip(frame.x(strip.x[first:last]), frame.left, frame.right)
    y = base - (HEIGHT - 7) * share[first:last]
    return f"{polyline(x, y)}L{number(x[-1])} {number(base)}L{number(x[0])} {number(base)}Z"


def _caption(frame: Frame, strip: Strip, share: np.ndarray, text: str, base: float) -> str:
    """The port's name in the widest opening seen, when there is room for it."""
    x = frame.x(strip.x)
    seen = (share > 0.5) & (x >= frame.left) & (x <= frame.right)
    if not seen.any():
        return ""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], seen.astype(int), [0]])))
    start, end = max(zip(edges[::2], edges[1::2], strict=True), key=lambda pair: pair[1] - pair[0])
    wide = float(x[end - 1] - x[start])
    if wide < 6.0 * len(text):
        return ""
    middle = float(x[start] + x[end - 1]) / 2
    return words(middle, base - 4, text, class_="note halo", text_anchor="middle")


def draw_strips(frame: Frame, strips: list[Strip]) -> str:
    """The rows from the frame's bottom down, supply hatched, return dotted."""
    pieces = []
    for row, strip in enumerate(strips):
        base = frame.bottom + 5 + HEIGHT * (row + 1)
        for share, name, colour in (
            (strip.supply, "supply", SUPPLY),
            (strip.return_, "return", RETURN),
        ):
            pieces += [
                element(
                    "path",
                    d=_area(frame, strip, share, base),
                    fill=f"url(#hatch-{name})",
                    stroke=colour,
                    stroke_width=1,
                ),
                _caption(frame, strip, share, name, base),
            ]
        pieces += [
            element("line", x1=frame.left, x2=frame.right, y1=base, y2=base, class_="axis faint"),
            words(
                frame.left - 7,
                base - 5,
                strip.label,
                class_="tick",
                text_anchor="end",
                fill=strip.style.colour,
            ),
        ]
    return group(*pieces) if strips else ""

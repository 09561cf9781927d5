"""What can be drawn between two axes: curves, limits, regions, marks, stems, notes."""

from dataclasses import dataclass

import numpy as np

from camring.drawing.frame import Frame
from camring.drawing.marks import mark
from camring.drawing.palette import INK, LIMIT, QUIET, Style
from camring.drawing.path import polyline
from camring.drawing.svg import element, group, words

__all__ = ["Curve", "Loop", "Marks", "Note", "Region", "Rule", "Stems", "Steps"]


@dataclass(frozen=True)
class Curve:
    """A line through values against an ascending abscissa; gaps where not finite."""

    x: np.ndarray
    y: np.ndarray
    label: str
    style: Style

    def draw(self, frame: Frame) -> str:
        # One point beyond each end keeps the curve running into the frame's edge.
        low, high = frame.x_axis.low, frame.x_axis.high
        first = max(int(np.searchsorted(self.x, low)) - 1, 0)
        last = min(int(np.searchsorted(self.x, high, side="right")) + 1, len(self.x))
        path = polyline(frame.x(self.x[first:last]), frame.y(self.y[first:last]))
        return element("path", d=path, class_="curve", data_label=self.label, **_stroke(self.style))


@dataclass(frozen=True)
class Loop:
    """A closed or winding line in the plane of the two axes."""

    x: np.ndarray
    y: np.ndarray
    label: str
    style: Style

    def draw(self, frame: Frame) -> str:
        path = polyline(frame.x(self.x), frame.y(self.y), plane=True)
        return element("path", d=path, class_="loop", **_stroke(self.style))


@dataclass(frozen=True)
class Steps:
    """A staircase that holds each value until the next, like the best so far."""

    x: np.ndarray
    y: np.ndarray
    label: str
    style: Style

    def draw(self, frame: Frame) -> str:
        x = np.repeat(np.asarray(self.x, dtype=float), 2)[1:]
        y = np.repeat(np.asarray(self.y, dtype=float), 2)[:-1]
        path = polyline(frame.x(x), frame.y(y), plane=True)
        return element("path", d=path, class_="curve", data_label=self.label, **_stroke(self.style))


@dataclass(frozen=True)
class Rule:
    """A straight line at one value: a limit, a port pressure, zero."""

    value: float
    text: str = ""
    upright: bool = False
    limit: bool = False
    below: bool = False

    def draw(self, frame: Frame) -> str:
        if not np.isfinite(self.value):
            return ""
        colour = LIMIT if self.limit else QUIET
        style = {
            "stroke": colour,
            "stroke_width": 1.2 if self.limit else 1.0,
            "stroke_dasharray": "10 3" if self.limit else "2 3",
        }
        if self.upright:
            x = float(frame.x(self.value))
            line = element("line", x1=x, x2=x, y1=frame.top, y2=frame.bottom, **style)
            return line + words(x + 4, frame.top + 11, self.text, class_="note halo", fill=colour)
        y = float(frame.y(self.value))
        if not frame.top - 0.5 <= y <= frame.bottom + 0.5:
            return ""
        line = element("line", x1=frame.left, x2=frame.right, y1=y, y2=y, **style)
        at = y + 13 if self.below or y < frame.top + 13 else y - 5
        return line + words(
            frame.right - 4, at, self.text, class_="note halo", text_anchor="end", fill=colour
        )


@dataclass(frozen=True)
class Region:
    """A shaded stretch of the abscissa with a word at its top."""

    start: float
    end: float
    text: str = ""
    shade: str = "#f1f3f5"

    def draw(self, frame: Frame) -> str:
        left, right = (float(v) for v in frame.x(np.array([self.start, self.end])))
        left, right = max(left, frame.left), min(right, frame.right)
        if right <= left:
            return ""
        box = element(
            "rect",
            x=left,
            y=frame.top,
            width=right - left,
            height=frame.bottom - frame.top,
            fill=self.shade,
        )
        if right - left < 6.3 * len(self.text) or not self.text:
            return box
        middle = (left + right) / 2
        return box + words(middle, frame.top + 12, self.text, class_="note", text_anchor="middle")


@dataclass(frozen=True)
class Marks:
    """Single points; those that are not finite are left out."""

    x: np.ndarray
    y: np.ndarray
    style: Style
    size: float = 2.6

    def draw(self, frame: Frame) -> str:
        places = zip(frame.x(self.x), frame.y(self.y), strict=True)
        finite = [(float(x), float(y)) for x, y in places if np.isfinite(x) and np.isfinite(y)]
        return group(*(mark(x, y, self.style, self.size) for x, y in finite))


@dataclass(frozen=True)
class Stems:
    """Amplitudes standing on the base line, shifted a little so that designs stand side by side."""

    x: np.ndarray
    y: np.ndarray
    style: Style
    offset: float = 0.0

    def draw(self, frame: Frame) -> str:
        pieces = []
        for x, y in zip(frame.x(self.x), frame.y(self.y), strict=True):
            if not (np.isfinite(x) and np.isfinite(y)) or y > frame.bottom:
                continue
            at = float(x) + self.offset
            pieces.append(
                element(
                    "line",
                    x1=at,
                    x2=at,
                    y1=frame.bottom,
                    y2=float(y),
                    stroke=self.style.colour,
                    stroke_width=2.4,
                )
                + mark(at, float(y), self.style, 3.0)
            )
        return group(*pieces)


@dataclass(frozen=True)
class Note:
    """A few words at a place, with a halo so that lines under them do not strike them out."""

    x: float
    y: float
    text: str
    anchor: str = "start"
    up: float = 6.0
    right: float = 0.0
    colour: str = INK

    def draw(self, frame: Frame) -> str:
        x, y = float(frame.x(self.x)), float(frame.y(self.y))
        if not frame.holds(x, y):
            return ""
        return words(
            x + self.right,
            max(y - self.up, frame.top + 9),
            self.text,
            class_="note halo",
            text_anchor=self.anchor,
            fill=self.colour,
        )


def _stroke(style: Style) -> dict[str, object]:
    return {
        "fill": "none",
        "stroke": style.colour,
        "stroke_width": style.width,
        "stroke_dasharray": style.dash,
    }

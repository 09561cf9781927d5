"""The rectangle between two axes, its grid, ticks and titles."""

from dataclasses import dataclass

import numpy as np

from camring.drawing.scale import Axis
from camring.drawing.svg import element, number, words

__all__ = ["Frame", "axes"]


@dataclass(frozen=True)
class Frame:
    """The rectangle between the axes, in paper coordinates.

    `base` is where the abscissa's ticks stand: the bottom, or lower when
    strips lie between the two.
    """

    x_axis: Axis
    y_axis: Axis
    left: float
    top: float
    right: float
    bottom: float
    base: float

    def x(self, value: np.ndarray | float) -> np.ndarray:
        return self.left + self.x_axis.fraction(value) * (self.right - self.left)

    def y(self, value: np.ndarray | float) -> np.ndarray:
        return self.bottom - self.y_axis.fraction(value) * (self.bottom - self.top)

    def holds(self, x: float, y: float) -> bool:
        """Whether a paper point lies inside, edges included."""
        across = self.left - 0.5 <= x <= self.right + 0.5
        return bool(across and self.top - 0.5 <= y <= self.bottom + 0.5)

    def ends(self, axis: Axis) -> str:
        """The axis for the reading script: paper start and end, value start and end, kind."""
        paper = (self.left, self.right) if axis is self.x_axis else (self.bottom, self.top)
        return " ".join((*map(number, paper), f"{axis.low:.8g}", f"{axis.high:.8g}", axis.kind))


def axes(frame: Frame, title_row: float) -> str:
    """Grid, ticks and titles; the ordinate's title lies flat above it, at `title_row`."""
    pieces = []
    for value, label in frame.y_axis.ticks():
        y = float(frame.y(value))
        pieces += [
            element("line", x1=frame.left, x2=frame.right, y1=y, y2=y, class_="grid"),
            words(frame.left - 7, y + 4, label, class_="tick", text_anchor="end"),
        ]
    for value, label in frame.x_axis.ticks():
        x = float(frame.x(value))
        pieces += [
            element("line", x1=x, x2=x, y1=frame.base, y2=frame.base + 4, class_="axis"),
            words(x, frame.base + 17, label, class_="tick", text_anchor="middle"),
        ]
    middle = (frame.left + frame.right) / 2
    pieces += [
        element("line", x1=frame.left, x2=frame.right, y1=frame.base, y2=frame.base, class_="axis"),
        words(middle, frame.base + 36, frame.x_axis.title, class_="label", text_anchor="middle"),
        words(4.0, title_row, frame.y_axis.title, class_="label"),
    ]
    return "".join(pieces)

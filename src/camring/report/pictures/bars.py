"""What pictures of horizontal bars share: labels on the left, a scale along the bottom."""

from dataclasses import dataclass

from camring.drawing.scale import Axis
from camring.drawing.svg import element, words

__all__ = ["WIDTH", "Bars"]

WIDTH = 1064.0
TOP = 34.0


@dataclass(frozen=True)
class Bars:
    """The paper of a bar picture: `left` px for labels, `right` px for remarks."""

    axis: Axis
    rows: int
    pitch: float
    left: float = 250.0
    right: float = 150.0

    @property
    def bottom(self) -> float:
        return TOP + self.pitch * self.rows

    @property
    def size(self) -> tuple[float, float]:
        return WIDTH, self.bottom + 46

    def x(self, value: float) -> float:
        return self.left + float(self.axis.fraction(value)) * (WIDTH - self.left - self.right)

    def y(self, row: int) -> float:
        """Top of a row."""
        return TOP + self.pitch * row

    def grid(self) -> str:
        """Upright lines with their values and the axis title below."""
        pieces = []
        for value, label in self.axis.ticks():
            x = self.x(value)
            pieces += [
                element("line", x1=x, x2=x, y1=TOP, y2=self.bottom, class_="grid"),
                words(x, self.bottom + 17, label, class_="tick", text_anchor="middle"),
            ]
        middle = (self.left + WIDTH - self.right) / 2
        title = words(
            middle, self.bottom + 36, self.axis.title, class_="label", text_anchor="middle"
        )
        return "".join(pieces) + title

    def label(self, row_middle: float, first: str, second: str = "") -> str:
        """A row's name in one or two lines, right-aligned against the bars."""
        x = self.left - 12
        if not second:
            return words(x, row_middle + 4, first, class_="label", text_anchor="end")
        return words(x, row_middle - 2, first, class_="label", text_anchor="end") + words(
            x, row_middle + 12, second, class_="tick", text_anchor="end"
        )

    def wall(self, value: float) -> str:
        """The line that the bars stand on."""
        x = self.x(value)
        return element("line", x1=x, x2=x, y1=TOP, y2=self.bottom, class_="axis")

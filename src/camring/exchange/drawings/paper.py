"""A sheet of paper to draw on: millimetres, x to the right, y down, as SVG."""

from collections.abc import Sequence
from math import cos, radians, sin

from camring.drawing.svg import element, words

__all__ = ["CHAIN", "THICK", "THIN", "Paper"]

THICK, THIN = 0.5, 0.18
CHAIN = "6 1.2 0.8 1.2"
_FONT = "Liberation Sans, Arial, Helvetica, sans-serif"
_HATCH = (
    '<pattern id="hatch" width="2" height="2" patternUnits="userSpaceOnUse" '
    'patternTransform="rotate(45)"><path d="M0 0V2" stroke="#000" stroke-width="0.18"/></pattern>'
)
_ARROW = (
    '<marker id="arrow" orient="auto-start-reverse" markerUnits="userSpaceOnUse" markerWidth="3" '
    'markerHeight="2" viewBox="-3 -1 3 2" refX="0" refY="0"><path d="M0 0L-3 .55V-.55Z"/></marker>'
)


class Paper:
    """Collects lines, arcs and words; `svg` is the whole sheet."""

    def __init__(self, width: float, height: float) -> None:
        self.width, self.height = width, height
        self._parts: list[str] = []

    def line(self, *corners: tuple[float, float], width: float = THIN, dash: str = "") -> None:
        """Straight lines from corner to corner."""
        self.path("M" + "L".join(f"{x:.3f} {y:.3f}" for x, y in corners), width, dash)

    def arrow(self, *corners: tuple[float, float]) -> None:
        """A thin line with a head at its first corner."""
        path = "M" + "L".join(f"{x:.3f} {y:.3f}" for x, y in corners)
        self._stroke(path, THIN, "", marker_start="url(#arrow)")

    def path(self, path: str, width: float = THIN, dash: str = "", fill: str = "none") -> None:
        """An SVG path."""
        self._stroke(path, width, dash, fill=fill)

    def box(self, x: float, y: float, width: float, height: float, line: float = THIN) -> None:
        self.path(f"M{x:.3f} {y:.3f}h{width:.3f}v{height:.3f}h{-width:.3f}Z", line)

    def circle(self, centre: tuple[float, float], radius: float, width: float = THIN,
               dash: str = "", fill: str = "none") -> None:  # fmt: skip
        x, y = centre
        turn = f"a{radius:.4f} {radius:.4f} 0 1 0 "
        self.path(
            f"M{x - radius:.4f} {y:.4f}{turn}{2 * radius:.4f} 0{turn}{-2 * radius:.4f} 0Z",
            width, dash, fill,
        )  # fmt: skip

    def arc(self, centre: tuple[float, float], radius: float, start: float, end: float,
            heads: str = "") -> None:  # fmt: skip
        """A thin arc, anticlockwise from start to end in degrees; heads "s", "e" or "se"."""
        (x1, y1), (x2, y2) = (around(centre, radius, angle) for angle in (start, end))
        large = int(end - start > 180)
        path = f"M{x1:.3f} {y1:.3f}A{radius:.3f} {radius:.3f} 0 {large} 0 {x2:.3f} {y2:.3f}"
        marks = {f"marker_{each}": "url(#arrow)" for each in _HEADS if each[0] in heads}
        self._stroke(path, THIN, "", **marks)

    def text(self, x: float, y: float, content: str, size: float = 2.5, *, anchor: str = "start",
             bold: bool = False, turned: float = 0.0, halo: float = 0.0) -> None:  # fmt: skip
        """Words whose baseline begins (or ends, or has its middle) at a place.

        A halo of some width interrupts the lines that pass below the words.
        """
        self._parts.append(
            words(
                x,
                y,
                content,
                font_size=f"{size:g}",
                text_anchor=None if anchor == "start" else anchor,
                font_weight="bold" if bold else None,
                stroke="#fff" if halo else None,
                stroke_width=f"{halo:g}" if halo else None,
                paint_order="stroke" if halo else None,
                transform=f"rotate({-turned:.3f} {x:.3f} {y:.3f})" if turned else None,
            )
        )

    def lines(self, x: float, y: float, lines: Sequence[str], size: float = 2.5) -> None:
        """Lines of words below each other."""
        for row, content in enumerate(lines):
            self.text(x, y + 1.45 * size * row, content, size)

    def svg(self, title: str, description: str) -> bytes:
        """The sheet as a file; a browser prints it on paper of its own size."""
        size = f"{self.width:g}mm {self.height:g}mm"
        head = (
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{self.width:g}mm" '
            f'height="{self.height:g}mm" viewBox="0 0 {self.width:g} {self.height:g}" '
            f'font-family="{_FONT}">'
        )
        style = f"<style>@page{{size:{size};margin:0}}</style>"
        parts = [
            head,
            element("title", words_only(title)),
            element("desc", words_only(description)),
            style,
            f"<defs>{_ARROW}{_HATCH}</defs>",
            f'<rect width="{self.width:g}" height="{self.height:g}" fill="#fff"/>',
            *self._parts,
            "</svg>",
        ]
        return ("\n".join(parts) + "\n").encode()

    def _stroke(self, path: str, width: float, dash: str, fill: str = "none", **marks: str) -> None:
        self._parts.append(
            element(
                "path",
                d=path,
                fill=fill,
                stroke="#000",
                stroke_width=f"{width:g}",
                stroke_dasharray=dash or None,
                **marks,
            )
        )


_HEADS = ("start", "end")


def words_only(text: str) -> str:
    """Text escaped for use between tags."""
    from camring.drawing.svg import escape

    return escape(text)


def around(centre: tuple[float, float], radius: float, angle: float) -> tuple[float, float]:
    """A place on the paper at a radius and an angle in degrees, anticlockwise from the right."""
    return (
        centre[0] + radius * cos(radians(angle)),
        centre[1] - radius * sin(radians(angle)),
    )

"""Single marks, and the keys that explain lines and marks."""

from collections.abc import Sequence

from camring.drawing.palette import Style
from camring.drawing.svg import element, number, points, words

__all__ = ["keys_width", "mark", "row_of_keys"]

LETTER = 6.3  # mean width of a letter at the label size, px


def mark(x: float, y: float, style: Style, size: float = 4.0) -> str:
    """One mark; its shape belongs to the style."""
    paint = {"fill": style.colour, "stroke": style.colour, "stroke_width": 1}
    match style.marker:
        case "circle":
            return element("circle", cx=x, cy=y, r=size, fill=style.colour)
        case "square":
            return element("rect", x=x - size, y=y - size, width=2 * size, height=2 * size, **paint)
        case "cross":
            a, b = number(x - size), number(y - size)
            far, back = number(2 * size), number(-2 * size)
            arms = f"M{a} {b}l{far} {far}m0 {back}l{back} {far}"
            return element("path", d=arms, stroke=style.colour, stroke_width=1.1, fill="none")
        case "triangle":
            corners = [(x, y - 1.2 * size), (x + 1.1 * size, y + size), (x - 1.1 * size, y + size)]
        case "diamond":
            far_out = 1.3 * size
            corners = [(x, y - far_out), (x + far_out, y), (x, y + far_out), (x - far_out, y)]
    return element("polygon", points=points(corners), **paint)


def keys_width(legend: Sequence[tuple[str, Style]]) -> float:
    """Paper width of a row of keys, px."""
    return sum(_sample_width(style) + 22 + LETTER * len(label) for label, style in legend) - 16


def _sample_width(style: Style) -> float:
    return 24.0 if style.key == "line" else 9.0


def row_of_keys(legend: Sequence[tuple[str, Style]], right: float, y: float) -> str:
    """Samples of lines and marks with their names, in one row that ends at `right`."""
    x = max(right - keys_width(legend), 4.0) if legend else 0.0
    pieces = []
    for label, style in legend:
        wide = _sample_width(style)
        if style.key == "line":
            pieces.append(
                element(
                    "line",
                    x1=x,
                    x2=x + wide,
                    y1=y - 4,
                    y2=y - 4,
                    stroke=style.colour,
                    stroke_width=style.width + 0.4,
                    stroke_dasharray=style.dash,
                )
            )
        else:
            pieces.append(mark(x + wide / 2, y - 4, style, 3.4))
        pieces.append(words(x + wide + 6, y, label, class_="legend"))
        x += wide + 22 + LETTER * len(label)
    return "".join(pieces)

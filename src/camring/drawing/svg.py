"""Building SVG and HTML text: elements, escaping, and numbers that are never NaN."""

import re
from collections.abc import Iterable
from html import escape as _escape
from math import isfinite

__all__ = ["element", "escape", "group", "number", "points", "words"]


def escape(text: object) -> str:
    """The text with the five characters that XML reserves replaced.

    What no XML may hold, as an escape sequence of a terminal, is shown by its number; so are
    marks that turn the direction of all that follows.
    """
    return _escape(_FORBIDDEN.sub(_number, str(text)), quote=True)


# XML 1.0, 2.2: all but tab and line ends of the control signs, half pairs, and two more; then
# Unicode's embeddings, overrides and isolates.
_FORBIDDEN = re.compile(
    "[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x84\x86-\x9f\ud800-\udfff\ufffe\uffff"
    "\u200e\u200f\u202a-\u202e\u2066-\u2069]"
)


def _number(found: re.Match[str]) -> str:
    return found[0].encode("unicode_escape", "backslashreplace").decode()


def number(value: float) -> str:
    """A coordinate with two decimals and no trailing zeros.

    Raises `ValueError` for NaN and infinity: a picture with a hole in it says
    something false, so callers leave such points out knowingly.
    """
    if not isfinite(value):
        raise ValueError(f"a drawing cannot hold the coordinate {value}")
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def element(name: str, *children: str, **attributes: object) -> str:
    """One element; `class_` becomes `class`, underscores become hyphens.

    Floats are written as coordinates, `None` leaves the attribute out, and
    children are markup already escaped.
    """
    written = []
    for key, value in attributes.items():
        if value is None:
            continue
        label = key.rstrip("_").replace("_", "-")
        shown = number(value) if isinstance(value, float) else escape(value)
        written.append(f' {label}="{shown}"')
    inside = "".join(children)
    if not inside and name in _SHAPES:
        return f"<{name}{''.join(written)}/>"
    return f"<{name}{''.join(written)}>{inside}</{name}>"


# HTML reads `<div/>` as an opening tag, so only SVG's shapes end themselves.
_SHAPES = frozenset({"line", "rect", "circle", "path", "polygon", "polyline", "ellipse", "image"})


def group(*children: str, **attributes: object) -> str:
    """Several elements as one."""
    return element("g", *children, **attributes)


def words(
    x: float, y: float, content: object, *, fill: str | None = None, **attributes: object
) -> str:
    """A text at a place; the content is escaped.

    A given colour is written as style, because a class's colour would win
    over an attribute.
    """
    if fill is not None:
        attributes["style"] = f"fill:{fill}"
    return element("text", escape(content), x=float(x), y=float(y), **attributes)


def points(pairs: Iterable[tuple[float, float]]) -> str:
    """Coordinates as the `points` attribute of a polygon wants them."""
    return " ".join(f"{number(x)},{number(y)}" for x, y in pairs)

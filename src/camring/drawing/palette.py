"""Colours and line styles, so that one thing looks the same in every picture.

Nothing is distinguished by colour alone: designs differ in dash too, bars carry
labels, verdicts carry words. Hues follow Okabe and Ito (2008), darkened to
keep a contrast of 4.5 to 1 on white where they carry text or thin lines.
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

__all__ = [
    "INK",
    "LIMIT",
    "LOSSES",
    "PRESSURE_STOPS",
    "QUIET",
    "RETURN",
    "SUPPLY",
    "Style",
    "design_style",
    "pressure_colour",
]

INK = "#1d2329"
QUIET = "#5b6670"
SUPPLY = "#8e3b6f"
RETURN = "#3f7d6a"
LIMIT = "#a3262b"

LOSSES = {
    "line_loss": "#4a6b52",
    "return_line_loss": "#7a5a3a",
    "throttling_loss": "#0b5cad",
    "leakage_loss": "#56a3d9",
    "friction_loss": "#d99a1c",
    "compression_loss": "#9b5f8b",
}


@dataclass(frozen=True)
class Style:
    """How one design is drawn everywhere."""

    colour: str
    dash: str | None = None
    width: float = 1.8
    marker: Literal["circle", "square", "triangle", "diamond", "cross"] = "circle"
    key: Literal["line", "mark"] = "line"


_GIVEN = Style("#b4540a", "6 3", 1.6, "diamond")
_BEST = Style("#0b5cad", None, 2.0, "circle")
_MORE = (
    Style("#1b7f5c", "2 2.5", 1.8, "square"),
    Style("#8e3b6f", "9 3 2 3", 1.8, "triangle"),
    Style("#6b6b00", "12 4", 1.8, "circle"),
    Style("#333333", "1 3", 1.8, "diamond"),
)


def design_style(position: int, count: int) -> Style:
    """The style of design `position` among `count`: a lone one is solid blue."""
    if count == 1:
        return _BEST
    styles = (_GIVEN, _BEST, *_MORE)
    return styles[position % len(styles)]


# Lightness falls steadily from low to high pressure (a cut of cividis turned
# about), so the scale survives grey printing and every common colour blindness.
PRESSURE_STOPS = (
    (0.0, (233, 236, 240)),
    (0.35, (168, 189, 214)),
    (0.7, (76, 122, 176)),
    (1.0, (12, 52, 104)),
)


def pressure_colour(share: float) -> str:
    """Fill of a chamber whose pressure stands at `share` between return and supply."""
    share = min(max(share, 0.0), 1.0)
    for (low, start), (high, end) in pairwise(PRESSURE_STOPS):
        if share <= high:
            part = (share - low) / (high - low)
            mixed = (round(a + part * (b - a)) for a, b in zip(start, end, strict=True))
            return "#" + "".join(f"{channel:02x}" for channel in mixed)
    return "#0c3468"

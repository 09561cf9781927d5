"""A picture with its title and the one sentence that says what to see in it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camring.drawing.palette import Style, design_style
from camring.drawing.scale import Axis
from camring.presentation.records import Design

__all__ = ["Figure", "around", "degrees", "design_styles", "legend", "period_axis"]


@dataclass(frozen=True)
class Figure:
    """One picture of the report; `picture` is markup, `sentence` plain text."""

    name: str
    title: str
    picture: str
    sentence: str
    wide: bool = False
    tall: bool = False


def design_styles(designs: Sequence[Design]) -> list[Style]:
    return [design_style(k, len(designs)) for k in range(len(designs))]


def legend(designs: Sequence[Design]) -> list[tuple[str, Style]]:
    """Keys of the designs; none for a lone design, whose line needs no name."""
    if len(designs) == 1:
        return []
    return [
        (design.label, style) for design, style in zip(designs, design_styles(designs), strict=True)
    ]


def degrees(angle: np.ndarray) -> np.ndarray:
    return np.degrees(np.asarray(angle, dtype=float))


def period_axis(designs: Sequence[Design]) -> Axis:
    """Shaft angle over the longest period among the designs."""
    longest = max(float(design.profile.angle[-1]) for design in designs)
    return Axis("Shaft angle", "deg", 0.0, float(np.degrees(longest)), "angle", 6)


def around(
    angle: np.ndarray, values: np.ndarray, low: float, high: float
) -> tuple[np.ndarray, np.ndarray]:
    """One period of values laid end to end so that they cover [low, high], angles ascending."""
    period = float(angle[-1] - angle[0])
    first = int(np.floor((low - angle[0]) / period + 1e-6))
    last = int(np.ceil((high - angle[0]) / period - 1e-6))
    turns = range(first, max(last, first + 1))
    long_angle = np.concatenate([angle[:-1] + period * turn for turn in turns] + [[np.nan]])
    long_angle[-1] = angle[0] + period * (turns[-1] + 1)
    long_values = np.concatenate([np.asarray(values)[:-1]] * len(turns) + [values[-1:]])
    return long_angle, long_values

"""Axes as mathematics: where a value falls on the paper, and which values get a tick."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, floor, isfinite, log10
from typing import Literal

import numpy as np

__all__ = ["Axis", "covering", "format_tick", "nice_ticks"]

_DECIMAL_STEPS = (1.0, 2.0, 5.0, 10.0)
_ANGLE_STEPS = (1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0, 60.0, 90.0)


def _step(span: float, count: int, angles: bool) -> float:
    rough = span / max(count, 1)
    if angles and rough > 0.5:
        return next((step for step in _ANGLE_STEPS if step >= 0.7 * rough), 90.0)
    power = 10.0 ** floor(log10(rough))
    return next(step * power for step in _DECIMAL_STEPS if step * power >= 0.7 * rough)


def nice_ticks(low: float, high: float, count: int = 5, angles: bool = False) -> list[float]:
    """Round values within [low, high], about `count` of them.

    Steps are 1, 2 or 5 times a power of ten; for angles also 15, 30, 45, 60 and 90.
    """
    if not (isfinite(low) and isfinite(high)) or high <= low:
        return [low] if isfinite(low) else []
    step = _step(high - low, count, angles)
    first, last = ceil(low / step - 1e-9), floor(high / step + 1e-9)
    return [k * step for k in range(first, last + 1)]


def format_tick(value: float, step: float) -> str:
    """A tick's label, with as many decimals as the step needs and a true minus sign."""
    if value == 0:
        return "0"
    decimals = max(0, -floor(log10(step) + 1e-9)) if step > 0 else 0
    if decimals > 5 or abs(value) >= 1e7:
        return f"{value:.2g}".replace("-", "−")
    return f"{value:.{decimals}f}".replace("-", "−")


def _log_ticks(low: float, high: float) -> list[float]:
    first, last = floor(log10(low)), ceil(log10(high))
    steps = (1.0,) if last - first > 3 else (1.0, 2.0, 5.0)
    every = max(1, (last - first) // 6)
    ticks = [m * 10.0**k for k in range(first, last + 1, every) for m in steps]
    return [tick for tick in ticks if low * 0.999 <= tick <= high * 1.001]


@dataclass(frozen=True)
class Axis:
    """One axis: what it shows, in which unit, from where to where."""

    label: str
    unit: str
    low: float
    high: float
    kind: Literal["linear", "log", "angle"] = "linear"
    tick_count: int = 5
    marked: tuple[float, ...] = ()  # ticks at these values only, when given

    @property
    def title(self) -> str:
        return f"{self.label}, {self.unit}" if self.unit else self.label

    def fraction(self, value: np.ndarray | float) -> np.ndarray:
        """Where values fall between the ends, 0 at `low` and 1 at `high`; NaN stays NaN."""
        wanted = np.asarray(value, dtype=float)
        if self.kind == "log":
            positive = np.where(wanted > 0, wanted, np.nan)
            return np.log(positive / self.low) / np.log(self.high / self.low)
        return (wanted - self.low) / (self.high - self.low)

    def ticks(self) -> list[tuple[float, str]]:
        """Tick values with their labels."""
        if self.marked:
            return [(value, f"{value:g}") for value in self.marked]
        if self.kind == "log":
            return [(tick, f"{tick:g}") for tick in _log_ticks(self.low, self.high)]
        values = nice_ticks(self.low, self.high, self.tick_count, self.kind == "angle")
        step = values[1] - values[0] if len(values) > 1 else 1.0
        return [(value, format_tick(value, step)) for value in values]


def covering(
    label: str,
    unit: str,
    values: Sequence[np.ndarray],
    *,
    include: Sequence[float] = (),
    margin: float = 0.06,
    kind: Literal["linear", "log"] = "linear",
    tick_count: int = 5,
) -> Axis:
    """An axis that covers every finite value given, with a little room at both ends.

    An end that falls on an `include`d zero stays there, so that bars and
    amplitudes stand on their base line.
    """
    flat = np.concatenate([np.ravel(np.asarray(v, dtype=float)) for v in values] or [np.zeros(0)])
    flat = np.concatenate([flat, np.asarray(include, dtype=float)])
    flat = flat[np.isfinite(flat)]
    if kind == "log":
        flat = flat[flat > 0]
        low, high = (float(flat.min()), float(flat.max())) if flat.size else (0.1, 1.0)
        widen = (high / low) ** margin if high / low > 1.05 else 1.5
        return Axis(label, unit, low / widen, high * widen, "log", tick_count)
    low, high = (float(flat.min()), float(flat.max())) if flat.size else (0.0, 1.0)
    spare = margin * (high - low)
    if spare <= 1e-9 * max(abs(low), abs(high)):
        spare = 0.5 * abs(high) or 1.0
    if low == high:
        return Axis(label, unit, low - spare, high + spare, "linear", tick_count)
    rests, nothing = 0.0 in include, 1e-6 * (high - low)
    return Axis(
        label,
        unit,
        0.0 if rests and abs(low) <= nothing else low - spare,
        0.0 if rests and abs(high) <= nothing else high + spare,
        "linear",
        tick_count,
    )

"""What `validation.json` says of the envelope, as plain records for pictures and tables."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

__all__ = [
    "AGAINST_GIVEN",
    "Condition",
    "InEnvelope",
    "WholeEnvelope",
    "read_envelope",
    "rounded",
    "worst",
]

AGAINST_GIVEN = ("max_ripple_ratio", "max_efficiency_loss")
"""Limits held against the given motor, which says nothing of the given motor itself."""

ROUNDING = 1e-5
"""Of a limit: what differs by less is the same."""

ALIKE = 2e-3
"""Of a margin, or of the ripple's own size: what no reader could tell apart in a picture."""


@dataclass(frozen=True)
class InEnvelope:
    """One design at every point; arrays of shape (point,).

    `limits` are the `g` of docs/theory.md section 8: kept when at most 0, NaN without a result.
    """

    label: str
    sentence: str
    limits: Mapping[str, np.ndarray]
    torque_ripple: np.ndarray
    efficiency: np.ndarray
    broken: np.ndarray

    @property
    def margin(self) -> np.ndarray:
        """The least of all limits; NaN where there is no result."""
        return -np.max(np.stack(list(self.limits.values())), axis=0)

    @property
    def binding(self) -> list[str]:
        """At every point the limit with the least margin."""
        names = list(self.limits)
        values = np.nan_to_num(np.stack(list(self.limits.values())), nan=np.inf)
        return [names[place] for place in np.argmax(values, axis=0)]


@dataclass(frozen=True)
class Condition:
    """Points that differ in speed and supply pressure alone; `words` is empty for all of them."""

    words: str
    points: np.ndarray


@dataclass(frozen=True)
class WholeEnvelope:
    """Where the motor was looked at, SI and absolute, and each design there.

    `asked` says whether the file has an envelope; else the range is camring's own choice.
    `seen_twice` holds the points that the second solver saw.
    """

    asked: bool
    span: str
    speed: np.ndarray
    supply_pressure: np.ndarray
    return_pressure: np.ndarray
    backwards: np.ndarray
    fluid: np.ndarray
    designs: tuple[InEnvelope, ...]
    seen_twice: tuple[int, ...] = ()
    warning: str = ""

    def place(self, point: int) -> str:
        """One point in words."""
        rpm = rounded(self.speed[point] * 30 / np.pi)
        bar = rounded(self.supply_pressure[point] / 1e5)
        return ", ".join(filter(None, (f"{rpm:g} rpm", f"{bar:g} bar", self._beside(point))))

    def _beside(self, point: int) -> str:
        """What beside speed and supply pressure the point is known by."""
        words = []
        if self.backwards.any():
            words.append("backwards" if self.backwards[point] else "forwards")
        if self.fluid.any():
            words.append("hot oil" if self.fluid[point] else "cold oil")
        if np.ptp(self.return_pressure) > 0:
            words.append(f"return {self.return_pressure[point] / 1e5:.4g} bar")
        return ", ".join(words)

    def conditions(self) -> tuple[list[Condition], str]:
        """Each set of points that belongs into one picture, and what was left out as the same.

        Backwards is left out where every design is the same both ways.
        """
        names = [self._beside(point) for point in range(len(self.speed))]
        found = [
            Condition(name, np.array([k for k, each in enumerate(names) if each == name]))
            for name in dict.fromkeys(names)
        ]
        if not self.backwards.any():
            return found, ""
        ahead = [each for each in found if not self.backwards[each.points[0]]]
        behind = [each for each in found if self.backwards[each.points[0]]]
        if len(ahead) != len(behind) or not all(map(self._alike, ahead, behind)):
            return found, ""
        return [
            Condition(each.words.removeprefix("forwards").removeprefix(", "), each.points)
            for each in ahead
        ], "Backwards every design is the same as forwards."

    def _alike(self, one: Condition, other: Condition) -> bool:
        if len(one.points) != len(other.points):
            return False
        for design in self.designs:
            ripple, margin = design.torque_ripple, design.margin
            scale = np.abs(ripple[one.points]) + 1e-3
            if not (
                np.array_equal(design.broken[one.points], design.broken[other.points])
                and np.allclose(margin[one.points], margin[other.points], rtol=0, atol=ALIKE)
                and np.all(np.abs(ripple[one.points] - ripple[other.points]) <= ALIKE * scale)
            ):
                return False
        return True


def rounded(value: float) -> float:
    """To three digits, as points of an envelope are named."""
    return float(f"{value:.3g}")


def worst(values: np.ndarray) -> int:
    """The place of the largest value, the first of those that differ by rounding; NaN is worst."""
    values = np.nan_to_num(values, nan=np.inf)
    return int(np.flatnonzero(values >= np.max(values) - ROUNDING)[0])


def read_envelope(path: Path) -> WholeEnvelope | None:
    """The envelope of a validation file; None when there is none or it cannot be read."""
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
        return envelope_of(document["envelope"])
    except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return None


def envelope_of(document: Mapping[str, Any]) -> WholeEnvelope | None:
    """From the document of a check of an envelope; None for an empty one.

    Raises
    ------
    KeyError, TypeError, ValueError
        When the document is none.
    """
    if not document:
        return None
    axes = {
        name: _numbers(document[name]) for name in ("speed", "supply_pressure", "return_pressure")
    }
    count = len(axes["speed"])
    designs = tuple(
        _design(label, entry, count)
        for label, entry in document["designs"].items()
        if entry["limits"]
    )
    backwards = np.array(document["backwards"], dtype=bool)
    fluid = np.array(document["fluid"], dtype=int)
    shapes = {len(values) for values in (*axes.values(), backwards, fluid)}
    if not count or not designs or shapes != {count}:
        raise ValueError("the points of the envelope do not fit each other")
    return WholeEnvelope(
        asked=document["asked"] is True,
        span=str(document["range"]),
        backwards=backwards,
        fluid=fluid,
        designs=designs,
        seen_twice=tuple(int(each["point"]) for each in document.get("second_solver", ())),
        warning=str(document.get("warning", "")),
        **axes,
    )


def _design(label: str, entry: Mapping[str, Any], count: int) -> InEnvelope:
    limits = {name: _numbers(values) for name, values in entry["limits"].items()}
    broken = np.array(entry["broken"], dtype=bool)
    if label == "given" and len(limits) > sum(name in limits for name in AGAINST_GIVEN):
        without_result = broken & ~_breaks(limits)
        limits = {name: values for name, values in limits.items() if name not in AGAINST_GIVEN}
        broken = _breaks(limits) | without_result
    ripple, efficiency = _numbers(entry["torque_ripple"]), _numbers(entry["efficiency"])
    if any(len(each) != count for each in (*limits.values(), broken, ripple, efficiency)):
        raise ValueError(f"the results of the {label} design do not fit the points")
    return InEnvelope(label, str(entry["sentence"]), limits, ripple, efficiency, broken)


def _breaks(limits: Mapping[str, np.ndarray]) -> np.ndarray:
    return ~(np.max(np.stack(list(limits.values())), axis=0) <= 0)


def _numbers(values: Sequence[float | None]) -> np.ndarray:
    """Numbers as JSON has them: null for one that is not finite."""
    return np.array([np.nan if each is None else float(each) for each in values])

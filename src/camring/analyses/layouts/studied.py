"""What the studies of several layouts came to, as records."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from camring.analyses.layouts.layout import Layout
from camring.evaluation.record import Record
from camring.files.motor import MotorFile

__all__ = ["WORST", "Refused", "Studied", "Studies", "worst"]


WORST = {
    "torque_ripple": max,
    "efficiency": min,
    "max_contact_stress": max,
    "max_pressure_angle": max,
    "stroke": max,
}
"""Results in the ranking, each at the operating point where it is worst."""


@dataclass(frozen=True, eq=False)
class Studied:
    """What the study of one layout came to.

    Attributes
    ----------
    given, best
        The derived motor and the best design; None when no design keeps every limit.
    """

    layout: Layout
    folder: Path
    given: Record
    best: Record | None
    validated: bool
    sentence: str
    evaluations: int


@dataclass(frozen=True)
class Refused:
    """A layout that cannot be built, and why."""

    layout: Layout
    reason: str


@dataclass(frozen=True, eq=False)
class Studies:
    """All layouts of a given motor: ranked by the best objective, the infeasible ones last."""

    file: MotorFile
    folder: Path
    own: Layout
    ranked: Sequence[Studied]
    refused: Sequence[Refused]


def worst(each: Studied, name: str) -> float:
    """A result of the best design at its worst operating point, SI."""
    assert each.best is not None
    return WORST[name](result[name] for result in each.best.outcome.results)

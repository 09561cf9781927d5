"""One evaluation of a study: a design, its outcome, its number, its time; a row of its database."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from camring.evaluation.outcome import SAFETY, Outcome, envelope_safety

NOT_NUMBERED = -1
"""The trial of an evaluation that was made ahead of its turn, or has not been kept yet."""


NOT_FINITE = "a result or a limit is no finite number"


@dataclass(frozen=True, eq=False)
class Record:
    """One evaluation of a study: a design, its outcome, its number and its time.

    Attributes
    ----------
    trial, phase
        Its place among the study's evaluations, from 0, and which part of the search asked for
        it; `NOT_NUMBERED` and empty until its turn has come.
    point
        In the unit box of the design space; exact to the last bit.
    started
        Seconds since 1970, UTC.
    seconds
        Wall time that the evaluation took.
    """

    trial: int
    phase: str
    point: Float[np.ndarray, " dimension"]
    outcome: Outcome
    started: float = 0.0
    seconds: float = 0.0

    def numbered(self, trial: int, phase: str) -> "Record":
        """The same evaluation in its turn."""
        return replace(self, trial=trial, phase=phase)

    @property
    def failed(self) -> bool:
        """Whether the objective or a constraint has no finite value."""
        outcome = self.outcome
        numbers = [outcome.objective, *outcome.constraints.values()]
        return outcome.failure is not None or not all(map(math.isfinite, numbers))

    @property
    def failure(self) -> str:
        """What failed, in words; empty where nothing did."""
        return (self.outcome.failure or NOT_FINITE) if self.failed else ""

    @property
    def feasible(self) -> bool:
        """Whether the design works and keeps every limit."""
        return self.within(0.0)

    @property
    def safe(self) -> bool:
        """Whether it keeps every limit by the margin that a search keeps."""
        envelope = self.outcome.envelope
        limits = {} if envelope is None else envelope.limits
        return self.within(SAFETY) and all(
            g <= -envelope_safety(name) for name, values in limits.items() for g in values
        )

    def within(self, margin: float) -> bool:
        """Whether the design works and keeps every limit by a margin."""
        return not self.failed and all(
            value <= -margin for value in self.outcome.constraints.values()
        )


def best_of(records: Sequence[Record]) -> Record | None:
    """The feasible record of lowest objective, the earlier of equals; None if none is feasible.

    One that is `safe` comes before any that is not.
    """
    feasible = [record for record in records if record.feasible]
    return min(
        feasible,
        key=lambda record: (not record.safe, record.outcome.objective),
        default=None,
    )


def closest_of(records: Sequence[Record]) -> Record | None:
    """The working record that breaks its limits least in sum; None when every one failed."""
    working = [record for record in records if not record.failed]
    return min(working, key=_violation, default=None)


def _violation(record: Record) -> float:
    return math.fsum(max(value, 0.0) for value in record.outcome.constraints.values())

"""What one evaluation leaves behind, as plain numbers."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

Numbers = Mapping[str, float]

# The search keeps this far inside each limit, so that a design on a limit still
# holds when it is looked at with a finer or another eye.
SAFETY = 1e-4


@dataclass(frozen=True)
class Outcome:
    """What an evaluator says about one point.

    Attributes
    ----------
    objective
        What the search minimises, penalty included; NaN when the evaluation failed.
    physical_objective
        The same without penalty, `J_phys` of model.md section 8.
    approximation
        The linear model's cheap guess of it; NaN when there is none.
    constraints
        Each kept when at most 0, worst over the operating points.
    terms
        Raw terms of the objective for each operating point, before any weight, so
        that weights can be changed without simulating again.
    results
        Every result of each operating point, SI, by its name of model.md section 10.
    design
        What the point stands for: SI values by path in the motor file.
    failure
        Why there is no objective, in words; None when there is one.
    """

    objective: float
    constraints: Numbers = field(default_factory=dict)
    physical_objective: float = math.nan
    approximation: float = math.nan
    terms: Sequence[Numbers] = ()
    results: Sequence[Numbers] = ()
    design: Mapping[str, float | Sequence[float]] = field(default_factory=dict)
    failure: str | None = None


def failed(reason: str, constraints: Sequence[str] = ()) -> Outcome:
    """The outcome of an evaluation that gave no numbers."""
    return Outcome(math.nan, dict.fromkeys(constraints, math.nan), failure=reason)


@dataclass(frozen=True, eq=False)
class Record:
    """One completed trial as the study keeps it.

    Attributes
    ----------
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

    @property
    def failed(self) -> bool:
        """Whether the objective or a constraint has no finite value."""
        outcome = self.outcome
        numbers = [outcome.objective, *outcome.constraints.values()]
        return outcome.failure is not None or not all(map(math.isfinite, numbers))

    @property
    def feasible(self) -> bool:
        """Whether the design works and keeps every limit."""
        return self.within(0.0)

    def within(self, margin: float) -> bool:
        """Whether the design works and keeps every limit by a margin."""
        return not self.failed and all(
            value <= -margin for value in self.outcome.constraints.values()
        )


def best_of(records: Sequence[Record]) -> Record | None:
    """The feasible record of lowest objective, the earlier of equals; None if none is feasible.

    One that keeps every limit by `SAFETY` comes before any that does not.
    """
    feasible = [record for record in records if record.feasible]
    return min(
        feasible,
        key=lambda record: (not record.within(SAFETY), record.outcome.objective),
        default=None,
    )


def closest_of(records: Sequence[Record]) -> Record | None:
    """The working record that breaks its limits least in sum; None when every one failed."""
    working = [record for record in records if not record.failed]
    return min(working, key=_violation, default=None)


def _violation(record: Record) -> float:
    return math.fsum(max(value, 0.0) for value in record.outcome.constraints.values())

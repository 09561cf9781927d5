"""A function on the unit box under constraints, whose best value is known."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

Point = Float[np.ndarray, " dimension"]
TOLERANCE = 1e-6
"""Of a constraint: up to here it counts as kept, for every method alike."""


@dataclass(frozen=True, eq=False)
class ValueAt:
    """What a problem says of one point; a failure in words makes the numbers void."""

    objective: float
    constraints: Float[np.ndarray, " constraint"]
    failure: str | None = None

    @property
    def violation(self) -> float:
        """The largest excess of a constraint over 0; infinite where the evaluation failed."""
        if self.failure is not None:
            return float("inf")
        return float(np.max(self.constraints, initial=0.0))

    @property
    def feasible(self) -> bool:
        return self.violation <= TOLERANCE


@dataclass(frozen=True, eq=False)
class SearchProblem:
    """One problem of the benchmark.

    Attributes
    ----------
    budget
        Evaluations of a run.
    evaluate
        At a point of the unit box.
    slopes
        Gradient of the objective, and that of each constraint in a row, on the unit box.
    approximate
        A cheap approximation of the objective at many points, where there is one.
    given
        The points that a user has before any search; a seed's own are near these.
    long_budget
        Evaluations of a run by a method that thinks next to nothing; None is `budget`.
    best
        The best value known: of the literature, or for a motor of descents from many starts.
    minimiser
        Where the literature has it, on the unit box; to the digits printed there.
    source
        Who published problem and value.
    """

    name: str
    dimension: int
    constraint_count: int
    budget: int
    evaluate: Callable[[Point], ValueAt]
    slopes: Callable[[Point], tuple[np.ndarray, np.ndarray]]
    approximate: Callable[[np.ndarray], np.ndarray] | None = None
    given: tuple[tuple[float, ...], ...] = ()
    best: float = -float("inf")
    minimiser: tuple[float, ...] = ()
    source: str = ""
    long_budget: int | None = None

"""What a search is about: a function on the unit box, its evaluations, a strategy.

Every strategy answers one question, "which point next?", from nothing but its
own settings, the evaluations so far, a memory that it wrote itself, and a seed.
A study that stores evaluations and memory can therefore be stopped anywhere and
continues with the same bits.
"""

import abc
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np
from jaxtyping import Float

Memory: TypeAlias = dict[str, Any]
Points: TypeAlias = Float[np.ndarray, "points dimension"]
Outputs: TypeAlias = tuple[float, Float[np.ndarray, " constraints"], float, str | None]


@dataclass(frozen=True, eq=False)
class Evaluation:
    """One completed trial.

    Attributes
    ----------
    trial
        Its place in the history, from 0.
    point
        Where, in the unit box.
    objective
        What is to be minimised; NaN when the evaluation failed.
    constraints
        Each is satisfied when it is at most 0; NaN where it could not be computed.
    approximation
        The cheap approximation of the objective at the point; NaN when there is none.
    failure
        Why there is no objective, in words; None when there is one.
    phase
        Which part of which strategy asked for the point.
    """

    trial: int
    point: Float[np.ndarray, " dimension"]
    objective: float
    constraints: Float[np.ndarray, " constraints"]
    approximation: float = math.nan
    failure: str | None = None
    phase: str = ""

    @property
    def failed(self) -> bool:
        """True when objective or a constraint has no finite value."""
        return (
            self.failure is not None
            or not math.isfinite(self.objective)
            or not bool(np.all(np.isfinite(self.constraints)))
        )

    @property
    def violation(self) -> float:
        """Sum of what the constraints exceed 0 by; infinite when failed."""
        if self.failed:
            return math.inf
        return float(np.sum(np.maximum(self.constraints, 0.0)))

    def feasible(self, tolerance: float = 0.0) -> bool:
        """True when not failed and no constraint exceeds the tolerance."""
        return not self.failed and bool(np.all(self.constraints <= tolerance))

    def rank(self, tolerance: float = 0.0) -> tuple[float, float]:
        """Sorts evaluations, best first: feasible by objective, then by violation, failed last."""
        if self.feasible(tolerance):
            return 0.0, self.objective
        return 1.0, self.violation


@dataclass(frozen=True)
class Problem:
    """A function on the unit box to minimise subject to constraints.

    Attributes
    ----------
    evaluate
        Given points (k, dimension), returns k tuples (objective, constraints,
        approximation, failure). A failed point has NaN and a sentence.
    approximate
        Cheap approximation of the objective at many points, (k, dimension) to
        (k,), or None.
    """

    dimension: int
    constraint_count: int
    evaluate: Callable[[Points], Sequence[Outputs]]
    approximate: Callable[[Points], Float[np.ndarray, " points"]] | None = None


@dataclass(frozen=True, eq=False)
class Proposal:
    """The next point to evaluate, and what the strategy wants to remember with it."""

    point: Float[np.ndarray, " dimension"]
    phase: str
    memory: Memory = field(default_factory=dict)  # JSON: only text, numbers, lists, dictionaries

    @staticmethod
    def of_batch(
        points: Sequence[Float[np.ndarray, " dimension"]], phase: str, memory: Memory
    ) -> "Proposal":
        """The first of points chosen together; the others wait in the memory."""
        rest = [point.tolist() for point in points[1:]]
        return Proposal(points[0], phase, {**memory, "phase": phase, "ahead": rest})

    @staticmethod
    def waiting(memory: Memory) -> "Proposal | None":
        """The next point of the batch at hand; None when it is used up."""
        rest = memory.get("ahead")
        if not rest:
            return None
        kept = {**memory, "ahead": rest[1:]}
        return Proposal(np.array(rest[0], dtype=float), memory["phase"], kept)


@dataclass(frozen=True)
class Stop:
    """The strategy has no further point to ask for, and says why in one sentence."""

    reason: str


class AbstractStrategy(abc.ABC):
    """Decides which point to evaluate next."""

    @abc.abstractmethod
    def propose(self, history: Sequence[Evaluation], memory: Memory, seed: int) -> Proposal | Stop:
        """The next point, as a pure function of settings and arguments.

        Parameters
        ----------
        history
            Every evaluation so far, in order of trial.
        memory
            Of the last proposal in the history; empty at the start.
        seed
            The only source of chance.
        """

    def ahead(self, trial: int, memory: Memory) -> list[Float[np.ndarray, " dimension"]]:
        """The points that will be proposed next whatever the evaluations bring, in order.

        Several workers evaluate them at once. A strategy that thinks in batches keeps
        the rest of its batch in its memory, as `ahead`.

        Parameters
        ----------
        trial
            Which the first of them will be.
        memory
            Of the proposal before it.
        """
        return [np.array(point, dtype=float) for point in memory.get("ahead", ())]


def best_of(history: Sequence[Evaluation], tolerance: float = 0.0) -> Evaluation | None:
    """The feasible evaluation of lowest objective, else the least violation; None if all failed."""
    usable = [evaluation for evaluation in history if not evaluation.failed]
    return min(usable, key=lambda evaluation: evaluation.rank(tolerance), default=None)

"""What long work asks again and again, and who may remember what was answered."""

from collections.abc import Callable
from typing import Protocol, TypeAlias, TypeVar

import numpy as np
from jaxtyping import Float

from camring.search.problem import Outputs, Points, Problem

Arrays: TypeAlias = tuple[np.ndarray, ...]
Answer = TypeVar("Answer", bound=Arrays)


class Remember(Protocol):
    """The function of that name which computes nothing twice, not even in another process."""

    def __call__(
        self, name: str, function: Callable[[np.ndarray], Answer], /
    ) -> Callable[[np.ndarray], Answer]: ...


def forget(name: str, function: Callable[[np.ndarray], Answer]) -> Callable[[np.ndarray], Answer]:
    """Where nothing is kept."""
    return function


def remembered_problem(remember: Remember, name: str, problem: Problem) -> Problem:
    """Of which each evaluation is remembered."""

    def outputs(point: Float[np.ndarray, " dimension"]) -> Arrays:
        [(objective, constraints, approximation, failure)] = problem.evaluate(point[None])
        words = np.array(failure or "")
        return np.array(objective), np.asarray(constraints), np.array(approximation), words

    kept = remember(name, outputs)

    def evaluate(points: Points) -> list[Outputs]:
        found = [kept(np.asarray(point, dtype=float)) for point in points]
        return [(float(o), limits, float(a), str(words) or None) for o, limits, a, words in found]

    return Problem(problem.dimension, problem.constraint_count, evaluate)

"""The loop: ask a strategy, evaluate, tell it, until it stops or the budget is spent."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from camring.search.ask_tell import AskTell
from camring.search.problem import (
    AbstractStrategy,
    Evaluation,
    Memory,
    Outputs,
    Problem,
    Stop,
)

HOPELESS = 20  # evaluations; if the first so many all fail, something else is wrong


def hopeless(history: Sequence[Evaluation]) -> bool:
    """Whether it is time to stop because every evaluation so far has failed."""
    return len(history) == HOPELESS and all(one.failed for one in history)


@dataclass(frozen=True, eq=False)
class SearchResult:
    """What a search found.

    Attributes
    ----------
    best
        The feasible evaluation of lowest objective, else the one of least
        violation; None when all failed.
    stop_reason
        Which test ended the search, in one sentence.
    memory
        With it and the history the search can be continued.
    """

    best: Evaluation | None
    history: tuple[Evaluation, ...]
    stop_reason: str
    memory: Memory


def _outputs(problem: Problem, point: Float[np.ndarray, " dimension"]) -> Outputs:
    """One trial carried out; an exception of the problem becomes a failed evaluation."""
    try:
        return problem.evaluate(point[None])[0]
    except Exception as error:  # recorded, not fatal: one bad point must not end a study
        nothing = np.full(problem.constraint_count, np.nan)
        return np.nan, nothing, np.nan, f"{type(error).__name__}: {error}"


def minimise(
    problem: Problem,
    strategy: AbstractStrategy,
    budget: int,
    seed: int = 0,
    history: Sequence[Evaluation] = (),
    memory: Memory | None = None,
    on_evaluation: Callable[[Evaluation, Memory], None] | None = None,
    tolerance: float = 0.0,
) -> SearchResult:
    """Searches until the strategy stops or there are `budget` evaluations in all.

    Parameters
    ----------
    budget
        Evaluations in all, those in `history` included.
    history, memory
        Of an earlier search to be continued; the result has the same bits as if
        it had never been interrupted.
    on_evaluation
        Called after each evaluation with it and the memory to keep beside it.
    tolerance
        Violation up to which a constraint counts as satisfied.
    """
    asking = AskTell(strategy, problem.constraint_count, seed, history, memory)
    reason = f"The budget of {budget} evaluations is spent."
    while len(asking.history) < budget:
        point = asking.ask()
        if isinstance(point, Stop):
            reason = point.reason
            break
        objective, constraints, approximation, failure = _outputs(problem, point)
        evaluation = asking.tell(objective, constraints, failure, approximation=approximation)
        if on_evaluation is not None:
            on_evaluation(evaluation, asking.memory)
        if hopeless(asking.history):
            reason = f"The first {HOPELESS} evaluations all failed; the last: {evaluation.failure}."
            break
    return SearchResult(asking.best(tolerance), asking.history, reason, asking.memory)

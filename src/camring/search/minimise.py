"""The loop: ask a strategy, evaluate, tell it, until it stops or the budget is spent."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from camring.search.problem import (
    AbstractStrategy,
    Evaluation,
    Memory,
    Problem,
    Proposal,
    Stop,
    best_of,
)

HOPELESS = 20  # evaluations; if the first so many all fail, something else is wrong


@dataclass(frozen=True, eq=False)
class Outcome:
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


def evaluated(problem: Problem, proposal: Proposal, trial: int) -> Evaluation:
    """One trial carried out; an exception of the problem becomes a failed evaluation."""
    failure: str | None
    try:
        outputs = problem.evaluate(proposal.point[None])[0]
        objective, constraints, approximation, failure = outputs
    except Exception as error:  # recorded, not fatal: one bad point must not end a study
        objective, approximation = np.nan, np.nan
        constraints = np.full(problem.constraint_count, np.nan)
        failure = f"{type(error).__name__}: {error}"
    constraints = np.asarray(constraints, dtype=float)
    if failure is None and not np.isfinite(objective):
        failure = f"the objective is {objective}"
    if failure is None and not np.all(np.isfinite(constraints)):
        failure = f"constraint {int(np.argmin(np.isfinite(constraints)))} is not finite"
    return Evaluation(
        trial,
        proposal.point,
        float(objective),
        constraints,
        float(approximation),
        failure,
        proposal.phase,
    )


def minimise(
    problem: Problem,
    strategy: AbstractStrategy,
    budget: int,
    seed: int = 0,
    history: Sequence[Evaluation] = (),
    memory: Memory | None = None,
    on_evaluation: Callable[[Evaluation, Memory], None] | None = None,
    tolerance: float = 0.0,
) -> Outcome:
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
    done = list(history)
    remembered: Memory = dict(memory or {})
    reason = f"The budget of {budget} evaluations is spent."
    while len(done) < budget:
        proposal = strategy.propose(done, remembered, seed)
        if isinstance(proposal, Stop):
            reason = proposal.reason
            break
        evaluation = evaluated(problem, proposal, len(done))
        done.append(evaluation)
        remembered = proposal.memory
        if on_evaluation is not None:
            on_evaluation(evaluation, remembered)
        if len(done) == HOPELESS and all(one.failed for one in done):
            reason = f"The first {HOPELESS} evaluations all failed; the last: {evaluation.failure}."
            break
    return Outcome(best_of(done, tolerance), tuple(done), reason, remembered)

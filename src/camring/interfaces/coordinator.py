"""The loop of a study: propose, evaluate, keep; the single writer of its database.

Nothing that decides where the search goes lives between two turns of the loop:
each turn starts from what the database holds. Hence a study that was killed goes
on exactly as if nothing had happened.
"""

import time
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from jaxtyping import Float

from camring.interfaces.executors import InThisProcess
from camring.interfaces.interrupt import Interruption
from camring.interfaces.record import Outcome, Record, failed
from camring.interfaces.store import Store
from camring.search.problem import AbstractStrategy, Evaluation, Stop

# Half a finding: the search keeps this far inside each limit, so that a design on
# a limit still holds when it is looked at with a finer or another eye.
SAFETY = 1e-4


class Watcher(Protocol):
    """Who wants to see each evaluation as it is kept."""

    def __call__(self, record: Record) -> None: ...


@dataclass(frozen=True)
class Search:
    """What is searched, by whom, how long.

    Attributes
    ----------
    evaluate
        Given a point of the unit box; may run in another process.
    constraints
        Names, in the order in which the strategy sees them.
    budget
        Evaluations in all, those of former runs included.
    """

    evaluate: Callable[[Float[np.ndarray, " dimension"]], Outcome]
    constraints: Sequence[str]
    strategy: AbstractStrategy
    budget: int
    seed: int


def search(
    task: Search,
    store: Store,
    executor: Executor,
    interruption: Interruption,
    watch: Watcher = lambda record: None,
) -> str:
    """Goes on with a study until its strategy stops or its budget is spent; says which.

    Raises
    ------
    Interrupted
        When a signal came; whatever was completed is kept.
    StudyError
        When an evaluation cannot be kept.
    """
    thinking = InThisProcess()
    records = store.records()
    history = [as_seen_by_search(record, task.constraints) for record in records]
    memory = store.memory()
    while len(history) < task.budget:
        proposal = interruption.run(thinking, task.strategy.propose, history, memory, task.seed)
        if isinstance(proposal, Stop):
            return proposal.reason
        started, clock = time.time(), time.perf_counter()
        outcome = interruption.run(
            executor, evaluate_or_fail, task.evaluate, task.constraints, proposal.point
        )
        record = Record(
            trial=len(history),
            phase=proposal.phase,
            point=np.asarray(proposal.point, dtype=float),
            outcome=outcome,
            started=started,
            seconds=time.perf_counter() - clock,
        )
        store.append(record, proposal.memory)
        history.append(as_seen_by_search(record, task.constraints))
        # Read back, so that a memory which text cannot hold shows at once and not after a kill.
        memory = store.memory()
        watch(record)
    return f"the budget of {task.budget} evaluations is spent"


def evaluate_or_fail(
    evaluate: Callable[[Float[np.ndarray, " dimension"]], Outcome],
    constraints: Sequence[str],
    point: Float[np.ndarray, " dimension"],
) -> Outcome:
    """One bad design must not sink the study: an error becomes a failed evaluation."""
    try:
        return evaluate(point)
    except Exception as error:
        return failed(f"{type(error).__name__}: {error}".splitlines()[0], constraints)


def as_seen_by_search(record: Record, constraints: Sequence[str]) -> Evaluation:
    """The record in the words of the search room, each limit drawn a little tighter."""
    outcome = record.outcome
    values = [outcome.constraints.get(name, np.nan) for name in constraints]
    return Evaluation(
        trial=record.trial,
        point=record.point,
        objective=outcome.physical_objective,
        constraints=np.array(values, dtype=float) + SAFETY,
        approximation=outcome.approximation,
        failure=outcome.failure,
        phase=record.phase,
    )

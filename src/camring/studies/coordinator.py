"""The loop of a study: propose, evaluate, keep; the single writer of its database.

Nothing that decides where the search goes lives between two turns of the loop:
each turn starts from what the database holds. Hence a study that was killed goes
on exactly as if nothing had happened. Trials are kept in their order; what was
evaluated ahead of its turn and not kept is evaluated again.
"""

import functools
import json
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import closing
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from jaxtyping import Float

from camring.evaluation.executors import InThisProcess
from camring.evaluation.interrupt import Interruption
from camring.evaluation.outcome import SAFETY, Outcome, envelope_safety, failed, named_by_point
from camring.evaluation.queue import Desk
from camring.evaluation.record import NOT_NUMBERED, Record
from camring.evaluation.user_programs.numbers import NotBelieved
from camring.search.minimise import HOPELESS, hopeless
from camring.search.problem import AbstractStrategy, Evaluation, Outputs, Stop
from camring.studies.store import Store


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
    WorkersGone
        When the executor evaluates nothing any more; the same holds.
    """
    evaluate = functools.partial(evaluated, task.evaluate, task.constraints)
    lost = functools.partial(lost_at, task.constraints)
    with closing(Desk(executor, evaluate, lost, interruption.wait_for)) as desk:
        return _turns(task, store, desk, interruption, watch)


def _turns(
    task: Search,
    store: Store,
    desk: "Desk[Record]",
    interruption: Interruption,
    watch: Watcher,
) -> str:
    thinking = InThisProcess()
    history = [_in_history(record, task.constraints) for record in store.records()]
    memory = store.memory()
    surrogates = leave_one_out(memory)
    while len(history) < task.budget:
        if hopeless(history):
            return f"The first {HOPELESS} evaluations all failed: {history[-1].failure}."
        proposal = interruption.run(thinking, task.strategy.propose, history, memory, task.seed)
        if isinstance(proposal, Stop):
            return proposal.reason
        point, next_trial = np.asarray(proposal.point, dtype=float), len(history) + 1
        ahead = task.strategy.ahead(next_trial, proposal.memory)[: task.budget - next_trial]
        record = desk.answer(point, ahead).numbered(len(history), proposal.phase)
        surrogates = leave_one_out(proposal.memory) or surrogates
        facts = {"leave_one_out": json.dumps(surrogates)} if surrogates else {}
        store.append(record, proposal.memory, facts)
        history.append(_in_history(record, task.constraints))
        # Read back, so that a memory which text cannot hold shows at once and not after a kill.
        memory = store.memory()
        watch(record)
    return f"The budget of {task.budget} evaluations is spent."


def evaluated(
    evaluate: Callable[[Float[np.ndarray, " dimension"]], Outcome],
    constraints: Sequence[str],
    point: Float[np.ndarray, " dimension"],
) -> Record:
    """The evaluation of a point, timed where it is evaluated; its number comes with its turn."""
    started, clock = time.time(), time.perf_counter()
    outcome = evaluate_or_fail(evaluate, constraints, point)
    return Record(NOT_NUMBERED, "", point, outcome, started, time.perf_counter() - clock)


def lost_at(
    constraints: Sequence[str], point: Float[np.ndarray, " dimension"], reason: str
) -> Record:
    """That of a point whose evaluation was lost, and how long it took with it."""
    return Record(NOT_NUMBERED, "", point, failed(reason, constraints), time.time())


def evaluate_or_fail(
    evaluate: Callable[[Float[np.ndarray, " dimension"]], Outcome],
    constraints: Sequence[str],
    point: Float[np.ndarray, " dimension"],
) -> Outcome:
    """One bad design must not sink the study: an error becomes a failed evaluation."""
    try:
        return evaluate(point)
    except NotBelieved:  # no fault of this design: every other would be misjudged alike
        raise
    except Exception as error:
        return failed(f"{type(error).__name__}: {error}".splitlines()[0], constraints)


def _in_history(record: Record, constraints: Sequence[str]) -> Evaluation:
    seen = as_seen_by_search(record.outcome, constraints)
    return Evaluation(record.trial, record.point, *seen, phase=record.phase)


def as_seen_by_search(outcome: Outcome, constraints: Sequence[str]) -> Outputs:
    """The outcome in the words of the search package, each limit drawn a little tighter."""
    known = {name: g + SAFETY for name, g in outcome.constraints.items()}
    envelope = outcome.envelope
    if envelope is not None:
        known |= {name: g + SAFETY for name, g in envelope.pointwise().items()}
        tighter = {
            name: [g + envelope_safety(name) for g in values]
            for name, values in envelope.limits.items()
        }
        known |= named_by_point(tighter, {})
        known |= {name: max(known[name], *values) for name, values in tighter.items()}
    values = [known.get(name, np.nan) for name in constraints]
    limits = np.array(values, dtype=float)
    return outcome.physical_objective, limits, outcome.approximation, outcome.failure


def leave_one_out(memory: Any) -> dict[str, Any] | None:
    """How well each kind of surrogate predicts, wherever a strategy's memory says so.

    Returns
    -------
    `errors` (root mean square over the spread of the objective) and `rho` by name
    of the surrogate, and which is `used`; None while there is no surrogate.
    """
    if isinstance(memory, list):
        inner = memory
    elif isinstance(memory, Mapping):
        inner = list(memory.values())
    else:
        return None
    found = memory.get("leave_one_out") if isinstance(memory, Mapping) else None
    if isinstance(memory, Mapping) and isinstance(found, Mapping):
        return {
            "errors": {name: error for name, (error, _) in found.items()},
            "rho": {name: rho for name, (_, rho) in found.items()},
            "used": memory.get("mean", ""),
        }
    return next((each for each in map(leave_one_out, inner) if each), None)

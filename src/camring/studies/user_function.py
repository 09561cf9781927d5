"""A user's own Python function, minimised: expensive, without slopes, sometimes failing."""

import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import ExitStack, closing
from dataclasses import dataclass
from typing import Any

import numpy as np

from camring.evaluation.executors import batch_of
from camring.evaluation.queue import Desk, WorkersGone
from camring.evaluation.user_programs.process import FunctionFailed, UserProcess
from camring.files.errors import InputError, quote
from camring.search.ask_tell import AskTell
from camring.search.minimise import HOPELESS, hopeless
from camring.search.problem import Evaluation, Stop, best_of
from camring.search.strategies import STRATEGIES, Task, strategy_named

OBJECTIVE = "objective"
WITHOUT_SLOPES = tuple(name for name in STRATEGIES if name != "gradient")
Row = dict[str, Any]


@dataclass(frozen=True, eq=False)
class FunctionMinimum:
    """What a search of a user's function found.

    Attributes
    ----------
    best
        The row of the lowest objective that keeps every constraint, else of the
        least violation; None when every evaluation failed.
    feasible
        Whether `best` keeps every constraint.
    history
        A row for each evaluation: `trial`, `phase`, each variable, `objective`, each
        constraint, `failure` (None when there was none), and whatever else the function
        returned. Any table library reads it: `pandas.DataFrame(found.history)`.
    stop_reason
        Which test ended the search, in one sentence.
    """

    best: Row | None
    feasible: bool
    history: list[Row]
    stop_reason: str


def minimise_function(
    function: Callable[..., Any],
    variables: Mapping[str, tuple[float, float]],
    constraints: Sequence[str] = (),
    *,
    budget: int = 100,
    seed: int = 0,
    method: str = "automatic",
    given: Sequence[Mapping[str, float]] = (),
    timeout: float | None = None,
    executor: Executor | None = None,
    batch: int | None = None,
    watch: Callable[[Row], None] = lambda row: None,
) -> FunctionMinimum:
    """Minimises a function of named numbers between bounds.

    Parameters
    ----------
    function
        Called as `function(width=0.5, height=1.2)`. Returns the objective; or a pair
        `(objective, constraints)`, these in order or by name; or a dictionary with
        "objective", each constraint, and whatever else shall stand in the history.
        An exception, NaN or missing number is a failed evaluation, which the search
        notes and learns to avoid.
    variables
        Name to (low, high), in the function's own units.
    constraints
        Names of what must be at most 0. Best of the order of one, such as
        `stress / limit - 1`.
    budget
        Evaluations in all.
    method
        "bayesian", "cma-es", "cobyqa", "differences", "nelder-mead" or "scbo". "automatic"
        is "differences" above six variables, where the budget pays for a descent and the
        function is smooth enough, which is measured; else "scbo".
    given
        Designs to begin with, name to number.
    timeout
        Seconds after which an evaluation is stopped and counts as failed; the function
        then runs in a process of its own.
    executor
        Where the function runs, such as `camring.Workers(4)`; else here.
    batch
        Designs chosen at once, on which the result depends as it does on the seed; else
        as many as the executor has workers.
    watch
        Called with each row of the history as it comes.

    Raises
    ------
    InputError
        When bounds, names, budget, method, timeout or batch cannot be used.
    WorkersGone
        When the executor cannot carry out even the first evaluation.

    Examples
    --------
    >>> def bowl(x, y):
    ...     return (x - 1) ** 2 + (y + 2) ** 2
    >>> box = {"x": (-5, 5), "y": (-5, 5)}
    >>> found = camring.minimise_function(bowl, box, budget=80, method="nelder-mead")
    >>> round(found.best["x"], 2), round(found.best["y"], 2), found.feasible
    (1.0, -2.0, True)
    """
    box = _Box(variables)
    names = _names_of(constraints, box)
    if isinstance(budget, bool) or not isinstance(budget, int) or budget < 1:
        raise InputError("budget", f"is {quote(budget)}", "give a whole number from 1 up")
    if method not in WITHOUT_SLOPES:
        raise InputError("method", f"is {quote(method)}", f"choose {' or '.join(WITHOUT_SLOPES)}")
    if timeout is not None and not timeout > 0:
        raise InputError("timeout", f"is {quote(timeout)}", "give seconds above zero")
    if timeout is not None and executor is not None:
        raise InputError("timeout", "is the executor's own affair", "give camring.Workers(4, 60)")
    batch = batch_of(batch, executor)
    starts = tuple(box.located(place, design) for place, design in enumerate(given))
    strategy = strategy_named(method, Task(len(box.names), budget, starts, batch=batch))
    asking = AskTell(strategy, len(names), seed)
    history: list[Row] = []
    with ExitStack() as stack:
        if timeout is not None:
            function = stack.enter_context(closing(UserProcess(function, timeout)))
        evaluator = _Evaluator(function, box, names)
        desk = None
        if executor is not None:
            desk = stack.enter_context(closing(Desk(executor, evaluator, evaluator.lost)))
        reason = f"The budget of {budget} evaluations is spent."
        while len(history) < budget:
            point = asking.ask()
            if isinstance(point, Stop):
                reason = point.reason
                break
            ahead = asking.ahead()[: budget - len(history) - 1]
            try:
                answer = evaluator(point) if desk is None else desk.answer(point, ahead)
            except WorkersGone as error:
                if not history:
                    raise
                reason = str(error)
                break
            evaluation = asking.tell(answer.objective, answer.constraints, answer.failure)
            history.append(_row(evaluation, box.values(point), names, answer))
            watch(history[-1])
            if hopeless(asking.history):
                reason = (
                    f"The first {HOPELESS} evaluations all failed; the last: {evaluation.failure}."
                )
                break
    best = best_of(asking.history)
    return FunctionMinimum(
        None if best is None else history[best.trial],
        best is not None and best.feasible(),
        history,
        reason,
    )


class _Box:
    """Named bounds, and the unit box that the search sees."""

    def __init__(self, variables: Mapping[str, tuple[float, float]]) -> None:
        if not variables:
            raise InputError("variables", "is empty", 'give such as {"width": (0.1, 0.5)}')
        self.names = tuple(variables)
        for name, bounds in variables.items():
            where = f"variables[{quote(name)}]"
            try:
                low, high = map(float, bounds)
            except (TypeError, ValueError, OverflowError):
                raise InputError(where, "is no pair of numbers", "give (low, high)") from None
            if not (math.isfinite(low) and math.isfinite(high) and low < high):
                raise InputError(
                    where, f"is ({low:g}, {high:g})", "give finite bounds, the lower first"
                )
        self._low = np.array([float(low) for low, _ in variables.values()])
        self._high = np.array([float(high) for _, high in variables.values()])

    def values(self, point: np.ndarray) -> dict[str, float]:
        found = self._low + (self._high - self._low) * point
        found = np.clip(found, self._low, self._high)
        return dict(zip(self.names, found.tolist(), strict=True))

    def located(self, place: int, design: Mapping[str, float]) -> tuple[float, ...]:
        where = f"given[{place}]"
        if set(design) != set(self.names):
            raise InputError(where, "does not name every variable", f"give {', '.join(self.names)}")
        values = np.array([float(design[name]) for name in self.names])
        outside = ~((values >= self._low) & (values <= self._high))
        if outside.any():
            at = int(np.argmax(outside))
            raise InputError(
                f"{where}[{quote(self.names[at])}]",
                f"is {values[at]:g}, outside {self._low[at]:g} to {self._high[at]:g}",
                "widen the bounds or begin elsewhere",
            )
        return tuple(((values - self._low) / (self._high - self._low)).tolist())


@dataclass(frozen=True)
class _Answer:
    objective: float
    constraints: Sequence[float]
    failure: str | None
    extra: Mapping[str, Any]


def _names_of(constraints: Sequence[str], box: _Box) -> tuple[str, ...]:
    names = (constraints,) if isinstance(constraints, str) else tuple(constraints)
    for name in names:
        if name in (*box.names, OBJECTIVE, "trial", "phase", "failure") or names.count(name) > 1:
            raise InputError("constraints", f"has {quote(name)}, a name in use", "rename it")
    return names


@dataclass(frozen=True)
class _Evaluator:
    """Asks the function of a point, here or wherever it is sent."""

    function: Callable[..., Any]
    box: _Box
    names: tuple[str, ...]

    def __call__(self, point: np.ndarray) -> _Answer:
        try:
            return _read(self.function(**self.box.values(point)), self.names)
        except FunctionFailed as error:
            return self.lost(point, str(error))
        except InputError:
            raise
        except Exception as error:  # recorded, not fatal: one bad design must not end a search
            return self.lost(point, f"{type(error).__name__}: {error}")

    def lost(self, point: np.ndarray, reason: str) -> _Answer:
        """No answer, and why."""
        return _Answer(math.nan, [math.nan] * len(self.names), reason, {})


def _read(found: Any, names: Sequence[str]) -> _Answer:
    extra: dict[str, Any] = {}
    limits: Any
    if isinstance(found, Mapping):
        if OBJECTIVE not in found:
            raise FunctionFailed('its dictionary has no "objective"')
        objective, limits = found[OBJECTIVE], found
        extra = {str(key): found[key] for key in found if key not in (OBJECTIVE, *names)}
    elif isinstance(found, tuple) and len(found) == 2:
        objective, limits = found
    else:
        objective, limits = found, ()
    if isinstance(limits, Mapping):
        missing = [name for name in names if name not in limits]
        if missing:
            raise FunctionFailed(f"it returned no {', '.join(missing)}")
        limits = [limits[name] for name in names]
    values = np.atleast_1d(np.asarray(limits, dtype=float))
    if len(values) != len(names):
        raise FunctionFailed(f"it returned {len(values)} constraints, not {len(names)}")
    objective = _number(objective)
    for name, value in zip((OBJECTIVE, *names), (objective, *values), strict=True):
        if not math.isfinite(value):
            raise FunctionFailed(f"{name} is {value}")
    return _Answer(objective, values.tolist(), None, extra)


def _number(value: Any) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        raise FunctionFailed(f"its objective is {quote(value)}, which is no number") from None


def _row(
    evaluation: Evaluation, values: Mapping[str, float], names: Sequence[str], answer: _Answer
) -> Row:
    row: Row = {
        "trial": evaluation.trial,
        "phase": evaluation.phase,
        **values,
        OBJECTIVE: evaluation.objective,
        **dict(zip(names, evaluation.constraints.tolist(), strict=True)),
        "failure": evaluation.failure,
    }
    return {**{key: value for key, value in answer.extra.items() if key not in row}, **row}

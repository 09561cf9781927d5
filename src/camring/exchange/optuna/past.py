"""An Optuna study's trials as the history and memory that our strategies go on from.

Everything a strategy needs stands in the trials themselves: what came of each, and, as a
system attribute, which point was asked for and what the strategy remembered with it.
A study in a database therefore goes on in any process.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from optuna.trial import FrozenTrial, TrialState

from camring.exchange.optuna.box import Box
from camring.search.problem import Evaluation, Memory

ASKED = "camring:asked"
# These read their memory beside the evaluations that they asked for, and no others.
DEAF = ("nelder-mead", "cma-es", "cobyqa")


@dataclass(frozen=True, eq=False)
class Past:
    """What a strategy proposes from."""

    history: tuple[Evaluation, ...]
    memory: Memory


def note_of(box: Box, signature: str, point: np.ndarray, phase: str, memory: Memory) -> Memory:
    """What is kept with a trial that was asked for."""
    return {
        "search": signature,
        "names": list(box.names),
        "point": point.tolist(),
        "phase": phase,
        "memory": memory,
    }


def past_of(trials: Sequence[FrozenTrial], box: Box, signature: str, sign: float) -> Past:
    """History and memory from a study's trials.

    Parameters
    ----------
    signature
        Of strategy and seed: what another one remembered is no memory of this.
    sign
        -1 where the study maximises.

    A running trial counts as if it brought the mean of what is known (the constant liar
    of Ginsbourger et al., 2010), so that nobody asks for the same point twice. Trials
    that Optuna's user enqueued or added take their place before the last point that was
    asked for: a strategy looks for the answer to its question at the end.
    """
    names = _constraint_names(trials)
    history: list[_PastTrial] = []
    memory: Memory | None = None
    phase = ""
    for trial in sorted(trials, key=lambda each: each.number):
        note = _note(trial, box, signature)
        found = _evaluation(trial, note, box, names, sign)
        if found is None:
            continue
        past = _PastTrial(found, trial.state == TrialState.RUNNING)
        if note is not None:
            memory, phase = note["memory"], note["phase"]
            history.append(past)
        elif memory is None:
            history.append(past)
        elif phase not in DEAF:
            history.insert(len(history) - 1, past)
    return Past(_in_order(history, len(names)), memory or {})


@dataclass(frozen=True, eq=False)
class _PastTrial:
    evaluation: Evaluation
    running: bool


def _in_order(past: Sequence[_PastTrial], constraint_count: int) -> tuple[Evaluation, ...]:
    known = [each.evaluation for each in past if not each.running and not each.evaluation.failed]
    objective = float(np.mean([one.objective for one in known])) if known else 0.0
    limits = np.zeros(constraint_count)
    if known and constraint_count:
        limits = np.mean([one.constraints for one in known], axis=0)
    return tuple(
        replace(each.evaluation, trial=place, objective=objective, constraints=limits, failure=None)
        if each.running
        else replace(each.evaluation, trial=place)
        for place, each in enumerate(past)
    )


def _note(trial: FrozenTrial, box: Box, signature: str) -> Mapping[str, Any] | None:
    note = trial.system_attrs.get(ASKED)
    if not note or note["search"] != signature or note["names"] != list(box.names):
        return None
    return note


def _evaluation(
    trial: FrozenTrial,
    note: Mapping[str, Any] | None,
    box: Box,
    names: Sequence[str],
    sign: float,
) -> Evaluation | None:
    if trial.state == TrialState.WAITING:
        return None
    given = {name: trial.params[name] for name in box.names if name in trial.params}
    asked = None if note is None else np.array(note["point"])
    if asked is not None and given.items() <= box.values(asked).items():
        point = asked  # to the last bit
    elif len(given) == box.dimension:
        point = box.point(given)
    else:
        return None
    failure, value = _value(trial)
    limits = np.array([trial.constraints.get(name, math.nan) for name in names])
    if failure is None and not np.all(np.isfinite(limits)):
        failure = "a constraint has no value"
    phase = "given" if note is None else note["phase"]
    return Evaluation(0, point, sign * value, limits, failure=failure, phase=phase)


def _value(trial: FrozenTrial) -> tuple[str | None, float]:
    """Why there is no objective, and the objective.

    A pruned trial's is what it last reported, as Optuna's own samplers take it.
    """
    if trial.state == TrialState.RUNNING:
        return None, math.nan
    if trial.state == TrialState.COMPLETE:
        value = float(trial.values[0])
    elif trial.state == TrialState.PRUNED and trial.intermediate_values:
        value = float(trial.intermediate_values[max(trial.intermediate_values)])
    else:
        return f"the trial ended as {trial.state.name}", math.nan
    return (None, value) if math.isfinite(value) else (f"the objective is {value}", math.nan)


def _constraint_names(trials: Sequence[FrozenTrial]) -> list[str]:
    """In order of appearance, among trials that were looked at to their end."""
    found: dict[str, None] = {}
    for trial in trials:
        if trial.state in (TrialState.COMPLETE, TrialState.PRUNED):
            found.update(dict.fromkeys(trial.constraints))
    return list(found)

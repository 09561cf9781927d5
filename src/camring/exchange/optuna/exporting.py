"""A study of ours in Optuna's storage, so that its dashboard and its plots open it."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import optuna
from optuna.distributions import BaseDistribution, FloatDistribution
from optuna.exceptions import DuplicatedStudyError, StorageInternalError
from optuna.storages import BaseStorage
from optuna.study import Study as OptunaStudy
from optuna.trial import FrozenTrial, TrialState
from sqlalchemy.exc import SQLAlchemyError

from camring.evaluation.outcome import SAFETY
from camring.evaluation.record import Record
from camring.exchange.optuna.sampler import CONSTRAINTS
from camring.files.errors import InputError, quote
from camring.studies.study import Study, open_study


@dataclass(frozen=True)
class Exported:
    """What stands in the storage now: the study's name there, its trials, the best one's number."""

    name: str
    trials: int
    best: int | None


def export_to_optuna(
    folder: str | Path,
    storage: str | BaseStorage,
    *,
    name: str | None = None,
    replace: bool = False,
) -> Exported:
    """Writes every evaluation of a study as a trial into Optuna's storage.

    Parameters are the coordinates of the design space: numbers under their keys in the
    motor file, in SI, and amplitudes of the cam's modes in m. The objective is what the
    search minimised. A constraint is kept when at most 0, as the search kept it: by its
    margin of safety, 1e-4. Everything else is a user attribute.

    Parameters
    ----------
    folder
        Of the study, which may be running.
    storage
        A URL such as "sqlite:///study.db", or one of Optuna's storages.
    name
        Of the study in the storage; else the folder's.
    replace
        Whether a study of this name there is replaced.

    Raises
    ------
    InputError
        When the folder holds no study, or the storage cannot be used or has the name.

    Examples
    --------
    >>> camring.export_to_optuna("study", "sqlite:///study.db")  # doctest: +SKIP
    """
    study = open_study(folder)
    name = name or Path(folder).resolve().name
    try:
        kept = optuna.storages.get_storage(storage)
        if replace and name in optuna.get_all_study_names(kept):
            optuna.delete_study(study_name=name, storage=kept)
        made = optuna.create_study(study_name=name, storage=kept, direction="minimize")
    except DuplicatedStudyError:
        raise InputError(
            quote(name),
            "is a study in that storage already",
            "give another name, or let it be replaced with --force (`replace=True`)",
        ) from None
    except (SQLAlchemyError, StorageInternalError, ImportError, ValueError) as error:
        reason = str(error.__cause__ or error).strip().splitlines()[0]
        raise InputError(
            quote(str(storage)),
            f"cannot be used as Optuna's storage ({reason})",
            'give a URL such as "sqlite:///study.db"',
        ) from None
    try:
        _fill(made, study)
    except BaseException:
        optuna.delete_study(study_name=name, storage=kept)
        raise
    best = study.best
    return Exported(name, len(study.records), None if best is None else best.trial)


def _fill(made: OptunaStudy, study: Study) -> None:
    names = study.given.goal.constraints.names()
    for key, value in {
        "camring": study.facts.get("camring", ""),
        "motor file": study.facts.get("given_name", str(study.given.path)),
        "method": study.facts.get("method", ""),
        "seed": study.facts.get("seed", ""),
        "stopped": study.stopped,
        "units": "SI; amplitudes of cam modes in m",
        "constraints": list(names),
    }.items():
        made.set_user_attr(key, value)
    box = _bounds(study)
    # A design nearer to a limit than the search allows is not its best one.
    safety = SAFETY if any(record.within(SAFETY) for record in study.records) else 0.0
    made.add_trials([_trial(record, box, names, safety) for record in study.records])


def _bounds(study: Study) -> dict[str, tuple[float, float]]:
    space, system = study.given.design_space, study.given.system
    if space is None:
        return {}
    ends = [space.describe(system, np.full(space.dimension, end)) for end in (0.0, 1.0)]
    return {key: (ends[0][key], ends[1][key]) for key in ends[0]}


def _trial(
    record: Record,
    box: Mapping[str, tuple[float, float]],
    names: Sequence[str],
    safety: float,
) -> FrozenTrial:
    outcome = record.outcome
    parameters: dict[str, Any] = {}
    distributions: dict[str, BaseDistribution] = {}
    for unit, (key, (first, last)) in zip(record.point.tolist(), box.items(), strict=True):
        low, high = min(first, last), max(first, last)
        parameters[key] = min(max(first + unit * (last - first), low), high)
        distributions[key] = FloatDistribution(low, high)
    limits = [outcome.constraints.get(name, math.nan) for name in names]
    attributes: dict[str, Any] = {"phase": record.phase, "seconds": record.seconds}
    if outcome.failure:
        attributes["failure"] = outcome.failure
    numbers = {"objective without penalty": outcome.physical_objective}
    numbers |= {f"limit {name}": value for name, value in zip(names, limits, strict=True)}
    for place, results in enumerate(outcome.results, start=1):
        numbers |= {f"{key}, point {place}": value for key, value in results.items()}
    # The dashboard's JSON has no word for what is not a number.
    attributes |= {key: value for key, value in numbers.items() if math.isfinite(value)}
    system_attributes = {} if record.failed else {CONSTRAINTS: [limit + safety for limit in limits]}
    began = datetime.fromtimestamp(record.started)
    return FrozenTrial(
        number=-1,
        trial_id=-1,
        state=TrialState.FAIL if record.failed else TrialState.COMPLETE,
        value=None if record.failed else outcome.objective,
        datetime_start=began,
        datetime_complete=began + timedelta(seconds=record.seconds),
        params=parameters,
        distributions=distributions,
        user_attrs=attributes,
        system_attrs=system_attributes,
        intermediate_values={},
    )

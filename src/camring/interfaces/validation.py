"""What was found, looked at again: finer, and by another solver that shares no formula.

A study claims three things: its best design keeps every limit, it is better than
the given motor, and its results are what they are said to be. Each claim is
restated by both other eyes; only if all hold is the design called validated.
"""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import jax.numpy as jnp

from camring.interfaces.beside import scale_of
from camring.interfaces.compiled import assess
from camring.interfaces.config import MotorFile
from camring.interfaces.evaluator import outcome_of
from camring.interfaces.json_numbers import finite
from camring.interfaces.own_command import CommandFailed, OwnCommand
from camring.interfaces.own_evaluator import ask_about, names_given, overlaid
from camring.interfaces.record import Outcome, failed
from camring.interfaces.report.quantities import QUANTITIES
from camring.metrics.independent import NotStarShapedError, OrbitError, independent_results
from camring.metrics.summary import Metrics
from camring.objective.objective import judge
from camring.physics.resolution import Resolution

FINER, INDEPENDENT, SEARCH = "finer", "independent", "search"
EYES = {FINER: "at finer resolution", INDEPENDENT: "by SciPy's stiff solver"}
GIVEN, BEST = "given", "best"

AGREEMENT = 1e-4  # of a result, or of what it is small beside
SOLVER_TOLERANCE = 1e-9  # of the independent solver; its results are good to about 1e-7

RIPPLES = {
    "torque_ripple",
    "torque_ripple_true_rms",
    "torque_ripple_peak_to_peak",
    "flow_ripple",
    "flow_ripple_true_rms",
    "pressure_ripple",
    "pressure_ripple_true_rms",
}
RIPPLE_SCALE = 0.01  # a ripple below one per cent is judged as if it were one per cent


@dataclass(frozen=True)
class Check:
    """One claim, and what another eye says of it."""

    name: str
    passed: bool
    detail: str


@dataclass(frozen=True)
class Validation:
    """Both designs through all eyes, and whether every claim holds.

    Attributes
    ----------
    views
        `views[design][eye]`: objective, constraints and results of the given and
        the best design, by the search and by the two other eyes.
    """

    trial: int
    validated: bool
    sentence: str
    checks: Sequence[Check]
    views: Mapping[str, Mapping[str, Mapping[str, Any]]]

    def to_json(self) -> str:
        return json.dumps(finite(asdict(self)), indent=1, allow_nan=False) + "\n"

    @classmethod
    def from_json(cls, text: str) -> "Validation":
        document = json.loads(text)
        document["checks"] = [Check(**check) for check in document["checks"]]
        return cls(**document)


def look_again(motor_file: MotorFile) -> dict[str, Outcome]:
    """The motor of a file through the two other eyes."""
    system, goal = motor_file.system, motor_file.goal
    finer = outcome_of(assess(system, goal, Resolution.fine()))
    if finer.failure:
        return {FINER: finer, INDEPENDENT: failed("not looked at, as the finer one failed")}
    try:
        results = [
            independent_results(system.motor, system.fluid, point, goal.harmonics, SOLVER_TOLERANCE)
            for point in system.operating_points
        ]
    except (OrbitError, NotStarShapedError) as error:
        return {FINER: finer, INDEPENDENT: failed(str(error))}
    # What the other solver does not compute (the lift's ends) is geometry alone.
    whole = [{**dict(a), **b} for a, b in zip(finer.results, results, strict=True)]
    metrics = tuple(
        Metrics(**{name: jnp.asarray(value) for name, value in each.items()}) for each in whole
    )
    sound = jnp.zeros(len(metrics), int)
    independent = outcome_of(judge(system, goal, metrics, sound))
    return {FINER: finer, INDEPENDENT: independent}


def validate(
    trial: int,
    given: MotorFile,
    best: MotorFile,
    claimed: Mapping[str, Outcome],
    command: OwnCommand | None = None,
) -> Validation:
    """Every claimed gain and every constraint margin, restated.

    Parameters
    ----------
    given, best
        The two motors, the best one as it stands in the file that the user gets.
    claimed
        What the search said of each, under `GIVEN` and `BEST`.
    command
        The user's own program, where one judged the designs: it is asked again, and its
        results stand before those of the other eyes, which cannot know better.
    """
    views, names = {}, list[str]()
    for name, file in ((GIVEN, given), (BEST, best)):
        seen = look_again(file)
        if command is not None:
            seen, names = _with_command(file, seen, command)
        views[name] = {SEARCH: claimed[name], **seen}
    checks = [check for eye in EYES for check in _checks(views, eye)]
    broken = [check for check in checks if not check.passed]
    sentence = (
        f"Validated: every limit and every gain holds {_by_what(command, names)}."
        if not broken
        else f"Not validated: {broken[0].name} does not hold ({broken[0].detail})."
    )
    return Validation(
        trial=trial,
        validated=not broken,
        sentence=sentence,
        checks=checks,
        views={
            name: {eye: _view(outcome) for eye, outcome in eyes.items()}
            for name, eyes in views.items()
        },
    )


def _with_command(
    file: MotorFile, seen: Mapping[str, Outcome], command: OwnCommand
) -> tuple[dict[str, Outcome], list[str]]:
    """Each eye with the program's results, and which these are."""
    try:
        given = ask_about(command, file)
    except CommandFailed as error:
        return {eye: failed(f"`{command}`: {error}") for eye in seen}, []
    overlaid_by_eye = {
        eye: overlaid(file.system, file.goal, outcome, given) for eye, outcome in seen.items()
    }
    return overlaid_by_eye, names_given(given)


def _by_what(command: OwnCommand | None, names: Sequence[str]) -> str:
    eyes = "at finer resolution and by SciPy's stiff solver"
    if command is None:
        return eyes
    if not names:
        return f"{eyes}; `{command}` gave no result of its own"
    return (
        f"with {', '.join(names)} from `{command}`, asked again and checked by nothing else, and "
        f"all other results {eyes}"
    )


def _checks(views: Mapping[str, Mapping[str, Outcome]], eye: str) -> list[Check]:
    given, best = views[GIVEN][eye], views[BEST][eye]
    by = EYES[eye]
    for name, outcome in ((GIVEN, given), (BEST, best)):
        if outcome.failure:
            return [Check(f"the {name} motor {by}", False, outcome.failure)]
    checks = [
        Check(f"{name} {by}", value <= 0, f"margin {-value:.4g}")
        for name, value in best.constraints.items()
    ]
    checks.append(_gain(views, eye))
    for name in (GIVEN, BEST):
        if views[name][SEARCH].failure and not views[name][SEARCH].results:
            reason = str(views[name][SEARCH].failure)
            checks.append(Check(f"the {name} motor in the search", False, reason))
            continue
        checks.append(
            _agreement(views[name][SEARCH], views[name][eye], f"of the {name} motor {by}")
        )
    return checks


def _gain(views: Mapping[str, Mapping[str, Outcome]], eye: str) -> Check:
    """The gain in objective, within one per cent of what was claimed or above."""
    seen, claimed = (
        views[GIVEN][which].physical_objective - views[BEST][which].physical_objective
        for which in (eye, SEARCH)
    )
    passed = seen >= claimed - 0.01 * abs(claimed) - 1e-9 if math.isfinite(claimed) else True
    return Check(
        f"gain in objective {EYES[eye]}", passed, f"{seen:.6g}, claimed were {claimed:.6g}"
    )


def _agreement(claimed: Outcome, seen: Outcome, whose: str) -> Check:
    """The largest difference of any result, relative to it or to what it is small beside."""
    largest, where = 0.0, "nothing"
    for before, after in zip(claimed.results, seen.results, strict=True):
        for name in sorted(before.keys() & after.keys() & QUANTITIES.keys()):
            scale = max(scale_of(name, after), RIPPLE_SCALE if name in RIPPLES else 1e-300)
            difference = abs(before[name] - after[name]) / scale
            if math.isnan(difference):
                difference = math.inf
            if difference > largest:
                largest, where = difference, name
    return Check(
        f"agreement {whose}", largest <= AGREEMENT, f"largest difference {largest:.1e}, in {where}"
    )


def _view(outcome: Outcome) -> dict[str, Any]:
    return {
        "objective": outcome.objective,
        "physical_objective": outcome.physical_objective,
        "constraints": dict(outcome.constraints),
        "results": [dict(each) for each in outcome.results],
        "failure": outcome.failure,
    }

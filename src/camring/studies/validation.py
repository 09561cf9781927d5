"""What was found, looked at again: finer, and by another solver that shares no formula.

A study claims three things: its best design keeps every limit, it is better than
the given motor, and its results are what they are said to be. Each claim is
restated by both other eyes; only if all hold is the design called validated.
"""

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np

from camring.evaluation.assessed import outcome_of
from camring.evaluation.outcome import Outcome, failed
from camring.evaluation.user_programs.command import CommandFailed, UserCommand
from camring.evaluation.user_programs.evaluator import ask_about, names_given, overlaid
from camring.files.json_numbers import finite
from camring.files.motor import MotorFile
from camring.files.quantities import QUANTITIES
from camring.metrics.result_scale import RIPPLES, scale_of
from camring.metrics.summary import Metrics
from camring.numerics.quantity import real
from camring.physics.resolution import Resolution
from camring.programs.compiled import assess, assess_metrics
from camring.reference import NoSecondSolver, NotStarShapedError, OrbitError, machine_of
from camring.studies.envelope_check import EnvelopeCheck
from camring.studies.envelope_words import document_of, range_in_words
from camring.studies.reference_processes import SecondSolver
from camring.studies.reference_results import GEOMETRY_ALONE, all_results

FINER, INDEPENDENT, SEARCH = "finer", "independent", "search"
EYES = {FINER: "at finer resolution", INDEPENDENT: "by SciPy's stiff solver"}
GIVEN, BEST = "given", "best"

AGREEMENT = 1e-4  # of a result, or of what it is small beside
SOLVER_TOLERANCE = 1e-7  # of the independent solver; its results are good to about as much

NO_SOLVER = "no second solver for "
"""How the failure of an eye begins that cannot look at a law of the user's own."""

RIPPLE_SCALE = 0.01  # a ripple below one per cent is compared as if it were one per cent


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
    envelope
        Both motors at every point of a fine grid of the file's envelope, or where the file
        has none from a tenth to all of its pressure (`envelope_words.document_of`).
    """

    trial: int
    validated: bool
    sentence: str
    checks: Sequence[Check]
    views: Mapping[str, Mapping[str, Mapping[str, Any]]]
    envelope: Mapping[str, Any] = field(default_factory=dict)

    @property
    def warning(self) -> str:
        """What the best design does outside its operating points, where nothing was asked."""
        return str(self.envelope.get("warning", ""))

    def to_json(self) -> str:
        return json.dumps(finite(asdict(self)), indent=1, allow_nan=False) + "\n"

    @classmethod
    def from_json(cls, text: str) -> "Validation":
        document = json.loads(text)
        document["checks"] = [Check(**check) for check in document["checks"]]
        return cls(**document)


def without_second_solver(motor_file: MotorFile) -> str | None:
    """Why the second solver cannot look at a motor, "no second solver for ..."; else None."""
    system = motor_file.system
    try:
        for point in system.operating_points:
            machine_of(system.motor, system.fluid, point)
    except NoSecondSolver as missing:
        return str(missing)
    except OrbitError:  # such a motor is refused one by one, with its own reason
        return None
    return None


def begin_again(motor_file: MotorFile, second: SecondSolver) -> Callable[[], dict[str, Outcome]]:
    """The motor of a file through the two other eyes; call what comes back for what they saw.

    Meanwhile the second solver works in its own process.
    """
    system, goal = motor_file.system, motor_file.goal
    finer = outcome_of(assess(system, goal, Resolution.fine()))
    if finer.failure:
        unseen = {FINER: finer, INDEPENDENT: failed("not looked at, as the finer one failed")}
        return lambda: unseen
    pending = [
        second.begin(system.motor, system.fluid, point, goal.harmonics, SOLVER_TOLERANCE)
        for point in system.operating_points
    ]

    def seen() -> dict[str, Outcome]:
        try:
            results = [each.result() for each in pending]
        except (NoSecondSolver, OrbitError, NotStarShapedError) as error:
            return {FINER: finer, INDEPENDENT: failed(str(error))}
        metrics = tuple(
            Metrics(**{name: real(each) for name, each in all_results(a, b).items()})
            for a, b in zip(finer.results, results, strict=True)
        )
        known = [{*each, *GEOMETRY_ALONE} for each in results]
        independent = outcome_of(assess_metrics(system, goal, metrics))
        return {FINER: finer, INDEPENDENT: independent.with_results_in(known)}

    return seen


def solve_again(motor_file: MotorFile, second: SecondSolver) -> dict[str, Outcome]:
    """The motor of a file through the two other eyes."""
    return begin_again(motor_file, second)()


def validate(
    trial: int,
    given: MotorFile,
    best: MotorFile,
    claimed: Mapping[str, Outcome],
    again: Mapping[str, Mapping[str, Outcome]],
    command: UserCommand | None = None,
    envelope: EnvelopeCheck | None = None,
) -> Validation:
    """Every claimed gain and every constraint margin, restated.

    Parameters
    ----------
    given, best
        The two motors, the best one as it stands in the file that the user gets.
    claimed
        What the search said of each, under `GIVEN` and `BEST`.
    again
        What `solve_again` says of each.
    command
        The user's own program, where one evaluated the designs: it is asked again, and its
        results stand before those of the other eyes, which cannot know better.
    envelope
        Both motors over the file's envelope; one that the file does not ask for decides
        nothing, but is kept with the rest.
    """
    views, names = {}, list[str]()
    for name, file in ((GIVEN, given), (BEST, best)):
        seen = dict(again[name])
        if command is not None:
            seen, names = _with_command(file, seen, command)
        views[name] = {SEARCH: claimed[name], **_with_envelope_of(claimed[name], seen)}
    missing = _missing_solver(views)
    eyes = [FINER] if missing else list(EYES)
    checks = [check for eye in eyes for check in _checks(views, eye)]
    if missing:
        checks.append(Check("a second solver", False, missing))
    if envelope is not None and envelope.asked:
        checks += envelope_checks(envelope)
    broken = [check for check in checks if not check.passed]
    sentence = (
        f"Validated: every limit and every gain holds {_by_what(command, names)}."
        f"{_where_too(envelope)}"
    )
    if missing and len(broken) == 1:
        sentence = (
            f"Not validated: {missing}. Every limit and every gain holds {EYES[FINER]}, "
            "which no other solver confirms."
        )
    elif broken:
        sentence = f"Not validated: {broken[0].name} does not hold ({broken[0].detail})."
    return Validation(
        trial=trial,
        validated=not broken,
        sentence=sentence,
        checks=checks,
        views={
            name: {eye: _view(outcome) for eye, outcome in eyes.items()}
            for name, eyes in views.items()
        },
        envelope={} if envelope is None else document_of(envelope),
    )


def _with_envelope_of(claimed: Outcome, seen: Mapping[str, Outcome]) -> dict[str, Outcome]:
    """Each eye's objective with the share that the envelope has in the search's.

    Its limits are looked at on a grid of their own, at final resolution.
    """
    if claimed.envelope is None:
        return dict(seen)
    share = claimed.envelope.share
    return {
        eye: replace(
            outcome,
            objective=outcome.objective + share,
            physical_objective=outcome.physical_objective + share,
        )
        for eye, outcome in seen.items()
    }


def envelope_checks(found: EnvelopeCheck) -> list[Check]:
    """Every limit at every point of the fine grid, and the second solver's word."""
    checks = []
    grid, limits = found.grid, found.limits[-1]
    for name, values in limits.items():
        place = int(np.argmax(np.nan_to_num(values, nan=np.inf)))
        detail = f"margin {-values[place]:.4g} at {grid.text(place)}, the least of {grid.count}"
        checks.append(Check(f"{name} in the envelope", bool(np.all(values <= 0)), detail))
    if np.any(found.motors[-1].faults):
        count = int(np.count_nonzero(found.motors[-1].faults))
        checks.append(Check("results in the envelope", False, f"none at {count} points"))
    by = f"the envelope {EYES[INDEPENDENT]}"
    if found.failure:
        return [*checks, Check(by, False, found.failure)]
    for place, (name, g) in found.second.items():
        checks.append(
            Check(f"{by} at {grid.text(place)}", g <= 0, f"least margin {-g:.4g}, of {name}")
        )
    return checks


def _where_too(found: EnvelopeCheck | None) -> str:
    if found is None or not found.asked:
        return ""
    return (
        f" In its envelope, {range_in_words(found)}, every limit holds at {found.grid.count} "
        f"points, at {len(found.second)} of them by SciPy's stiff solver too."
    )


def _missing_solver(views: Mapping[str, Mapping[str, Outcome]]) -> str | None:
    """Why no second solver can look at one of the designs; None where it looked."""
    said = [views[name][INDEPENDENT].failure or "" for name in (GIVEN, BEST)]
    return next((each for each in said if each.startswith(NO_SOLVER)), None)


def _with_command(
    file: MotorFile, seen: Mapping[str, Outcome], command: UserCommand
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


def _by_what(command: UserCommand | None, names: Sequence[str]) -> str:
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

"""The compromises that a motor file allows between two or three results, each looked at again."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from jaxtyping import Float

from camring.evaluation.answers import Remember, forget
from camring.evaluation.assessed import outcome_of
from camring.evaluation.batch import evaluate_many
from camring.evaluation.outcome import Outcome
from camring.evaluation.strategy import first_points
from camring.files.errors import CamringError, InputError, quote
from camring.files.motor import MotorFile, parse_motor_file
from camring.files.motor.keys import nearest
from camring.physics.resolution import Resolution
from camring.programs.compiled import assess
from camring.search.pareto.dominance import box_of, evenly_spread, hypervolume, non_dominated
from camring.search.pareto.front import Front, FrontProblem, trace_front
from camring.search.sampling import generator, sobol
from camring.studies.envelope_check import check_envelope
from camring.studies.objectives import SENSES, Traded
from camring.studies.reference_processes import SecondSolver
from camring.studies.validation import INDEPENDENT, begin_again, without_second_solver

Point: TypeAlias = Float[np.ndarray, " dimension"]
Say: TypeAlias = Callable[[str], None]

FEWEST, MOST = 2, 3
SCREENED = 4096
STARTS = 12
FINER_AGREEMENT = 1e-3  # of a result, relative, between search and finer resolution
INDEPENDENT_AGREEMENT = 1e-3
SPARE = 1.2  # designs looked at again for each one wanted
MARGIN = 0.1  # of the front's width beyond its worst corner: where volume is counted from


class NoFront(CamringError):
    """No design keeps every limit."""

    exit_code = 3


@dataclass(frozen=True, eq=False)
class Compromise:
    """One design of a front, with its results at finer resolution."""

    point: Point
    text: str
    values: Float[np.ndarray, " result"]
    outcome: Outcome


@dataclass(frozen=True, eq=False)
class TradeOff:
    """A front.

    Attributes
    ----------
    given
        The results traded of the motor as it stands, SI.
    compromises
        Sorted by the first result, best first.
    dropped
        Designs left out because finer resolution did not confirm them, and why.
    independent
        Largest difference of a traded result to SciPy's solver in the sample, relative.
    sample
        How many designs that solver has looked at.
    volume
        Share of the front's own box, a tenth beyond its worst corner, that it dominates.
    """

    file: MotorFile
    names: tuple[str, ...]
    given: Float[np.ndarray, " result"]
    given_keeps_limits: bool
    compromises: Sequence[Compromise]
    dropped: Sequence[str]
    independent: float
    sample: int
    volume: float
    evaluations: int
    screened: int
    search_seconds: float
    check_seconds: float
    unconfirmed: str = ""
    """Why that solver had nothing to say of one of the sample; empty where it had."""

    @property
    def values(self) -> Float[np.ndarray, "compromise result"]:
        return np.array([each.values for each in self.compromises])


def traded_results(text: str) -> tuple[str, ...]:
    """Result names from `torque_ripple,efficiency`.

    Raises
    ------
    InputError
        For a name that cannot be traded, with its nearest neighbour; for too few or too many.
    """
    names = tuple(dict.fromkeys(text.replace(",", " ").split()))
    for name in names:
        if name not in SENSES:
            close = nearest(name, list(SENSES))
            raise InputError(
                f"--of {quote(name)}",
                "is no result that can be traded",
                f"you probably meant {close}" if close else "give some of " + ", ".join(SENSES),
            )
    if not FEWEST <= len(names) <= MOST:
        raise InputError("--of", f"names {len(names)} results", f"name {FEWEST} or {MOST}")
    return names


def trade_off(
    file: MotorFile,
    names: Sequence[str],
    *,
    points: int = 50,
    screened: int = SCREENED,
    sample: int = 3,
    say: Say = lambda sentence: None,
    remember: Remember = forget,
) -> TradeOff:
    """Trace the front of some results, and look at each of its designs again.

    Parameters
    ----------
    points
        Designs wanted; fewer come back where the front is shorter than that.
    screened
        Designs evaluated side by side beforehand, for starts.
    sample
        Designs that SciPy's solver looks at.
    remember
        Keeps what descents ask for, for a run that goes on after this one.

    Raises
    ------
    InputError
        When the file has no design space.
    NoFront
        When no design keeps every limit.
    """
    model = Traded(file, tuple(names))
    began = time.monotonic()
    missing = without_second_solver(file)
    if missing:
        say(f"No other solver will confirm the front: {missing}.")
    say(f"Screening {screened} designs for starts.")
    starts = _starts(model, screened)
    say(f"Tracing the front from {len(starts)} starts.")
    problem = FrontProblem(remember("values", model.values), remember("slopes", model.slopes))
    front = trace_front(problem, starts, points, _counted(say))
    if not front.points:
        raise NoFront(
            f"No design of {file.path} keeps every limit: none of {screened} screened ones nor of "
            f"{front.evaluations} in the descents; widen [design_space] or relax a limit."
        )
    searched = time.monotonic()
    say("Looking again at finer resolution and with SciPy's stiff solver.")
    kept, dropped = _solved_again(model, front, points)
    worst, looked, unconfirmed = _independent(model, kept, sample)
    outcome = outcome_of(assess(file.system, file.goal, Resolution.fine()))
    return TradeOff(
        file=file,
        names=model.names,
        given=model.summed(outcome.results),
        given_keeps_limits=not (outcome.failure or _broken(file, file, outcome)),
        compromises=kept,
        dropped=dropped,
        independent=worst,
        sample=looked,
        volume=_volume(np.array([each.values for each in kept]) * -model.senses),
        evaluations=front.evaluations,
        screened=screened,
        search_seconds=searched - began,
        check_seconds=time.monotonic() - searched,
        unconfirmed=unconfirmed,
    )


def _counted(say: Say) -> Callable[[int], None]:
    """Says how many compromises have been found, whenever there are ten more."""
    reported = 0

    def found(count: int) -> None:
        nonlocal reported
        if count >= reported + 10:
            reported = count
            say(f"{count} compromises found.")

    return found


def _volume(losses: Float[np.ndarray, "compromise result"]) -> float:
    if len(losses) < FEWEST:
        return 0.0
    lowest, width = box_of(losses)
    reference = np.full(losses.shape[1], 1 + MARGIN)
    return hypervolume((losses - lowest) / width, reference) / float(np.prod(reference))


def _starts(model: Traded, screened: int) -> list[Point]:
    """The given design, theory's, the best screened in each result, and a spread between."""
    first = first_points(model.file, theory=True)
    if not screened:
        return [*first, *sobol(STARTS, model.space.dimension, generator(0, 0))]
    points = sobol(screened, model.space.dimension, generator(0, 0))
    found = evaluate_many(model.space, model.file.system, model.file.goal, points)
    sound = np.all(np.asarray(found.faults) == 0, axis=0)
    broken = np.sum(np.maximum(np.stack(list(found.constraints.values())), 0), axis=0)
    broken = np.where(sound, broken, np.inf)
    usable = np.flatnonzero(broken == 0)
    if len(usable) < STARTS:
        usable = np.argsort(broken)[:STARTS]
    losses = np.array(
        [
            -model.senses
            * model.summed([{n: getattr(m, n)[place] for n in model.names} for m in found.metrics])
            for place in usable
        ]
    )
    best = np.flatnonzero(non_dominated(losses))
    lowest, width = box_of(losses[best])
    chosen = best[evenly_spread((losses[best] - lowest) / width, STARTS)]
    return [*first, *points[usable[chosen]]]


def _broken(given: MotorFile, motor: MotorFile, outcome: Outcome) -> list[str]:
    """Limits that a design breaks, at its operating points or in the given file's envelope.

    As they stand: a search draws them tighter, which the given motor need not keep.
    """
    broken = [name for name, value in outcome.constraints.items() if value > 0]
    if given.envelope is None:
        return broken
    found = check_envelope(given, motor)
    if np.any(found.motors[-1].faults):
        return [*broken, "its envelope: it has no results there"]
    limits = found.limits[-1]
    return broken + [f"{name} in its envelope" for name, g in limits.items() if not np.all(g <= 0)]


def _solved_again(model: Traded, front: Front, count: int) -> tuple[list[Compromise], list[str]]:
    """Each design as its motor file says it, at finer resolution; beaten ones left out."""
    kept, dropped = [], []
    searched_best = np.array(front.best())
    losses = np.array(front.objectives)[searched_best]
    lowest, width = box_of(losses)
    for place in searched_best[evenly_spread((losses - lowest) / width, round(SPARE * count))]:
        point = front.points[place]
        text = model.file.with_design(point.tolist(), "camring pareto")
        motor = parse_motor_file(text, model.file.path)
        outcome = outcome_of(assess(motor.system, motor.goal, Resolution.fine()))
        values = model.summed(outcome.results)
        searched = front.objectives[place] * -model.senses
        broken = _broken(model.file, motor, outcome)
        if outcome.failure or broken:
            dropped.append(outcome.failure or f"breaks {broken[0]}")
        elif np.any(np.abs(values - searched) > FINER_AGREEMENT * np.abs(values)):
            dropped.append("results differ from those of the search")
        else:
            kept.append(Compromise(point, text, values, outcome))
    if not kept:
        raise NoFront(f"No design of the front holds at finer resolution: {dropped[0]}.")
    losses = np.array([each.values for each in kept]) * -model.senses
    best = np.flatnonzero(non_dominated(losses))
    lowest, width = box_of(losses[best])
    chosen = best[evenly_spread((losses[best] - lowest) / width, count)]
    chosen = chosen[np.argsort(losses[chosen, 0])]
    return [kept[place] for place in chosen], dropped


def _independent(model: Traded, kept: Sequence[Compromise], sample: int) -> tuple[float, int, str]:
    """Largest relative difference to SciPy's solver over designs spread along the front.

    With the number of designs, and why it is infinite where that solver has no answer.
    """
    places = np.unique(np.linspace(0, len(kept) - 1, min(sample, len(kept))).round().astype(int))
    worst = 0.0
    with SecondSolver() as second:
        pending = {
            place: begin_again(parse_motor_file(kept[place].text, model.file.path), second)
            for place in places
        }
        for place, again in pending.items():
            seen = again()[INDEPENDENT]
            if seen.failure:
                return float("inf"), len(places), seen.failure
            values = kept[place].values
            difference = np.abs(model.summed(seen.results) - values) / np.abs(values)
            worst = max(worst, float(np.max(difference)))
    return worst, len(places), ""

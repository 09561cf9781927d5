"""A design that stays good when it is built: descents of a statistic over many built motors.

The nominal optimum is found first, as `camring optimise` finds it, and is the first
start of the robust descents. Both, and the given motor, are then built anew many more
times with other chances than the search has seen.
"""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from camring.evaluation.answers import Remember, forget, remembered_problem
from camring.evaluation.built_motors import Scatter, built, tolerances_of
from camring.evaluation.evaluator import MotorEvaluator
from camring.evaluation.outcome import SAFETY
from camring.evaluation.strategy import first_points
from camring.files.errors import CamringError
from camring.files.motor import MotorFile, missing_design_space
from camring.search.descent.gradient import GradientSearch
from camring.search.minimise import SearchResult, minimise
from camring.search.problem import Evaluation, Outputs, Points, Problem
from camring.search.scatter.distributions import deviates
from camring.search.scatter.robust import RobustFunction
from camring.search.scatter.statistic import Statistic
from camring.studies.built_gradients import BuiltDesigns
from camring.studies.coordinator import as_seen_by_search, evaluate_or_fail
from camring.studies.envelope_gradients import DesignsInEnvelope, EnvelopedFunction

GIVEN, NOMINAL, ROBUST = "given", "nominal optimum", "robust"
SEARCH_SAMPLES, CHECK_SAMPLES = 64, 1024
FRESH = 1_000_003  # seeds of searches and checks lie so far apart

Point = Float[np.ndarray, " dimension"]
Say = Callable[[str], None]


class NoRobustDesign(CamringError):
    """No design keeps the limits."""

    exit_code = 3


@dataclass(frozen=True, eq=False)
class RobustDesign:
    """Three designs side by side.

    Attributes
    ----------
    points
        Of each design, in the unit box.
    scatters
        Of each design at fresh samples.
    evaluations
        Of the nominal and the robust search, the latter of `search_samples` motors each.
    promised
        The statistic of the objective that the robust search saw at its end, without what
        the envelope adds as drawn: no built motor is simulated there.
    """

    file: MotorFile
    statistic: Statistic
    of_limits: Statistic
    points: Mapping[str, Point]
    scatters: Mapping[str, Scatter]
    promised: float
    search_samples: int
    evaluations: tuple[int, int]
    seconds: tuple[float, float]
    stopped: str

    def text_of(self, name: str) -> str:
        """The motor file of a design."""
        return self.file.with_design(self.points[name].tolist(), "camring robust")


def robust_design(
    file: MotorFile,
    statistic: Statistic,
    of_limits: Statistic,
    *,
    samples: int = SEARCH_SAMPLES,
    checked: int = CHECK_SAMPLES,
    budget: int | None = None,
    seed: int = 0,
    say: Say = lambda sentence: None,
    remember: Remember = forget,
) -> RobustDesign:
    """Finds the nominal optimum and the robust one, and builds both anew.

    Parameters
    ----------
    statistic, of_limits
        Of the objective, to minimise; of every limit, to keep.
    samples
        Motors that every design of the search is built as.
    checked
        Motors of the check.
    budget
        Designs of each search; that of `[search]` unless given.
    remember
        Keeps what both searches ask for, for a run that goes on after this one.

    Raises
    ------
    InputError
        Without `[design_space]` or `[tolerances]`.
    NoRobustDesign
        When no design keeps the limits.
    """
    if file.design_space is None:
        raise missing_design_space(file.path)
    tolerances = tolerances_of(file)
    budget = budget or file.search.budget
    space, first = file.design_space, first_points(file, theory=True)
    began = time.monotonic()
    say("Looking for the nominal optimum.")
    nominal = _nominal(file, first, budget, seed, remember)
    if nominal.best is None or not nominal.best.feasible():
        raise NoRobustDesign(
            f"No design of {file.path} keeps every limit as drawn; see `camring optimise`."
        )
    between = time.monotonic()
    say(f"Looking for the robust design, {samples} motors of each.")
    designs = BuiltDesigns(file, deviates(tolerances.kinds, samples, seed))
    scattering = RobustFunction(designs.scattered, designs.slopes, statistic, of_limits, SAFETY)
    robust: RobustFunction | EnvelopedFunction = scattering
    inside = None
    if file.envelope is not None:
        # As drawn: every sample at every point would cost a hundred times as much.
        inside = DesignsInEnvelope(file)
        robust = EnvelopedFunction(scattering, inside)
    given = tuple(tuple(map(float, each)) for each in (nominal.best.point, *first))
    strategy = GradientSearch(space.dimension, remember("robust slopes", robust.slopes), given)
    limits = len(file.goal.constraints.names())
    found = minimise(
        remembered_problem(remember, "robust", robust.problem(space.dimension, limits)),
        strategy,
        budget,
        seed,
        on_evaluation=lambda evaluation, _: _tell(evaluation, say),
    )
    if found.best is None or not found.best.feasible():
        raise NoRobustDesign(_closest(file, found, of_limits))
    ended = time.monotonic()
    say(f"Building each design {checked} times with other chances.")
    points = {
        GIVEN: space.locate(file.system),
        NOMINAL: nominal.best.point,
        ROBUST: found.best.point,
    }
    return RobustDesign(
        file=file,
        statistic=statistic,
        of_limits=of_limits,
        points=points,
        scatters={
            name: built(file, checked, seed + FRESH, space, at) for name, at in points.items()
        },
        promised=found.best.objective
        - (0.0 if inside is None else inside.ripple_term(found.best.point)),
        search_samples=samples,
        evaluations=(len(nominal.history), len(found.history)),
        seconds=(between - began, ended - between),
        stopped=found.stop_reason,
    )


def _nominal(
    file: MotorFile,
    first: Float[np.ndarray, "points dimension"],
    budget: int,
    seed: int,
    remember: Remember,
) -> SearchResult:
    """As `camring optimise` does, without a folder."""
    evaluator = MotorEvaluator(file.text)
    names = evaluator.names_by_point

    def evaluate(points: Points) -> list[Outputs]:
        outcome = evaluate_or_fail(evaluator, names, points[0])
        return [as_seen_by_search(outcome, names)]

    given = tuple(tuple(map(float, each)) for each in first)
    dimension = first.shape[1]
    strategy = GradientSearch(dimension, remember("nominal slopes", evaluator.slopes), given)
    problem = Problem(dimension, len(names), evaluate)
    return minimise(remembered_problem(remember, "nominal", problem), strategy, budget, seed)


def _tell(evaluation: Evaluation, say: Say) -> None:
    if evaluation.trial % 20 == 19:
        say(f"{evaluation.trial + 1} designs looked at.")


def _closest(file: MotorFile, found: SearchResult, of_limits: Statistic) -> str:
    if found.best is None:
        return f"No design could be simulated with every tolerance: {found.stop_reason}"
    names = file.goal.constraints.names()
    worst = int(np.argmax(found.best.constraints))
    name = names[worst] if worst < len(names) else "a limit in its envelope"
    return (
        f"No design keeps every limit at its {of_limits}; the closest breaks {name} by "
        f"{found.best.constraints[worst]:.3g} of its scale: narrow the tolerances, relax the "
        "limit, or ask for less."
    )


__all__ = ["NoRobustDesign", "RobustDesign", "robust_design"]

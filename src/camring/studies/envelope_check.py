"""Whether a motor keeps its limits everywhere in an envelope: finer, and by another solver.

A file with an `[envelope]` is held to it. One without is looked at all the same, from a
tenth to all of its pressure, so that a design which works at its operating points only is
never handed over without a word.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from concurrent.futures import Future
from dataclasses import dataclass, replace

import jax
import numpy as np
from jaxtyping import Bool, Float

from camring.evaluation.envelope_batch import AtPoints, at_points
from camring.evaluation.envelope_outcome import EnvelopeGoal
from camring.files.motor import MotorFile
from camring.metrics.summary import Metrics
from camring.numerics.quantity import real
from camring.objective.envelope import names_against_given, names_in_envelope
from camring.objective.objective import Goal
from camring.physics.envelope import Envelope, EnvelopeGrid
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.system import System
from camring.programs.compiled import assess_metrics
from camring.reference import NoSecondSolver, NotStarShapedError, OrbitError
from camring.studies.envelope_grid import BOTH_WAYS, ONE_WAY, usual_envelope
from camring.studies.reference_processes import SecondSolver
from camring.studies.reference_results import all_results

SECOND_TOLERANCE = 1e-5
"""Of the second solver here: its results are then good to 1e-6, limits are kept by 3e-3."""
SAME = 1e-9
"""Of each number: two motors that differ by no more are one, written twice."""


@dataclass(frozen=True, eq=False)
class EnvelopeCheck:
    """A given motor and perhaps a better one at every point of a fine grid.

    Attributes
    ----------
    asked
        Whether the file has an `[envelope]`; else the range is our own choice.
    given, best
        `best` is None where one motor alone is looked at.
    limits
        For each of the two, by name, each limit at every point; kept when at most 0.
    second
        Where the second solver looked at the last of the two, and the worst limit that it
        found there; empty where it was not asked or gave no answer.
    failure
        Why the second solver gave no answer; empty when it did.
    """

    envelope: Envelope
    asked: bool
    given: AtPoints
    best: AtPoints | None
    limits: Sequence[Mapping[str, Float[np.ndarray, " point"]]]
    second: Mapping[int, tuple[str, float]]
    failure: str = ""

    @property
    def grid(self) -> EnvelopeGrid:
        return self.given.grid

    @property
    def motors(self) -> list[AtPoints]:
        return [self.given] if self.best is None else [self.given, self.best]

    def broken(self, motor: int = -1) -> Bool[np.ndarray, " point"]:
        """Where a motor breaks any limit, or has no results."""
        worst = np.max(self._stacked(motor), axis=0, initial=-np.inf)
        return ~(worst <= 0) | (self.motors[motor].faults != 0)

    def binding(self, motor: int = -1) -> list[str]:
        """At every point the limit with the least margin."""
        names, values = list(self.limits[motor]), self._stacked(motor)
        if not names:
            return [""] * self.grid.count
        return [names[place] for place in np.argmax(np.nan_to_num(values, nan=np.inf), axis=0)]

    def tightest(self, motor: int = -1) -> int:
        """The point with the least margin."""
        values = np.nan_to_num(self._stacked(motor), nan=np.inf)
        return int(np.argmax(np.max(values, axis=0, initial=-np.inf)))

    def _stacked(self, motor: int) -> Float[np.ndarray, "limit point"]:
        """Its limits, of which a file may set none that varies in an envelope."""
        return np.array(list(self.limits[motor].values())).reshape(-1, self.grid.count)


def check_envelope(given: MotorFile, best: MotorFile | None = None) -> EnvelopeCheck:
    """Both motors at every point of a fine grid of the first one's envelope.

    Parameters
    ----------
    given
        Whose envelope, limits, ripple and efficiency count.
    """
    return _on_fine_grid(given, best)[0]


def begin_check(
    given: MotorFile, best: MotorFile, second: SecondSolver
) -> Callable[[], EnvelopeCheck]:
    """`check_envelope`, and by the second solver; call what comes back for what both say.

    The second solver solves the best motor's corners and the point that is tightest without
    them, in its own process, where the file asks for an envelope.
    """
    check, goal = _on_fine_grid(given, best)
    if not check.asked:
        return lambda: check
    pending = _begin_second(check, goal, best.system, second)

    # What is asked against the given motor compares both solvers where that one is all there is.
    itself = names_against_given(check.envelope) if _same(given.system, best.system) else ()

    def checked() -> EnvelopeCheck:
        try:
            results = {place: each.result() for place, each in pending.items()}
        except NoSecondSolver:
            return check  # the operating points have said so
        except (OrbitError, NotStarShapedError) as error:
            return replace(check, failure=str(error))
        worst = {
            place: _worst_limit(check, goal, best.system, place, found, itself)
            for place, found in results.items()
        }
        return replace(check, second=worst)

    return checked


def _same(one: System, other: System) -> bool:
    """Whether two systems are one motor; their structure is that of one file."""
    pairs = zip(jax.tree.leaves(one), jax.tree.leaves(other), strict=True)
    return all(np.allclose(a, b, rtol=SAME, atol=0, equal_nan=True) for a, b in pairs)


def _on_fine_grid(given: MotorFile, best: MotorFile | None) -> tuple[EnvelopeCheck, EnvelopeGoal]:
    asked = given.envelope is not None
    envelope = given.envelope or usual_envelope(given.system)
    file = given if asked else replace(given, envelope=envelope, goal=_with_contact(given.goal))
    grid = envelope.grid(*(BOTH_WAYS if envelope.both_directions else ONE_WAY))
    goal = EnvelopeGoal(file, grid)
    found = [goal.given]
    if best is not None:
        found.append(at_points(best.system, file.goal, envelope, grid))
    limits = [_that_vary(goal.limits(each)) for each in found]
    return EnvelopeCheck(envelope, asked, found[0], found[1] if best else None, limits, {}), goal


def _with_contact(goal: Goal) -> Goal:
    """Rollers must stay on the ring, whether the file says so or not."""
    limits = goal.constraints
    if limits.min_contact_force is not None:
        return goal
    return replace(goal, constraints=replace(limits, min_contact_force=0.0))


def _that_vary(limits: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Without the limits of geometry alone, which have the same margin everywhere."""
    same = {"chamber_volume", "max_pressure_angle", "min_undercut_factor"}
    bands = ("displacement", "stroke", "lift")
    return {
        name: values
        for name, values in limits.items()
        if name not in same and not name.startswith(bands)
    }


def _begin_second(
    check: EnvelopeCheck, goal: EnvelopeGoal, system: System, second: SecondSolver
) -> dict[int, Future[dict[str, float]]]:
    places = dict.fromkeys([*check.grid.corners(), check.tightest()])
    return {
        place: second.begin(
            system.motor,
            _fluid_at(check, system, place),
            check.grid.operating_point(place),
            goal.goal.harmonics,
            SECOND_TOLERANCE,
        )
        for place in places
    }


def _fluid_at(check: EnvelopeCheck, system: System, place: int) -> AbstractFluid:
    fluids = check.envelope.fluids
    return fluids[check.grid.fluid[place]] if fluids else system.fluid


def _worst_limit(
    check: EnvelopeCheck,
    goal: EnvelopeGoal,
    system: System,
    place: int,
    results: Mapping[str, float],
    left_out: Collection[str],
) -> tuple[str, float]:
    """The limit with the least margin by the second solver's results at one point."""
    ours = {name: values[place] for name, values in vars(check.motors[-1].metrics).items()}
    both = all_results(ours, results)
    metrics = Metrics(**{name: real(value) for name, value in both.items()})
    here = System(
        system.motor, _fluid_at(check, system, place), (check.grid.operating_point(place),)
    )
    assessed = jax.device_get(assess_metrics(here, goal.goal, (metrics,)))
    names = names_in_envelope(goal.goal.constraints)
    limits = {name: np.array([assessed.constraints[name]]) for name in names}
    alone = AtPoints(check.grid, limits, metrics, np.zeros(1, int))
    worst = {
        name: float(np.ravel(values)[place if np.size(values) > 1 else 0])
        for name, values in _that_vary(goal.limits(alone)).items()
        if name not in left_out
    }
    name = max(worst, key=lambda each: np.nan_to_num(worst[each], nan=np.inf))
    return name, worst[name]

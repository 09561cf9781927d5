"""Descent from several starts along slopes: sequential quadratic programming.

The slopes are exact, or differences of evaluations. Constraints stay constraints. Each descent
is SciPy's SLSQP (Kraft 1988) on the unit box, from a point of the initial design. What it does
follows from the history alone: run again from its start through the evaluations known, it comes
to the first point that is not among them, and that is the next one to evaluate. A study can
therefore be stopped at any trial and goes on with the same bits. While the history only grows by
the point asked for, the descent is held where it waits (`live_loop.py`) and not run again.
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from scipy.optimize import minimize

from camring.search.descent.differences import Differences, NoSlopes, Outputs, outputs_of
from camring.search.descent.path import Known, Path, Point, Slopes, Stalled
from camring.search.live_loop import Asks, HeldLoop
from camring.search.problem import (
    AbstractStrategy,
    Evaluation,
    Memory,
    Proposal,
    Stop,
    best_of,
)
from camring.search.replay import Unknown
from camring.search.sampling import initial_point
from camring.search.threads import one_linear_algebra_thread

INITIAL = "initial"
SOBOL_STARTS = 8
ROUNDS = 3  # of one descent: after a round that did not converge it begins anew where it is
STEPS = 100
SMALLEST_CHANGE = 1e-3  # of an objective between the best and the middling design: its least size


@dataclass(frozen=True)
class GradientSearch(AbstractStrategy):
    """Descends from the best start, from the one farthest from it, and so on in turn.

    Starts are the points of its initial design. As a later stage of a search (`Hybrid`) it has
    none, and starts are all evaluations before it.

    Attributes
    ----------
    slopes
        At a point that did not fail: the gradient of the objective, and that of each
        constraint. Asked more than once for the same point. None: differences
        of evaluations, all of a gradient's known ahead.
    given
        Points to evaluate first; eight of Sobol's follow.
    descents
        How many at most.
    agreeing
        Descents that must have ended at the best objective known for the search to be
        over, to within `agreement` of it.
    accuracy
        Of an objective, relative: a descent whose step gains less has converged.
    tolerance
        Violation up to which a constraint counts as satisfied.
    """

    dimension: int
    slopes: Slopes | None = None
    given: tuple[tuple[float, ...], ...] = ()
    descents: int = 8
    agreeing: int = 3
    agreement: float = 1e-3
    accuracy: float = 1e-7
    tolerance: float = 0.0
    _held: HeldLoop[Evaluation] = field(
        default_factory=HeldLoop, init=False, repr=False, compare=False
    )

    @property
    def initial(self) -> int:
        """Evaluations of the initial design, from which descents start."""
        return len(self.given) + SOBOL_STARTS

    def propose(self, history: Sequence[Evaluation], memory: Memory, seed: int) -> Proposal | Stop:
        """The next point: of the initial design, or of the descent under way."""
        if memory.get("phase") == INITIAL and (waiting := Proposal.waiting(memory)) is not None:
            return waiting
        begun: int = memory.get("begun", len(history) if history and not memory else self.initial)
        if len(history) < begun:
            places = range(len(history), begun)
            design = [initial_point(place, self.dimension, seed, self.given) for place in places]
            return Proposal.of_batch(design, INITIAL, {})
        starts: list[int] = list(memory.get("starts", ()))
        ends: list[int] = list(memory.get("ends", ()))
        with one_linear_algebra_thread():
            while True:
                if len(starts) == len(ends):
                    if (reason := self._enough(history[:begun], history, ends)) is not None:
                        return Stop(reason)
                    start = self._next_start(history[:begun], history, starts, ends)
                    if start is None:
                        return Stop(f"All {len(starts)} usable starts have been descended from.")
                    starts.append(start)
                try:
                    reached = self._descended(history, history[:begun], starts)
                except Unknown as unknown:
                    kept: Memory = {"starts": starts, "ends": ends}
                    if begun != self.initial:
                        kept["begun"] = begun
                    if unknown.ahead:
                        kept["ahead"] = [each.tolist() for each in unknown.ahead]
                    return Proposal(unknown.point, f"descent {len(starts)}", kept)
                except NoSlopes as none:
                    return Stop(str(none))
                ends.append(reached.trial)

    def _enough(
        self, design: Sequence[Evaluation], history: Sequence[Evaluation], ends: Sequence[int]
    ) -> str | None:
        """Why no further descent is needed, if so."""
        best = best_of(history, self.tolerance)
        if best is None or not ends:
            return None
        close = [history[end] for end in ends if history[end].feasible(self.tolerance)]
        size = min(abs(best.objective), _sizes([each for each in design if not each.failed])[0])
        limit = best.objective + self.agreement * size
        agreeing = sum(each.objective <= limit for each in close)
        if agreeing >= self.agreeing:
            return (
                f"{agreeing} of {len(ends)} descents from different starts ended at the best "
                f"design known, to within {100 * self.agreement:g} % of its objective."
            )
        if len(ends) >= self.descents:
            return f"{len(ends)} descents from different starts have ended."
        return None

    def _next_start(
        self,
        design: Sequence[Evaluation],
        history: Sequence[Evaluation],
        starts: Sequence[int],
        ends: Sequence[int],
    ) -> int | None:
        """In turn the best one left, and the one farthest from where descents have been."""
        left = [each for each in design if not each.failed and each.trial not in starts]
        best = best_of(left, self.tolerance)
        if best is None:
            return None
        if len(starts) % 2 == 0:
            return best.trial
        seen = np.array([history[trial].point for trial in (*starts, *ends)])

        def distance(each: Evaluation) -> float:
            return float(np.min(np.linalg.norm(seen - each.point, axis=1)))

        return max(left, key=distance).trial

    def _descended(
        self, history: Sequence[Evaluation], design: Sequence[Evaluation], starts: Sequence[int]
    ) -> Evaluation:
        """The best that the newest descent has found.

        Raises
        ------
        Unknown
            With the point at which it wants to look next.
        NoSlopes
            When differences say nothing.
        """
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # that a step was clipped to the box
            # Of a copy: a waiting descent must not keep this strategy, which ends it, alive.
            descent = partial(replace(self)._descent, history, design, starts)
            return self._held.continued(descent, history, starts[-1])

    def _descent(
        self,
        history: Sequence[Evaluation],
        design: Sequence[Evaluation],
        starts: Sequence[int],
        ask: Asks,
    ) -> Evaluation:
        known = Known(history, ask)
        # The objectives of the design do not change while a descent goes on.
        usable = [each for each in design if not each.failed]
        slopes, accuracy, sizes = self.slopes, self.accuracy, _sizes(usable)
        if slopes is None:
            slopes = Differences.measured(known, history[starts[0]], sizes)
            accuracy = max(accuracy, slopes.noise)
        path = Path(known, slopes, 1 / sizes[0], history[starts[-1]], self.tolerance)
        try:
            for _ in range(ROUNDS):
                before = path.best()
                converged = self._round(path, before.point, accuracy)
                best = path.best()
                if best is before or (converged and best.feasible(self.tolerance)):
                    break
                if not best.feasible(self.tolerance):
                    self._towards_feasible(path, best.point)
        except Stalled:
            pass
        return path.best()

    def _round(self, path: Path, start: Point, accuracy: float) -> bool:
        found = minimize(
            path.objective,
            start,
            jac=path.objective_slope,
            bounds=[(0.0, 1.0)] * self.dimension,
            constraints={
                "type": "ineq",
                "fun": lambda point: -path.constraints(point),
                "jac": lambda point: -path.constraint_slopes(point),
            },
            method="SLSQP",
            options={"maxiter": STEPS, "ftol": accuracy},
        )
        return bool(found.success)

    def _towards_feasible(self, path: Path, start: Point) -> None:
        """Fewer and smaller violations, whatever the objective."""

        def excess(point: Point) -> tuple[float, Point]:
            over = np.maximum(path.constraints(point), 0.0)
            return float(over @ over) / 2, over @ path.constraint_slopes(point)

        minimize(
            excess,
            start,
            jac=True,
            bounds=[(0.0, 1.0)] * self.dimension,
            method="L-BFGS-B",
            options={"maxiter": STEPS},
        )


def _sizes(usable: Sequence[Evaluation]) -> Outputs:
    """Of the objective and of each constraint among designs that did not fail.

    A good objective's own, unless it crosses zero or has a large constant part: then it has no
    size but that of its changes. A constraint's is how far it reaches.
    """
    outputs = np.array([outputs_of(each) for each in usable])
    lowest, middle, highest = np.quantile(outputs[:, 0], [0, 0.5, 1])
    sizes = np.ptp(outputs, axis=0)
    own = np.min(np.abs(outputs[:, 0]))
    if highest > lowest:
        own = np.clip(own, SMALLEST_CHANGE * (middle - lowest), highest - lowest)
    sizes[0] = own
    found: Outputs = np.where(sizes > np.finfo(float).tiny, sizes, 1.0)
    return found

"""Descent from several starts, with exact slopes: sequential quadratic programming.

Constraints stay constraints. Each descent is SciPy's SLSQP (Kraft 1988) on the unit
box, from a point of the initial design. What it does follows from the history alone:
run again from its start through the evaluations known, it comes to the first point that
is not among them, and that is the next one to evaluate. A study can therefore be
stopped at any trial and goes on with the same bits. While the history only grows by the
point asked for, the descent is held where it waits (`live_loop.py`) and not run again.
"""

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TypeAlias

import numpy as np
from jaxtyping import Float
from scipy.optimize import minimize

from camring.search.live_loop import Asks, HeldLoop
from camring.search.problem import (
    AbstractStrategy,
    Evaluation,
    Memory,
    Proposal,
    Stop,
    best_of,
)
from camring.search.replay import Unknown, on_grid
from camring.search.sampling import initial_point
from camring.search.threads import one_linear_algebra_thread

Point: TypeAlias = Float[np.ndarray, " dimension"]
Slopes: TypeAlias = Callable[
    [Point], tuple[Float[np.ndarray, " dimension"], Float[np.ndarray, "constraint dimension"]]
]

INSIDE = 2e-7  # what a descent keeps of every limit: it may end `accuracy` beyond it
SOBOL_STARTS = 8
ROUNDS = 3  # of one descent: after a round that did not converge it begins anew where it is
STEPS = 100
PATIENCE = 60  # evaluations of one descent without a gain; then it has ended
PROGRESS = 1e-6  # of the objective, or of the violation: what counts as a gain


class _Stalled(Exception):
    """A descent goes on without getting anywhere."""


@dataclass(frozen=True)
class GradientSearch(AbstractStrategy):
    """Descends from the best start, from the one farthest from it, and so on in turn.

    Attributes
    ----------
    slopes
        At a point that did not fail: the gradient of the objective, and that of each
        constraint. Asked more than once for the same point.
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
    slopes: Slopes
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
        if (waiting := Proposal.waiting(memory)) is not None:
            return waiting
        if len(history) < self.initial:
            places = range(len(history), self.initial)
            design = [initial_point(place, self.dimension, seed, self.given) for place in places]
            return Proposal.of_batch(design, "initial", {})
        starts: list[int] = list(memory.get("starts", ()))
        ends: list[int] = list(memory.get("ends", ()))
        with one_linear_algebra_thread():
            while True:
                if len(starts) == len(ends):
                    if (reason := self._enough(history, ends)) is not None:
                        return Stop(reason)
                    start = self._next_start(history, starts, ends)
                    if start is None:
                        return Stop(f"All {len(starts)} usable starts have been descended from.")
                    starts.append(start)
                reached = self._descended(history, starts[-1])
                if isinstance(reached, np.ndarray):
                    kept = {"starts": starts, "ends": ends}
                    return Proposal(reached, f"descent {len(starts)}", kept)
                ends.append(reached.trial)

    def _enough(self, history: Sequence[Evaluation], ends: Sequence[int]) -> str | None:
        """Why no further descent is needed, if so."""
        best = best_of(history, self.tolerance)
        if best is None or not ends:
            return None
        close = [history[end] for end in ends if history[end].feasible(self.tolerance)]
        limit = best.objective + self.agreement * abs(best.objective)
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
        history: Sequence[Evaluation],
        starts: Sequence[int],
        ends: Sequence[int],
    ) -> int | None:
        """In turn the best one left, and the one farthest from where descents have been."""
        design = history[: self.initial]
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

    def _descended(self, history: Sequence[Evaluation], start: int) -> Point | Evaluation:
        """Where a descent wants to look next, or the best that it has found."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # that a step was clipped to the box
            try:
                # Of a copy: a waiting descent must not keep this strategy, which ends it, alive.
                descent = partial(replace(self)._descent, history, start)
                return self._held.continued(descent, history, start)
            except Unknown as unknown:
                return unknown.point

    def _descent(self, history: Sequence[Evaluation], start: int, ask: Asks) -> Evaluation:
        known = {on_grid(each.point).tobytes(): each for each in history}
        # The objectives of the initial design do not change while a descent goes on.
        usable = [each for each in history[: self.initial] if not each.failed]
        scale = 1 / max(min(abs(each.objective) for each in usable), np.finfo(float).tiny)
        path = _Path(known, ask, self.slopes, scale, history[start], self.tolerance)
        try:
            for _ in range(ROUNDS):
                before = path.best(self.tolerance)
                converged = self._round(path, before.point)
                best = path.best(self.tolerance)
                if best is before or (converged and best.feasible(self.tolerance)):
                    break
                if not best.feasible(self.tolerance):
                    self._towards_feasible(path, best.point)
        except _Stalled:
            pass
        return path.best(self.tolerance)

    def _round(self, path: "_Path", start: Point) -> bool:
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
            options={"maxiter": STEPS, "ftol": self.accuracy},
        )
        return bool(found.success)

    def _towards_feasible(self, path: "_Path", start: Point) -> None:
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


class _Path:
    """What a descent sees of the history, and which evaluations it has passed."""

    def __init__(
        self,
        known: dict[bytes, Evaluation],
        ask: Asks,
        slopes: Slopes,
        scale: float,
        start: Evaluation,
        tolerance: float,
    ) -> None:
        self._known, self._ask, self._slopes, self._scale = known, ask, slopes, scale
        self._tolerance = tolerance
        self._lead, self._led_at = start.rank(tolerance), 0
        self.seen: list[Evaluation] = [start]

    def best(self, tolerance: float) -> Evaluation:
        """Of all that the descent has passed; its start, at least, did not fail."""
        found = best_of(self.seen, tolerance)
        assert found is not None
        return found

    def _at(self, point: Point) -> Evaluation:
        within = on_grid(point)
        found = self._known.get(within.tobytes())
        if found is None:
            found = self._known[within.tobytes()] = self._ask(within)
        if found is not self.seen[-1]:
            self.seen.append(found)
            self._require_progress(found)
        return found

    def _require_progress(self, found: Evaluation) -> None:
        """Rounding can keep SLSQP at the end of its descent for as long as it is let."""
        group, value = found.rank(self._tolerance)
        led, least = self._lead
        if group < led or (group == led and value < least - PROGRESS * abs(least)):
            self._lead, self._led_at = (group, value), len(self.seen)
        elif len(self.seen) - self._led_at > PATIENCE:
            raise _Stalled

    def objective(self, point: Point) -> float:
        """Scaled to about one at a good design; a failed one is worse than all before it."""
        here = self._at(point)
        if here.failed:
            sound = [each.objective for each in self.seen if not each.failed]
            return self._scale * (max(sound) + 10 * abs(max(sound)))
        return self._scale * here.objective

    def objective_slope(self, point: Point) -> Point:
        here = self._at(point)
        if here.failed:
            return np.zeros_like(point)
        return self._scale * self._slopes(here.point)[0]

    def constraints(self, point: Point) -> Float[np.ndarray, " constraint"]:
        here = self._at(point)
        if here.failed:
            return np.ones_like(here.constraints)
        return here.constraints + INSIDE

    def constraint_slopes(self, point: Point) -> Float[np.ndarray, "constraint dimension"]:
        here = self._at(point)
        if here.failed:
            return np.zeros((len(here.constraints), len(point)))
        return self._slopes(here.point)[1]

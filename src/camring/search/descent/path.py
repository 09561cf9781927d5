"""What a descent sees of the history: objective, limits and their slopes at its points."""

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np
from jaxtyping import Float

from camring.search.live_loop import Asks
from camring.search.problem import Evaluation, best_of
from camring.search.replay import on_grid

Point: TypeAlias = Float[np.ndarray, " dimension"]
Slopes: TypeAlias = Callable[
    [Point], tuple[Float[np.ndarray, " dimension"], Float[np.ndarray, "constraint dimension"]]
]

INSIDE = 2e-7  # what a descent keeps of every limit: it may end `accuracy` beyond it
PATIENCE = 60  # evaluations of one descent without a gain; then it has ended
PROGRESS = 1e-6  # of the objective, or of the violation: what counts as a gain


class Stalled(Exception):
    """A descent goes on without getting anywhere."""


class Known:
    """Evaluations of a history, and whoever has those that are not in it."""

    def __init__(self, history: Sequence[Evaluation], ask: Asks) -> None:
        self._known = {on_grid(each.point).tobytes(): each for each in history}
        self._ask = ask

    def at(self, point: Point, ahead: Sequence[Point] = ()) -> Evaluation:
        within = on_grid(point)
        found = self._known.get(within.tobytes())
        if found is None:
            missing = [on_grid(each) for each in ahead]
            missing = [each for each in missing if each.tobytes() not in self._known]
            found = self._known[within.tobytes()] = self._ask(within, missing)
        return found


class Path:
    """What a descent sees of the history, and which evaluations it has passed."""

    def __init__(
        self, known: Known, slopes: Slopes, scale: float, start: Evaluation, tolerance: float
    ) -> None:
        self._known, self._slopes, self._scale = known, slopes, scale
        self._tolerance = tolerance
        self._lead, self._led_at = start.rank(tolerance), 0
        self.seen: list[Evaluation] = [start]

    def best(self) -> Evaluation:
        """Of all that the descent has passed; its start, at least, did not fail."""
        found = best_of(self.seen, self._tolerance)
        assert found is not None
        return found

    def _at(self, point: Point) -> Evaluation:
        found = self._known.at(point)
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
            raise Stalled

    def objective(self, point: Point) -> float:
        """Scaled to about one at a good design; a failed one is worse than all before it."""
        here = self._at(point)
        if here.failed:
            sound = [each.objective for each in self.seen if not each.failed]
            return self._scale * max(sound) + 10 * max(self._scale * abs(max(sound)), 1.0)
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

"""Between a method and a problem: counts, times and keeps every evaluation."""

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from benchmarks.search.problem import TOLERANCE, Point, SearchProblem, ValueAt
from camring.search.sampling import generator, initial_point

MOVED, STREAM = 0.07, 3
"""Box widths: the normal step by which a seed's given points stand off the problem's, so that a
method that knows no chance does not make the same run of every seed."""
NEAR = 1e-4
"""Of the best known value: a run that has come so near has reached every target and ends."""


class Spent(Exception):
    """The budget of evaluations is spent."""


class Reached(Spent):
    """The run is so near the best known value that no target is left."""


class Oracle:
    """A problem as one run of one method sees it.

    A point that was evaluated already costs nothing: libraries ask objective and
    constraints by separate calls. Slopes are counted apart.
    """

    def __init__(self, problem: SearchProblem, seed: int, budget: int | None = None) -> None:
        self.problem, self.seed = problem, seed
        self.budget = problem.budget if budget is None else budget
        self.dimension, self.constraint_count = problem.dimension, problem.constraint_count
        random = generator(seed, 0, STREAM)
        self.given = tuple(
            tuple(np.clip(point + MOVED * random.normal(size=len(point)), 0.0, 1.0).tolist())
            for point in problem.given
        )
        self.outcomes: list[ValueAt] = []
        self.slopes_before: list[int] = []
        self.evaluating, self.processor = 0.0, 0.0  # seconds in the problem, wall and processor
        self._known: dict[bytes, ValueAt] = {}
        self._sloped: dict[bytes, tuple[np.ndarray, np.ndarray]] = {}

    @property
    def left(self) -> int:
        return self.budget - len(self.outcomes)

    def outcome(self, point: Point) -> ValueAt:
        """The problem's own words, failures included.

        Raises
        ------
        Spent
            At a new point when the budget is spent, or after one that is near enough.
        """
        at = np.clip(np.array(point, dtype=float).reshape(-1), 0.0, 1.0) + 0.0
        key = at.tobytes()
        if key not in self._known:
            if self.left <= 0:
                raise Spent
            found = self._timed(self.problem.evaluate, at)
            self._known[key] = found
            self.outcomes.append(found)
            self.slopes_before.append(len(self._sloped))
            best = self.problem.best
            if found.feasible and found.objective <= best + NEAR * abs(best):
                raise Reached
        return self._known[key]

    def slopes(self, point: Point) -> tuple[np.ndarray, np.ndarray]:
        key = np.asarray(point, dtype=float).tobytes()
        if key not in self._sloped:
            self._sloped[key] = self._timed(self.problem.slopes, point)
        return self._sloped[key]

    def _timed(self, function: Callable[[Point], Any], point: Point) -> Any:
        wall, processor = time.perf_counter(), time.process_time()
        found = function(point)
        self.evaluating += time.perf_counter() - wall
        self.processor += time.process_time() - processor
        return found

    def __call__(self, point: Point) -> tuple[float, np.ndarray]:
        """Objective and constraints, finite: a failure is as bad as the worst before it.

        Every rival sees failures like this, since most can take no other.
        """
        found = self.outcome(point)
        if found.failure is None:
            return found.objective, found.constraints
        sound = [each.objective for each in self.outcomes if each.failure is None]
        return max(sound, default=0.0), np.ones(self.constraint_count)

    def objective(self, point: Point) -> float:
        return self(point)[0]

    def constraints(self, point: Point) -> np.ndarray:
        return self(point)[1]

    def design(self, count: int) -> np.ndarray:
        """The first points of this seed: those given, then scrambled Sobol's; as ours draws."""
        points = [initial_point(i, self.dimension, self.seed, self.given) for i in range(count)]
        return np.array(points)

    def ranked(self, points: np.ndarray) -> np.ndarray:
        """The points, evaluated, best first: feasible by objective, then by sum of excess."""

        def rank(point: Point) -> tuple[float, float]:
            objective, constraints = self(point)
            if np.all(constraints <= TOLERANCE):
                return 0.0, objective
            return 1.0, float(np.sum(np.maximum(constraints, 0.0)))

        return np.array(sorted(points, key=rank))

"""A function that scatters as one that does not: statistics of it over common random numbers.

Every design is looked at with the same samples, so the statistics are as smooth in the
design as the function itself, and any descent that takes values and slopes can go down
them.
"""

from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import numpy as np
from jaxtyping import Float

from camring.search.problem import Outputs, Points, Problem
from camring.search.scatter.statistic import Statistic, Weighed

Point: TypeAlias = Float[np.ndarray, " dimension"]


class Scattered(NamedTuple):
    """A design looked at with every sample; NaN where it failed."""

    objective: Float[np.ndarray, " sample"]
    constraints: Float[np.ndarray, "constraint sample"]


class ScatteredSlopes(NamedTuple):
    """Slopes of both by the coordinates of the design."""

    objective: Float[np.ndarray, "dimension sample"]
    constraints: Float[np.ndarray, "constraint dimension sample"]


class RobustFunction:
    """One statistic of the objective, and one of every constraint.

    Parameters
    ----------
    scattered, sample_slopes
        All samples of a design, and their slopes where none failed.
    of_objective, of_constraints
        The statistics to minimise, and to keep at zero or below.
    safety
        What is added to every constraint.
    """

    def __init__(
        self,
        scattered: Callable[[Point], Scattered],
        sample_slopes: Callable[[Point], ScatteredSlopes],
        of_objective: Statistic,
        of_constraints: Statistic,
        safety: float = 0.0,
    ) -> None:
        self._scattered, self._sample_slopes = scattered, sample_slopes
        self._of_objective, self._of_constraints = of_objective, of_constraints
        self._safety = safety
        self._weighed: dict[bytes, tuple[Weighed, list[Weighed]]] = {}
        self._slopes: dict[bytes, tuple[Point, Float[np.ndarray, "constraint dimension"]]] = {}

    def problem(self, dimension: int, constraint_count: int) -> Problem:
        """For the searches of this package."""

        def evaluate(points: Points) -> list[Outputs]:
            return [self.outputs(point) for point in points]

        return Problem(dimension, constraint_count, evaluate)

    def outputs(self, point: Point) -> Outputs:
        """Both statistics at one design; it fails as soon as one sample does."""
        found = self._scattered(point)
        sound = np.isfinite(found.objective) & np.all(np.isfinite(found.constraints), axis=0)
        if not np.all(sound):
            nothing = np.full(len(found.constraints), np.nan)
            failed = np.count_nonzero(~sound)
            return np.nan, nothing, np.nan, f"{failed} of {len(sound)} samples failed"
        objective, limits = self._weigh(point, found)
        return objective.value, np.array([each.value for each in limits]), np.nan, None

    def slopes(self, point: Point) -> tuple[Point, Float[np.ndarray, "constraint dimension"]]:
        """Their gradients, for `GradientSearch`; at a design that did not fail."""
        key = np.asarray(point, dtype=float).tobytes()
        if key not in self._slopes:
            objective, limits = self._weighed.get(key) or self._weigh(point, self._scattered(point))
            slopes = self._sample_slopes(point)
            rows = [
                slope @ each.weights for each, slope in zip(limits, slopes.constraints, strict=True)
            ]
            self._slopes[key] = (
                slopes.objective @ objective.weights,
                np.reshape(rows, (-1, len(point))),
            )
        return self._slopes[key]

    def _weigh(self, point: Point, found: Scattered) -> tuple[Weighed, list[Weighed]]:
        limits = [self._of_constraints(row + self._safety) for row in found.constraints]
        weighed = self._of_objective(found.objective), limits
        self._weighed[np.asarray(point, dtype=float).tobytes()] = weighed
        return weighed


__all__ = ["RobustFunction", "Scattered", "ScatteredSlopes"]

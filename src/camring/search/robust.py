"""A function that scatters as one that does not: statistics of it over common random numbers.

Every design is looked at with the same samples, so the statistics are as smooth in the
design as the function itself, and any descent that takes values and slopes can go down
them.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np
from jaxtyping import Float

from camring.search.problem import Outputs, Points, Problem
from camring.search.statistic import Statistic

Point: TypeAlias = Float[np.ndarray, " dimension"]


class Scattered(NamedTuple):
    """A design looked at with every sample; NaN where it failed."""

    objective: Float[np.ndarray, " sample"]
    constraints: Float[np.ndarray, "constraint sample"]


class ScatteredSlopes(NamedTuple):
    """Slopes of both by the coordinates of the design."""

    objective: Float[np.ndarray, "dimension sample"]
    constraints: Float[np.ndarray, "constraint dimension sample"]


@dataclass(frozen=True)
class RobustFunction:
    """One statistic of the objective, and one of every constraint.

    Attributes
    ----------
    scattered, slopes
        All samples of a design, and their slopes where none failed.
    of_objective, of_constraints
        The statistics to minimise, and to keep at zero or below.
    """

    scattered: Callable[[Point], Scattered]
    sample_slopes: Callable[[Point], ScatteredSlopes]
    of_objective: Statistic
    of_constraints: Statistic

    def problem(self, dimension: int, constraint_count: int) -> Problem:
        """For the searches of this room."""

        def evaluate(points: Points) -> list[Outputs]:
            return [self.outputs(point) for point in points]

        return Problem(dimension, constraint_count, evaluate)

    def outputs(self, point: Point) -> Outputs:
        """Both statistics at one design; it fails as soon as one sample does."""
        found = self.scattered(point)
        sound = np.isfinite(found.objective) & np.all(np.isfinite(found.constraints), axis=0)
        if not np.all(sound):
            nothing = np.full(len(found.constraints), np.nan)
            failed = np.count_nonzero(~sound)
            return np.nan, nothing, np.nan, f"{failed} of {len(sound)} samples failed"
        limits = np.array([self.of_constraints(row).value for row in found.constraints])
        return self.of_objective(found.objective).value, limits, np.nan, None

    def slopes(self, point: Point) -> tuple[Point, Float[np.ndarray, "constraint dimension"]]:
        """Their gradients, for `GradientSearch`; at a design that did not fail."""
        found, slopes = self.scattered(point), self.sample_slopes(point)
        rows = [
            slope @ self.of_constraints(row).weights
            for row, slope in zip(found.constraints, slopes.constraints, strict=True)
        ]
        objective = slopes.objective @ self.of_objective(found.objective).weights
        return objective, np.reshape(rows, (-1, len(point)))


__all__ = ["RobustFunction", "Scattered", "ScatteredSlopes"]

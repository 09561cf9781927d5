"""The rows of a history that a surrogate learns from."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int

from camring.search.problem import Evaluation


@dataclass(frozen=True, eq=False)
class Dataset:
    """Evaluations as columns; NaN where an evaluation has no such value.

    Attributes
    ----------
    restrictions
        The constraints, and when any evaluation failed one column more: +1 where
        it failed, -1 where it did not, so that failing is one more constraint
        that can be learned and avoided.
    failures
        True when there is that column.
    centre
        The point that later searches will mostly be near: the best one.
    """

    points: Float[np.ndarray, "rows dimension"]
    objective: Float[np.ndarray, " rows"]
    approximation: Float[np.ndarray, " rows"]
    restrictions: Float[np.ndarray, "rows restrictions"]
    failures: bool
    centre: Float[np.ndarray, " dimension"]

    def take(self, rows: Int[np.ndarray, " some"]) -> "Dataset":
        """Only these rows."""
        return replace(
            self,
            points=self.points[rows],
            objective=self.objective[rows],
            approximation=self.approximation[rows],
            restrictions=self.restrictions[rows],
        )

    def without_approximation(self) -> "Dataset":
        """The same rows, for a search that cannot ask the approximation elsewhere."""
        return replace(self, approximation=np.full_like(self.objective, np.nan))

    def nearest(self, size: int) -> "Dataset":
        """At most `size` rows: three quarters nearest to the centre, the rest spread over time.

        This is what keeps a fit at 500 points as fast as one at `size` points.
        """
        count = len(self.points)
        if count <= size:
            return self
        order = np.argsort(np.sum((self.points - self.centre) ** 2, axis=1), kind="stable")
        near, far = order[: (3 * size) // 4], np.sort(order[(3 * size) // 4 :])
        spread = far[np.linspace(0, len(far) - 1, size - len(near)).round().astype(int)]
        return self.take(np.sort(np.concatenate([near, spread])))


def collect(
    history: Sequence[Evaluation],
    centre: Float[np.ndarray, " dimension"],
    penalty_weight: float | None = None,
) -> Dataset:
    """Columns from a history.

    Parameters
    ----------
    penalty_weight
        When given, constraints do not become columns of their own but are added
        to the objective as ``penalty_weight * sum max(0, constraint)^2``.
    """
    points = np.array([evaluation.point for evaluation in history])
    failed = np.array([evaluation.failed for evaluation in history])
    objective = np.array([evaluation.objective for evaluation in history], dtype=float)
    constraints = np.array([evaluation.constraints for evaluation in history], dtype=float)
    constraints = constraints.reshape(len(history), -1)
    if penalty_weight is not None:
        objective = objective + penalty_weight * np.sum(np.maximum(constraints, 0.0) ** 2, axis=1)
        constraints = constraints[:, :0]
    objective = np.where(np.isfinite(objective), objective, np.nan)
    constraints = np.where(np.isfinite(constraints), constraints, np.nan)
    if failed.any():
        constraints = np.column_stack([constraints, np.where(failed, 1.0, -1.0)])
    approximation = np.array([evaluation.approximation for evaluation in history], dtype=float)
    return Dataset(
        points, objective, approximation, constraints, bool(failed.any()), np.asarray(centre)
    )

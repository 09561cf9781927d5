"""The objective and every constraint as Gaussian processes, ready to be asked.

Output 0 is the objective, warped; the others are the restrictions, each warped
with its sign kept, so that "at most 0" still means satisfied.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from camring.search.problem import Evaluation, Points
from camring.search.surrogate.dataset import Dataset
from camring.search.surrogate.gaussian_process import (
    Posterior,
    condition_once,
    predict,
    predict_each,
)
from camring.search.surrogate.hyper_parameters import Learned, objective_rows, restriction_rows
from camring.search.surrogate.residual_mean import ResidualMean, basis_columns, offset

Approximation: TypeAlias = Callable[[Points], Float[np.ndarray, " points"]]

DIFFERENCE_STEP = 1e-5  # of the box; the approximation is an opaque callable


def _bound(
    posterior: Posterior,
    point: Float[Array, " dimension"],
    basis: Float[Array, " columns"],
    multiplier: Float[Array, ""],
) -> Float[Array, ""]:
    mean, variance = predict(posterior, point[None], basis[None])
    return mean[0] + multiplier * jnp.sqrt(variance[0])


_bound_and_slopes = jax.jit(
    jax.vmap(jax.value_and_grad(_bound, argnums=(1, 2)), in_axes=(0, None, 0, 0))
)


@dataclass(frozen=True, eq=False)
class Surrogate:
    """Means and deviations of objective and restrictions anywhere in the box.

    Attributes
    ----------
    failures
        True when the last restriction is "this evaluation will not fail".
    """

    posteriors: Posterior
    learned: Learned
    approximate: Approximation | None
    failures: bool

    @property
    def outputs(self) -> int:
        """One for the objective and one for each restriction."""
        return 1 + len(self.learned.restrictions)

    def predict(
        self, points: Float[np.ndarray, "points dimension"]
    ) -> tuple[Float[np.ndarray, "points outputs"], Float[np.ndarray, "points outputs"]]:
        """Mean and standard deviation of each warped output."""
        warped = self._warped_approximation(points)
        mean, variance = predict_each(self.posteriors, points, self._columns(warped))
        means = np.array(mean).T
        means[:, 0] += offset(self.learned.mean, warped)
        return means, np.sqrt(np.asarray(variance)).T

    def expected(self, point: Float[np.ndarray, " dimension"], trial: int) -> Evaluation:
        """The evaluation that would surprise no process: all means come true."""
        means = self.predict(point[None])[0][0]
        limits = self.learned.restrictions[: self.outputs - 1 - self.failures]
        return Evaluation(
            trial,
            point,
            float(self.learned.objective_warp.undone(means[0])),
            np.array(
                [warp.undone(mean) for mean, (_, warp) in zip(means[1:], limits, strict=False)]
            ),
            float(self.approximate(point[None])[0]) if self.approximate else np.nan,
        )

    def basis(
        self, points: Float[np.ndarray, "points dimension"]
    ) -> Float[np.ndarray, "outputs points 2"]:
        """What the fitted coefficients of each output multiply."""
        return self._columns(self._warped_approximation(points))

    def _columns(
        self, warped: Float[np.ndarray, " points"]
    ) -> Float[np.ndarray, "outputs points 2"]:
        basis = np.zeros((self.outputs, len(warped), 2))
        basis[:, :, 0] = 1.0
        basis[0] = basis_columns(self.learned.mean, warped)
        return basis

    def bounds(
        self, point: Float[np.ndarray, " dimension"], multipliers: Float[np.ndarray, " outputs"]
    ) -> tuple[Float[np.ndarray, " outputs"], Float[np.ndarray, "outputs dimension"]]:
        """``mean + multiplier * deviation`` of each output at one point, and its gradient."""
        mean = self.learned.mean
        dimension = len(point)
        basis = np.zeros((self.outputs, 2))
        basis[:, 0] = 1.0
        if mean is ResidualMean.PLAIN:
            values, (slopes, _) = _bound_and_slopes(self.posteriors, point, basis, multipliers)
            return np.asarray(values), np.asarray(slopes)
        upper = np.minimum(point + DIFFERENCE_STEP * np.eye(dimension), 1.0)
        lower = np.maximum(point - DIFFERENCE_STEP * np.eye(dimension), 0.0)
        warped = self._warped_approximation(np.vstack([point[None], upper, lower]))
        run = np.diagonal(upper) - np.diagonal(lower)
        along_axes = (warped[1 : 1 + dimension] - warped[1 + dimension :]) / run
        basis[0] = basis_columns(mean, warped[:1])[0]
        values, (slopes, basis_slopes) = _bound_and_slopes(
            self.posteriors, point, basis, multipliers
        )
        values, slopes = np.array(values), np.array(slopes)
        values[0] += offset(mean, warped[:1])[0]
        through = 1.0 if mean is ResidualMean.TRUSTED else float(basis_slopes[0, 1])
        slopes[0] += through * along_axes
        return values, slopes

    def _warped_approximation(
        self, points: Float[np.ndarray, "points dimension"]
    ) -> Float[np.ndarray, " points"]:
        if self.learned.mean is ResidualMean.PLAIN or self.approximate is None:
            return np.zeros(len(points))
        return self.learned.objective_warp(np.asarray(self.approximate(points), dtype=float))


def build(
    dataset: Dataset,
    learned: Learned,
    approximate: Approximation | None,
) -> Surrogate:
    """Every output conditioned on the data set."""
    rows = [objective_rows(learned.mean, dataset, learned.objective_warp)]
    fitted = [learned.objective[learned.mean]]
    for column, (known, warp) in enumerate(learned.restrictions):
        rows.append(restriction_rows(dataset, column, warp))
        fitted.append(known)
    # One compiled function serves any number of outputs, where a vmapped one would not.
    posteriors = [
        condition_once(observations, one.hyperparameters())
        for observations, one in zip(rows, fitted, strict=True)
    ]
    stacked = jax.tree.map(lambda *leaves: np.stack(leaves), *posteriors)
    return Surrogate(jax.device_put(stacked), learned, approximate, dataset.failures)

"""Hyper-parameters by marginal likelihood, from one start or several.

The likelihood is profiled: basis coefficients and signal variance are at their
maximum for given lengthscales and noise ratio, so only those are searched. A
weak prior keeps a lengthscale on which the data say nothing from drifting away.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float
from scipy.optimize import minimize

from camring.numerics.quantity import real
from camring.search.surrogate.gaussian_process import (
    Hyperparameters,
    Observations,
    Posterior,
    along_axes,
    condition,
    masked_correlation,
)

LENGTHSCALE_BOUNDS = (0.02, 20.0)
NOISE_BOUNDS = (1e-10, 1.0)
PRIOR_WIDTH = 1.5  # standard deviation of log lengthscale


def prior_centre(dimension: int) -> float:
    """Log of the lengthscale expected beforehand; distances grow as sqrt(dimension)."""
    return float(np.log(0.6 * np.sqrt(dimension)))


def log_likelihood(posterior: Posterior) -> Float[Array, ""]:
    """Log marginal likelihood of the observations that the process is conditioned on.

    Notes
    -----
    ``-n/2 (log(2 pi signal) + 1) - log|R|/2``: coefficients and signal variance are
    at their maximum. Rasmussen and Williams (2006), eq. (2.30).
    """
    count = jnp.sum(posterior.observations.mask)
    spread = jnp.log(2 * jnp.pi * posterior.signal_variance)
    return -0.5 * (count * (spread + 1) + posterior.log_determinant)


@jax.jit
def cost_and_gradient(
    parameters: Float[Array, " dimension+1"],
    axes: Float[Array, "dimension dimension"],
    observations: Observations,
) -> tuple[Float[Array, ""], Float[Array, " dimension+1"]]:
    """Negative log posterior density of (log lengthscales, log noise ratio), and its gradient.

    The gradient is written out, ``dL/dp = tr((a a'/signal - R^-1) dR/dp)/2`` with
    ``a = R^-1 r``: coefficients and signal variance are stationary and do not
    enter. It costs one inverse; reverse differentiation of the factor costs four.
    """
    dimension = parameters.shape[0] - 1
    lengthscales = jnp.exp(parameters[:dimension])
    noise_ratio = jnp.exp(parameters[dimension])
    hyperparameters = Hyperparameters(lengthscales, noise_ratio, axes)
    posterior = condition(observations, hyperparameters)
    inverse = posterior.inverse_factor.T @ posterior.inverse_factor
    outer = posterior.weights[:, None] * posterior.weights[None, :] / posterior.signal_variance
    kernel = masked_correlation(observations, hyperparameters)
    coupling = (outer - inverse) * kernel
    scaled = along_axes(observations.points, hyperparameters)
    # sum_ij coupling_ij (z_ik - z_jk)^2, expanded so that no array of rank three is needed
    along_lengths = 2 * (
        jnp.sum(coupling, axis=1) @ scaled**2 - jnp.sum(scaled * (coupling @ scaled), axis=0)
    )
    along_noise = noise_ratio * jnp.sum(
        jnp.where(observations.mask, jnp.diagonal(outer - inverse), 0.0)
    )
    gradient = 0.5 * jnp.append(along_lengths, along_noise)

    deviation = (parameters[:dimension] - prior_centre(dimension)) / PRIOR_WIDTH
    log_density = log_likelihood(posterior) - 0.5 * deviation @ deviation
    gradient = gradient.at[:dimension].add(-deviation / PRIOR_WIDTH)
    return -log_density, -gradient


@dataclass(frozen=True)
class Fitted:
    """Hyper-parameters of one process as plain numbers that survive JSON bit by bit.

    Attributes
    ----------
    parameters
        Log lengthscales and log noise ratio.
    axes
        Rows of the matrix whose columns are the axes; None for the box's own.
    """

    parameters: tuple[float, ...]
    axes: tuple[tuple[float, ...], ...] | None = None

    @property
    def dimension(self) -> int:
        """Of the box."""
        return len(self.parameters) - 1

    def axes_array(self) -> Float[np.ndarray, "dimension dimension"]:
        """The axes as orthonormal columns."""
        return np.eye(self.dimension) if self.axes is None else np.array(self.axes)

    def hyperparameters(self) -> Hyperparameters:
        """As arrays for the process."""
        values = np.exp(np.array(self.parameters))
        return Hyperparameters(values[:-1], values[-1], real(self.axes_array()))


def standard_starts(dimension: int) -> list[Float[np.ndarray, " dimension+1"]]:
    """Several places to start from: a smooth, a usual and a rough function."""
    centre = prior_centre(dimension)
    return [
        np.append(np.full(dimension, centre + shift), np.log(noise))
        for shift, noise in ((0.0, 1e-6), (1.5, 1e-8), (-1.5, 1e-3))
    ]


def fit(
    observations: Observations,
    starts: Sequence[Sequence[float] | Float[np.ndarray, " dimension+1"]],
    axes: tuple[tuple[float, ...], ...] | None = None,
    iterations: int = 50,
) -> tuple[Fitted, float]:
    """The best hyper-parameters found from any start, and their log posterior density.

    Parameters
    ----------
    starts
        Vectors of (log lengthscales, log noise ratio); clipped into the bounds.
    axes
        Directions of the lengthscales, which stay; None for the box's own.
    iterations
        Limit on L-BFGS-B iterations from each start.
    """
    dimension = observations.points.shape[-1]
    bounds = [tuple(np.log(LENGTHSCALE_BOUNDS))] * dimension + [tuple(np.log(NOISE_BOUNDS))]
    lower, upper = np.array(bounds).T
    directions = real(np.eye(dimension) if axes is None else np.array(axes))
    observations = jax.device_put(observations)

    def cost(parameters: np.ndarray) -> tuple[float, np.ndarray]:
        value, gradient = cost_and_gradient(parameters, directions, observations)
        if not np.isfinite(value):
            return 1e12, np.zeros_like(parameters)
        return float(value), np.asarray(gradient)

    best, density = np.clip(starts[0], lower, upper), -np.inf
    for start in starts:
        found = minimize(
            cost,
            np.clip(start, lower, upper),
            jac=True,
            method="L-BFGS-B",
            bounds=bounds,
            options={"maxiter": iterations, "ftol": 1e-7, "gtol": 1e-3},
        )
        if -found.fun > density:
            best, density = np.asarray(found.x), -float(found.fun)
    return Fitted(tuple(float(value) for value in best), axes), density

"""One draw from every process at once, and where that draw is best: Thompson sampling.

Each draw is one function that the objective may be and one that each constraint may
be. Its best point is evaluated next, so that a point is chosen as often as it may be
the best one.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from camring.numerics.selection import larger
from camring.search.surrogate.gaussian_process import Posterior, correlation, factorise
from camring.search.surrogate.surrogate import Surrogate

LEAST_NOISE = 1e-8  # of the variance: neighbours in a crowd of candidates are nearly one point


def _spread(
    posterior: Posterior,
    points: Float[Array, "many dimension"],
    basis: Float[Array, "many columns"],
    normal: Float[Array, "many draws"],
) -> Float[Array, "many draws"]:
    """Draws of what the process leaves open at the points: the mean is left out.

    Notes
    -----
    Covariance ``signal (C - c R^-1 c' + u (H' R^-1 H)^-1 u')``, whose diagonal is the
    variance of `gaussian_process.predict`.
    """
    observations, hyperparameters = posterior.observations, posterior.hyperparameters
    cross = correlation(points, observations.points, hyperparameters)
    cross = jnp.where(observations.mask[None, :], cross, 0.0)
    whitened = cross @ posterior.inverse_factor.T
    trend = basis - whitened @ posterior.whitened_basis
    trend = jax.scipy.linalg.solve_triangular(posterior.gram_factor, trend.T, lower=True).T
    covariance = correlation(points, points, hyperparameters)
    covariance = covariance - whitened @ whitened.T + trend @ trend.T
    deviation = jnp.sqrt(larger(jnp.diagonal(covariance), 1e-14))
    scaled = covariance / (deviation[:, None] * deviation[None, :])
    count = points.shape[0]
    scaled = jnp.where(jnp.eye(count, dtype=bool), 0.0, scaled)
    factor, _ = factorise(scaled, jnp.ones(count, dtype=bool), jnp.full((), LEAST_NOISE))
    # Where rounding leaves no factor, each point is drawn by itself.
    drawn = jnp.where(jnp.all(jnp.isfinite(factor)), factor @ normal, normal)
    return jnp.sqrt(posterior.signal_variance) * deviation[:, None] * drawn


_spread_once = jax.jit(_spread)


def draws(
    surrogate: Surrogate,
    points: Float[np.ndarray, "many dimension"],
    random: np.random.Generator,
    count: int,
) -> Float[np.ndarray, "count many outputs"]:
    """`count` joint draws of every warped output at the points."""
    means, _ = surrogate.predict(points)
    basis = surrogate.basis(points)
    found = np.empty((count, *means.shape))
    for output in range(surrogate.outputs):
        normal = random.normal(size=(len(points), count))
        posterior = jax.tree.map(lambda leaf, at=output: leaf[at], surrogate.posteriors)
        spread = np.asarray(_spread_once(posterior, points, basis[output], normal))
        found[:, :, output] = (means[:, output : output + 1] + spread).T
    return found


def best_of_draw(
    drawn: Float[np.ndarray, "many outputs"], scale: Float[np.ndarray, " outputs"]
) -> Int[np.ndarray, " many"]:
    """Which points are best in one draw, best first.

    The feasible by objective, then the others by the sum of what they exceed, each
    constraint in units of `scale`. Eriksson and Poloczek (2021), section 3.
    """
    values = np.where(np.isfinite(drawn), drawn, 1e30)
    excess = np.sum(np.maximum(values[:, 1:], 0.0) / scale[1:], axis=1)
    return np.lexsort((values[:, 0], excess))

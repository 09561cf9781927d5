"""Axes along which a function varies much, instead of those of the box.

A sum of squares of a few combinations of all variables is a long valley across
the axes of the box, and lengthscales along those axes cannot describe it. The
gradients of a fitted process show the directions that matter; lengthscales
along these learn the same function from far fewer points.
"""

from collections.abc import Sequence

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from camring.search.surrogate.gaussian_process import (
    Observations,
    Posterior,
    along_axes,
    condition_once,
    correlation,
)
from camring.search.surrogate.likelihood import Fitted, fit, standard_starts

ROUNDS = 2


@jax.jit
def mean_gradients(posterior: Posterior) -> Float[Array, "capacity dimension"]:
    """Gradient of the posterior mean at each row; zero on padded rows.

    The mean is ``coefficients + sum_j c(x, x_j) w_j``, so its gradient along the
    axes is ``sum_j c(x, x_j) w_j (z_j - z) / lengthscale``; no basis enters.
    """
    observations, hyperparameters = posterior.observations, posterior.hyperparameters
    points = observations.points
    pull = correlation(points, points, hyperparameters) * posterior.weights[None, :]
    scaled = along_axes(points, hyperparameters)
    along = (pull @ scaled - jnp.sum(pull, axis=1)[:, None] * scaled) / hyperparameters.lengthscales
    return (along @ hyperparameters.axes.T) * observations.mask[:, None]


def active_axes(observations: Observations, fitted: Fitted) -> tuple[tuple[float, ...], ...]:
    """Eigenvectors of the mean outer product of gradients, least variation first.

    Constantine, Dow and Wang (2014), Active subspace methods in theory and practice.
    """
    posterior = condition_once(observations, fitted.hyperparameters())
    gradients = np.asarray(mean_gradients(posterior))
    _, vectors = np.linalg.eigh(gradients.T @ gradients)
    return tuple(tuple(float(value) for value in row) for row in vectors)


def fit_with_axes(
    observations: Observations, straight: Fitted, density: float, known: Sequence[Fitted] = ()
) -> tuple[Fitted, float]:
    """The given fit, or one along rotated axes where the likelihood is clearly for it.

    Parameters
    ----------
    straight, density
        The best fit along the axes of the box.
    known
        Earlier fits, whose rotated axes are tried too.

    Notes
    -----
    A rotation has d(d-1)/2 angles that no prior restrains, so it must gain two
    in log density for each dimension.
    """
    best, best_density = straight, density
    rotated_density = density + 2.0 * straight.dimension
    for one in known:
        if one.axes is not None:
            tried, tried_density = fit(observations, [one.parameters], one.axes)
            if tried_density > rotated_density:
                rotated_density = tried_density
                best, best_density = tried, tried_density
    latest = best
    for _ in range(ROUNDS):
        axes = active_axes(observations, latest)
        latest, latest_density = fit(observations, standard_starts(best.dimension)[:1], axes)
        if latest_density > rotated_density:
            rotated_density = latest_density
            best, best_density = latest, latest_density
    return best, best_density

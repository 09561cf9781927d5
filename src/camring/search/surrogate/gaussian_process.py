"""Gaussian process regression on arrays padded to a few fixed sizes.

Compiled code is tied to the shapes of its arrays. A data set that grows by one
point per trial would therefore be compiled again at every trial; here it is
padded to the next of a few capacities and the padding is masked out, which
changes no result.

The prior is ``basis @ coefficients`` plus a zero-mean process with the
squared-exponential covariance, one lengthscale per axis, plus noise. The axes
are those of the box or a rotation of them. The
coefficients have a flat prior (universal kriging), so a column of ones is a
fitted constant mean, and a second column is a fitted multiple of some known
approximation. Many independent processes are handled at once under `jax.vmap`.
"""

import math

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jax import lax
from jax.scipy.linalg import solve_triangular
from jaxtyping import Array, Bool, Float

from camring.numerics.quantity import real
from camring.numerics.selection import larger, largest

SMALLEST_CAPACITY = 64
SMALLEST_JITTER = 1e-12
LARGEST_JITTER = 1e-2


class Hyperparameters(eqx.Module):
    """What the marginal likelihood chooses; the signal variance follows in closed form.

    Attributes
    ----------
    lengthscales
        Distance along each axis over which the function changes, in box widths.
    noise_ratio
        Noise variance over signal variance.
    axes
        The directions, as orthonormal columns, that the lengthscales belong to.
    """

    lengthscales: Float[Array, "*outputs dimension"] = eqx.field(converter=real)
    noise_ratio: Float[Array, "*outputs"] = eqx.field(converter=real)
    axes: Float[Array, "*outputs dimension dimension"] = eqx.field(converter=real)


class Observations(eqx.Module):
    """Values at points, padded to a capacity; rows whose mask is false do not count."""

    points: Float[Array, "*outputs capacity dimension"]
    values: Float[Array, "*outputs capacity"]
    basis: Float[Array, "*outputs capacity columns"]
    mask: Bool[Array, "*outputs capacity"]


class Posterior(eqx.Module):
    """A process conditioned on observations, ready to be asked."""

    observations: Observations
    hyperparameters: Hyperparameters
    inverse_factor: Float[Array, "*outputs capacity capacity"]  # L^-1, with R = L L'
    weights: Float[Array, "*outputs capacity"]  # R^-1 (values - basis @ coefficients)
    coefficients: Float[Array, "*outputs columns"]
    whitened_basis: Float[Array, "*outputs capacity columns"]  # L^-1 basis
    gram_factor: Float[Array, "*outputs columns columns"]
    signal_variance: Float[Array, "*outputs"]
    log_determinant: Float[Array, "*outputs"]  # of R
    jitter: Float[Array, "*outputs"]


def capacity_for(count: int) -> int:
    """The padded size that holds `count` rows: 64, 128, 256, 512, and so on."""
    return max(SMALLEST_CAPACITY, 2 ** math.ceil(math.log2(max(count, 1))))


def pad(
    points: Float[np.ndarray, "rows dimension"],
    values: Float[np.ndarray, " rows"],
    basis: Float[np.ndarray, "rows columns"],
    capacity: int,
    mask: Bool[np.ndarray, " rows"] | None = None,
) -> Observations:
    """Rows padded to `capacity`; rows with a false mask or a NaN value are masked out."""
    rows, dimension = points.shape
    if rows > capacity:
        raise ValueError(
            f"{rows} rows do not fit into a capacity of {capacity}: "
            f"ask capacity_for({rows}), which is {capacity_for(rows)}."
        )
    counted = np.zeros(capacity, dtype=bool)
    counted[:rows] = np.isfinite(values) & np.isfinite(basis).all(axis=1)
    if mask is not None:
        counted[:rows] &= mask
    padded_points = np.full((capacity, dimension), 0.5)
    padded_values = np.zeros(capacity)
    padded_basis = np.zeros((capacity, basis.shape[1]))
    padded_points[:rows] = points
    padded_values[:rows] = values
    padded_basis[:rows] = basis
    padded_values[~counted] = 0.0
    padded_basis[~counted] = 0.0
    return Observations(padded_points, padded_values, padded_basis, counted)  # type: ignore[arg-type]


def along_axes(
    points: Float[Array, "many dimension"], hyperparameters: Hyperparameters
) -> Float[Array, "many dimension"]:
    """Coordinates along the axes from the middle of the box, in lengthscales."""
    return ((points - 0.5) @ hyperparameters.axes) / hyperparameters.lengthscales


def correlation(
    first: Float[Array, "many dimension"],
    second: Float[Array, "several dimension"],
    hyperparameters: Hyperparameters,
) -> Float[Array, "many several"]:
    """Squared-exponential correlation with one lengthscale per axis, in (0, 1]."""
    left = along_axes(first, hyperparameters)
    right = along_axes(second, hyperparameters)
    squared_distance = (
        jnp.sum(left**2, axis=1)[:, None] + jnp.sum(right**2, axis=1)[None, :] - 2 * left @ right.T
    )
    return jnp.exp(-0.5 * larger(squared_distance, 0.0))


def masked_correlation(
    observations: Observations, hyperparameters: Hyperparameters
) -> Float[Array, "capacity capacity"]:
    """Noise-free correlation among the rows that count, zero elsewhere, without diagonal.

    The diagonal is left to the caller, who adds ``1 + noise_ratio`` where rows
    count and 1 where they do not.
    """
    points, mask = observations.points, observations.mask
    both = mask[:, None] & mask[None, :] & ~jnp.eye(mask.shape[0], dtype=bool)
    return jnp.where(both, correlation(points, points, hyperparameters), 0.0)


def factorise(
    off_diagonal: Float[Array, "capacity capacity"],
    mask: Bool[Array, " capacity"],
    noise_ratio: Float[Array, ""],
) -> tuple[Float[Array, "capacity capacity"], Float[Array, ""]]:
    """Lower Cholesky factor, and the jitter that it took to have one.

    Coincident points make the matrix singular. Jitter starts at zero and grows
    tenfold until the factorisation succeeds.
    """

    def failed(state: tuple[Array, Array]) -> Array:
        factor, jitter = state
        return ~jnp.all(jnp.isfinite(factor)) & (jitter < LARGEST_JITTER)

    def attempt(state: tuple[Array, Array]) -> tuple[Array, Array]:
        last = state[1]
        jitter = jnp.where(last < 0, 0.0, larger(10 * last, SMALLEST_JITTER))
        diagonal = jnp.where(mask, 1.0 + noise_ratio + jitter, 1.0)
        matrix = off_diagonal + jnp.diag(diagonal)
        return jnp.linalg.cholesky(matrix, symmetrize_input=False), jitter

    untried = jnp.full_like(off_diagonal, jnp.nan)
    return lax.while_loop(failed, attempt, (untried, jnp.full((), -1.0)))


def condition(observations: Observations, hyperparameters: Hyperparameters) -> Posterior:
    """The process given the observations.

    Notes
    -----
    With correlation matrix ``R = C + noise_ratio I`` and basis ``H``:
    coefficients ``(H' R^-1 H)^-1 H' R^-1 y`` (generalised least squares) and
    signal variance ``r' R^-1 r / n`` with ``r = y - H coefficients``, both the
    maximisers of the likelihood. Rasmussen and Williams (2006), sections 2.2, 2.7.
    """
    mask = observations.mask
    off_diagonal = masked_correlation(observations, hyperparameters)
    factor, jitter = factorise(off_diagonal, mask, hyperparameters.noise_ratio)
    # The inverse of the factor costs as much as the factor once, and turns every
    # later solve into a product, which the acquisition needs hundreds of times.
    inverse_factor = solve_triangular(factor, jnp.eye(mask.shape[0]), lower=True)
    whitened_basis = inverse_factor @ observations.basis
    whitened_values = inverse_factor @ observations.values
    gram = whitened_basis.T @ whitened_basis
    # A column that is zero throughout takes no part: its coefficient stays zero.
    unused = jnp.all(observations.basis == 0.0, axis=0)
    gram_factor = jnp.linalg.cholesky(
        gram + jnp.diag(jnp.where(unused, 1.0, 1e-13 * jnp.diagonal(gram)))
    )
    projected = solve_triangular(gram_factor, whitened_basis.T @ whitened_values, lower=True)
    coefficients = solve_triangular(gram_factor, projected, lower=True, trans=1)
    whitened_residual = whitened_values - whitened_basis @ coefficients
    count = larger(jnp.sum(mask), 1)
    # The floor is rounding error: a constant function has no signal to divide by.
    rounding = 1e-30 * largest(observations.values**2) + 1e-300
    signal_variance = larger(whitened_residual @ whitened_residual / count, rounding)
    return Posterior(
        observations=observations,
        hyperparameters=hyperparameters,
        inverse_factor=inverse_factor,
        weights=inverse_factor.T @ whitened_residual,
        coefficients=coefficients,
        whitened_basis=whitened_basis,
        gram_factor=gram_factor,
        signal_variance=signal_variance,
        log_determinant=2 * jnp.sum(jnp.log(jnp.diagonal(factor))),
        jitter=jitter,
    )


def predict(
    posterior: Posterior,
    points: Float[Array, "many dimension"],
    basis: Float[Array, "many columns"],
) -> tuple[Float[Array, " many"], Float[Array, " many"]]:
    """Posterior mean and variance of the noise-free function.

    Notes
    -----
    Variance ``signal (1 - c' R^-1 c + u' (H' R^-1 H)^-1 u)`` with
    ``u = h - H' R^-1 c``; the last term is the uncertainty of the coefficients.
    """
    observations = posterior.observations
    cross = correlation(points, observations.points, posterior.hyperparameters)
    cross = jnp.where(observations.mask[None, :], cross, 0.0)
    mean = basis @ posterior.coefficients + cross @ posterior.weights
    whitened = cross @ posterior.inverse_factor.T
    trend = basis - whitened @ posterior.whitened_basis
    trend_whitened = solve_triangular(posterior.gram_factor, trend.T, lower=True)
    share = 1.0 - jnp.sum(whitened**2, axis=1) + jnp.sum(trend_whitened**2, axis=0)
    return mean, posterior.signal_variance * larger(share, 1e-14)


def leave_one_out(
    posterior: Posterior,
) -> tuple[Float[Array, " capacity"], Float[Array, " capacity"]]:
    """Prediction of each row by all the others, minus its value, and its variance.

    Hyper-parameters and signal variance stay; the coefficients are fitted anew
    without the row. Zero on padded rows.

    Notes
    -----
    With ``Q = R^-1 - R^-1 H (H' R^-1 H)^-1 H' R^-1`` the error is
    ``-(Q y)_i / Q_ii`` and the variance of the noisy value ``signal / Q_ii``.
    Dubrule (1983), Cross validation of kriging in a unique neighborhood.
    """
    mask = posterior.observations.mask
    trend = solve_triangular(posterior.gram_factor, posterior.whitened_basis.T, lower=True)
    projected = trend @ posterior.inverse_factor
    diagonal = jnp.sum(posterior.inverse_factor**2, axis=0) - jnp.sum(projected**2, axis=0)
    diagonal = jnp.where(mask, larger(diagonal, 1e-14), 1.0)
    error = jnp.where(mask, -posterior.weights / diagonal, 0.0)
    return error, jnp.where(mask, posterior.signal_variance / diagonal, 0.0)


condition_once = jax.jit(condition)
leave_one_out_once = jax.jit(leave_one_out)
predict_each = jax.jit(jax.vmap(predict, in_axes=(0, None, 0)))

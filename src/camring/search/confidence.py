"""What a least-squares fit says about its numbers: intervals, correlations, what is not determined.

Everything follows from the residuals and their slopes at the optimum, both divided by
the standard deviations of what was measured: the numbers are treated as if the model
were linear near it. Source: Bates and Watts (1988), chapters 1 and 2; for what cannot be
distinguished, Belsley, Kuh and Welsch (1980), chapter 3.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float
from scipy.stats import chi2, norm
from scipy.stats import t as student

Matrix = Float[np.ndarray, "value number"]

CORRELATED = 0.95
"""Two numbers whose errors are correlated more strongly are not distinguished."""
CONDITION = 30.0
"""Condition index above which a direction counts as untold (Belsley, Kuh and Welsch)."""
SHARE = 0.5
"""Of a number's variance that such a direction must cause for it to be named."""
FLAT = 1e-9
"""Of the steepest number's slopes; flatter ones are rounding."""
SINGULAR = 1e-6
"""Of the largest singular value; smaller ones are rounding in the slopes."""
TOO_UNLIKELY = 0.01
"""Chance of residuals so large with the deviations known, below which these are too small."""


@dataclass(frozen=True, eq=False)
class Confidence:
    """How well residuals determine each number.

    Attributes
    ----------
    scatter
        Root of the weighted sum of squares over the degrees of freedom; about 1 where the
        standard deviations are right.
    standard_error, half_width
        Of each number; infinite where nothing tells it.
    correlation
        Of the errors of each two numbers.
    tangled
        Places of the numbers that are not distinguished, a group each.
    """

    degrees_of_freedom: int
    scatter: float
    standard_error: Float[np.ndarray, " number"]
    half_width: Float[np.ndarray, " number"]
    correlation: Float[np.ndarray, "number number"]
    tangled: tuple[tuple[int, ...], ...]


def confidence(
    residuals: Float[np.ndarray, " value"],
    jacobian: Matrix,
    *,
    known: bool | Bool[np.ndarray, " value"] = False,
    level: float = 0.95,
) -> Confidence:
    """Intervals of the numbers of a fit.

    Parameters
    ----------
    residuals, jacobian
        Each value's residual over its standard deviation, and the derivatives of that.
    known
        Whether the standard deviations were measured, of all or of each value. Where none
        was, only their ratios count and the residuals say how large they are; then, and
        where some were not, intervals are Student's. Known ones give a normal's, and are
        enlarged where residuals are larger than they allow.
    level
        Share of such intervals that hold the true number.

    Raises
    ------
    ValueError
        Unless there are more values than numbers.
    """
    count, numbers = jacobian.shape
    freedom = count - numbers
    if freedom < 1:
        raise ValueError(f"{count} values leave no freedom to determine {numbers} numbers")
    scatter = float(np.sqrt(np.sum(residuals**2) / freedom))
    measured = np.broadcast_to(known, residuals.shape)
    # Where some are known the others were found so that they scatter by one.
    spread = 1.0 if np.any(measured) else scatter
    beyond = np.sum(residuals**2) > chi2.ppf(1 - TOO_UNLIKELY, freedom)
    if beyond:
        spread = max(scatter, spread)
    errors, correlation, tangled = _shape(jacobian)
    with np.errstate(invalid="ignore"):  # no scatter at all, and a number that nothing tells
        errors = np.where(np.isinf(errors), np.inf, spread * errors)
    normal = bool(np.all(measured)) and not beyond
    quantile = (1 + level) / 2
    reach = float(norm.ppf(quantile) if normal else student.ppf(quantile, freedom))
    return Confidence(freedom, scatter, errors, reach * errors, correlation, tangled)


def _shape(jacobian: Matrix) -> tuple[np.ndarray, np.ndarray, tuple[tuple[int, ...], ...]]:
    """Standard errors at scatter one, correlations, and groups that are not distinguished."""
    count = jacobian.shape[1]
    steepness = np.linalg.norm(jacobian, axis=0)
    flat = steepness <= FLAT * np.max(steepness, initial=0.0)
    size = np.where(flat, 1.0, steepness)
    _, found, rotation = np.linalg.svd(np.where(flat, 0.0, jacobian / size))
    values = np.zeros(count)
    values[: len(found)] = found
    least = SINGULAR * np.max(values, initial=0.0) or 1.0
    untold = values < least
    parts = (rotation / np.maximum(values, least)[:, None]) ** 2  # (direction, number)
    covariance = rotation.T @ (rotation / np.maximum(values, least)[:, None] ** 2)
    variance = np.diag(covariance)
    correlation = covariance / np.sqrt(np.outer(variance, variance))
    errors = np.sqrt(variance) / size
    errors[flat | np.any(untold[:, None] & (np.abs(rotation) > 1e-3), axis=0)] = np.inf
    weak = values * CONDITION < np.max(values, initial=0.0)
    groups: list[tuple[int, ...]] = [
        tuple(np.flatnonzero((parts[place] > SHARE * variance) & ~flat).tolist())
        for place in np.flatnonzero(weak)
    ]
    groups += [
        (int(first), int(second))
        for first, second in zip(*np.triu_indices(count, 1), strict=True)
        if abs(correlation[first, second]) > CORRELATED
    ]
    return errors, correlation, _largest(groups)


def _largest(groups: Sequence[tuple[int, ...]]) -> tuple[tuple[int, ...], ...]:
    """The groups of two or more that lie in no other, each once."""
    kept: list[tuple[int, ...]] = []
    for group in sorted(groups, key=len, reverse=True):
        if len(group) > 1 and not any(set(group) <= set(other) for other in kept):
            kept.append(group)
    return tuple(sorted(kept))


def determined(jacobian: Matrix, widest: float) -> Bool[np.ndarray, " number"]:
    """Which numbers these values can tell together, those in front preferred.

    Parameters
    ----------
    jacobian
        Slopes over the standard deviations that are expected.
    widest
        Standard error up to which a number counts as determined.
    """
    chosen: list[int] = []
    for place in range(jacobian.shape[1]):
        tried = [*chosen, place]
        if len(tried) >= jacobian.shape[0]:
            break
        errors, _, tangled = _shape(jacobian[:, tried])
        if np.all(errors < widest) and not tangled:
            chosen = tried
    found = np.zeros(jacobian.shape[1], dtype=bool)
    found[chosen] = True
    return found


def drift(
    residuals: Float[np.ndarray, " value"], along: Float[np.ndarray, " value"] | None = None
) -> float:
    """How strongly residuals follow their neighbours, in standard deviations of pure chance.

    Von Neumann's ratio of successive differences: the order is that of something the
    residuals should not depend on. Above 3 they do.

    Parameters
    ----------
    along
        What the residuals are ordered by; the order they have, unless given. Values nearer
        than `TIED` of the largest are one place, and all orders within it count alike; with
        fewer than three places nothing can be followed.
    """
    count = len(residuals)
    if count < 3 or not np.any(residuals):
        return 0.0
    if along is None:
        differences = float(np.mean(np.diff(residuals) ** 2))
    else:
        order = np.argsort(along, kind="stable")
        sorted_ = along[order]
        breaks = np.flatnonzero(np.diff(sorted_) > TIED * np.max(np.abs(sorted_))) + 1
        groups = np.split(residuals[order], breaks)
        if len(groups) < 3:
            return 0.0
        differences = _mean_difference(groups) / (count - 1)
    ratio = differences / float(np.mean(residuals**2))
    return (2 - ratio) / (2 * float(np.sqrt((count - 2) / (count**2 - 1))))


TIED = 0.02
"""Of the largest: how near two settings of a bench are that were meant to be one."""


def _mean_difference(groups: Sequence[np.ndarray]) -> float:
    """Sum of squared differences of neighbours, its mean over all orders within the groups."""
    within = sum(2 * float(np.sum((each - each.mean()) ** 2)) for each in groups)
    between = sum(
        float(one.var() + other.var() + (one.mean() - other.mean()) ** 2)
        for one, other in pairwise(groups)
    )
    return within + between

"""Which of several scattering numbers is to blame for the scatter of a result.

Two ways: the slopes at the nominal design (first order, exact where the result is
linear in reach of the tolerances), and a linear regression on the samples.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float


class Contributions(NamedTuple):
    """Of one result."""

    variances: Float[np.ndarray, " number"]
    """What each number adds to the variance of the result."""
    explained: float
    """Of the samples' variance, the share that these add up to; may exceed 1 for slopes."""


def by_slopes(
    slopes: Float[np.ndarray, " deviate"],
    owners: Sequence[int],
    samples: Float[np.ndarray, " sample"],
) -> Contributions:
    """From the slopes by standardised, uncorrelated deviates at the nominal design."""
    return _grouped(np.asarray(slopes), owners, samples)


def by_regression(
    deviates: Float[np.ndarray, "sample deviate"],
    samples: Float[np.ndarray, " sample"],
    owners: Sequence[int],
) -> Contributions:
    """From the plane of least squares through the samples.

    Its coefficients squared are the standardised regression coefficients of sensitivity
    analysis times the variance (Saltelli et al. 2008, chapter 1).
    """
    plane = np.column_stack([np.ones(len(samples)), deviates])
    coefficients, *_ = np.linalg.lstsq(plane, samples, rcond=None)
    found = _grouped(coefficients[1:], owners, samples)
    total = float(np.var(samples))
    left = float(np.var(samples - plane @ coefficients))
    return Contributions(found.variances, 1 - left / total if total > 0 else 1.0)


def _grouped(
    slopes: Float[np.ndarray, " deviate"],
    owners: Sequence[int],
    samples: Float[np.ndarray, " sample"],
) -> Contributions:
    variances = np.bincount(owners, weights=slopes**2)
    total = float(np.var(samples))
    return Contributions(variances, float(variances.sum()) / total if total > 0 else 1.0)


__all__ = ["Contributions", "by_regression", "by_slopes"]

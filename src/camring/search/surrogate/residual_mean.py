"""What the process is a correction of: nothing, the approximation, or rho times it.

A cheap approximation of the objective may carry most of its shape. The process
then learns ``objective - rho * approximation``, with rho 0 (plain), 1 (trusted)
or fitted. Which is best is not a matter of belief: the leave-one-out error
tells.
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from jaxtyping import Float

from camring.search.surrogate.gaussian_process import (
    Hyperparameters,
    Observations,
    capacity_for,
    condition_once,
    leave_one_out_once,
    pad,
)
from camring.search.surrogate.warp import Warp


class ResidualMean(StrEnum):
    """Three values of rho in ``objective - rho * approximation``."""

    PLAIN = "plain"
    TRUSTED = "rho = 1"
    FITTED = "fitted rho"


@dataclass(frozen=True)
class LeaveOneOut:
    """How well each row is predicted by all the others.

    Attributes
    ----------
    error
        Root mean square error over the standard deviation of the values: 0 is
        perfect, 1 is no better than the mean.
    rho
        Factor on the approximation.
    """

    error: float
    rho: float


def available(approximation: Float[np.ndarray, " rows"]) -> list[ResidualMean]:
    """The choices that data with this approximation allow."""
    finite = approximation[np.isfinite(approximation)]
    if len(finite) < len(approximation) or len(finite) < 4 or np.ptp(finite) == 0.0:
        return [ResidualMean.PLAIN]
    return list(ResidualMean)


def basis_columns(
    mean: ResidualMean, warped_approximation: Float[np.ndarray, " rows"]
) -> Float[np.ndarray, "rows 2"]:
    """Columns whose coefficients are fitted: one for a constant, one for rho."""
    ones = np.ones_like(warped_approximation)
    if mean is ResidualMean.FITTED:
        return np.column_stack([ones, warped_approximation])
    return np.column_stack([ones, np.zeros_like(ones)])


def offset(
    mean: ResidualMean, warped_approximation: Float[np.ndarray, " rows"]
) -> Float[np.ndarray, " rows"]:
    """What is subtracted before learning and added after predicting."""
    if mean is ResidualMean.TRUSTED:
        return warped_approximation
    return np.zeros_like(warped_approximation)


def observations_of(
    mean: ResidualMean,
    points: Float[np.ndarray, "rows dimension"],
    objective: Float[np.ndarray, " rows"],
    approximation: Float[np.ndarray, " rows"],
    warp: Warp,
) -> Observations:
    """What the process learns under this choice, padded.

    Objective and approximation go through the same warp, so that a perfect
    approximation stays one.
    """
    if mean is ResidualMean.PLAIN:
        approximation = np.zeros_like(objective)
    warped = warp(approximation)
    values = warp(objective) - offset(mean, warped)
    return pad(points, values, basis_columns(mean, warped), capacity_for(len(points)))


def leave_one_out(
    mean: ResidualMean,
    observations: Observations,
    hyperparameters: Hyperparameters,
    warped: Float[np.ndarray, " rows"],
) -> LeaveOneOut:
    """How well this choice predicts the warped objective where it did not look."""
    posterior = condition_once(observations, hyperparameters)
    errors, _ = leave_one_out_once(posterior)
    counted = np.asarray(observations.mask)
    spread = float(np.std(warped[np.isfinite(warped)]))
    error = float(np.sqrt(np.mean(np.asarray(errors)[counted] ** 2)))
    fitted = float(posterior.coefficients[1])
    rho = {ResidualMean.PLAIN: 0.0, ResidualMean.TRUSTED: 1.0, ResidualMean.FITTED: fitted}[mean]
    return LeaveOneOut(error / max(spread, 1e-300), rho)

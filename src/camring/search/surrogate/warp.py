"""Monotone output transforms that make values easier to learn.

An objective over five decades, or a constraint that explodes away from the
feasible region, ruins a stationary Gaussian process. A signed logarithm about
the values that matter is linear near them and compresses the rest; its scale is
chosen by likelihood.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float


@dataclass(frozen=True)
class Warp:
    """``scale * sign(z) log(1 + |z|)`` with ``z = (value - centre)/scale``.

    Slope 1 at the centre, increasing everywhere. An infinite scale is the plain
    shift ``value - centre``. With centre 0 it keeps signs, so a warped
    constraint is feasible exactly where the constraint is; this is the "bilog"
    of Eriksson and Poloczek (2021), Scalable constrained Bayesian optimization.
    """

    centre: float = 0.0
    scale: float = np.inf

    def __call__(self, values: Float[np.ndarray, "*shape"]) -> Float[np.ndarray, "*shape"]:
        """The warped values; NaN stays NaN."""
        shifted = np.asarray(values, dtype=float) - self.centre
        if not np.isfinite(self.scale):
            return shifted
        return self.scale * np.sign(shifted) * np.log1p(np.abs(shifted) / self.scale)

    def undone(self, warped: Float[np.ndarray, "*shape"]) -> Float[np.ndarray, "*shape"]:
        """The values that are so when warped."""
        if np.isfinite(self.scale):
            warped = self.scale * np.sign(warped) * np.expm1(np.abs(warped) / self.scale)
        return np.asarray(warped, dtype=float) + self.centre

    def slope(self, values: Float[np.ndarray, "*shape"]) -> Float[np.ndarray, "*shape"]:
        """Derivative of the warped value with respect to the value, in (0, 1]."""
        if not np.isfinite(self.scale):
            return np.ones_like(np.asarray(values, dtype=float))
        return 1.0 / (1.0 + np.abs(np.asarray(values) - self.centre) / self.scale)

    def log_jacobian(self, values: Float[np.ndarray, " rows"]) -> float:
        """Sum of log slopes: what to add to a likelihood of warped values to compare warps."""
        finite = np.asarray(values)[np.isfinite(values)]
        return float(np.sum(np.log(self.slope(finite))))


def candidate_warps(values: Float[np.ndarray, " rows"], centre: float) -> list[Warp]:
    """The plain shift, and logarithms that bend at the median and at the lowest fifth."""
    distance = np.abs(np.asarray(values)[np.isfinite(values)] - centre)
    distance = distance[distance > 0]
    warps = [Warp(centre)]
    if distance.size >= 4 and np.max(distance) > 3 * np.min(distance):
        scales = np.quantile(distance, [0.5, 0.15])
        warps += [Warp(centre, float(scale)) for scale in scales]
    return warps

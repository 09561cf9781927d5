"""What binding limits cost: multipliers of the first-order conditions."""

import numpy as np
from jaxtyping import Float
from scipy.optimize import nnls


def multipliers(
    objective: Float[np.ndarray, " dimension"],
    binding: Float[np.ndarray, "constraint dimension"],
) -> tuple[Float[np.ndarray, " constraint"], float]:
    """Non-negative factors by which slopes of binding constraints best cancel the objective's.

    Returns
    -------
    The factors: by how much the objective falls, in first order, for each unit by which
    `g <= 0` is relaxed. And the share of the objective's slope that is left; 0 where
    Karush's, Kuhn's and Tucker's conditions hold.
    """
    size = float(np.linalg.norm(objective))
    if size == 0:
        return np.zeros(len(binding)), 0.0
    if not len(binding):
        return np.zeros(0), 1.0
    factors, left = nnls(np.asarray(binding, dtype=float).T, -np.asarray(objective, dtype=float))
    return factors, float(left) / size

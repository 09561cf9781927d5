"""One number of a result from those of all operating points: the worst, or the mean by weights."""

import numpy as np
from jaxtyping import Float

from camring.objective.constraints import OF_ALL_LOBES
from camring.physics.system import System


def point_shares(
    system: System, name: str, values: Float[np.ndarray, "point *sample"]
) -> Float[np.ndarray, "point *sample"]:
    """How much each operating point decides of a result.

    The worst point decides a `max_` or a `min_` alone. Every other result is the mean by the
    points' weights; displacement that of the points at which no lobe idles, where there are
    any: between two modes lies a displacement that the motor never has.
    """
    values = np.asarray(values)
    if name.startswith(("max_", "min_")):
        worst = np.argmax(values, axis=0) if name.startswith("max_") else np.argmin(values, axis=0)
        return (np.arange(len(values)).reshape(-1, *[1] * (values.ndim - 1)) == worst).astype(float)
    weights = np.array([float(each.weight) for each in system.operating_points])
    if name == OF_ALL_LOBES:
        all_work = np.array([not each.idle_lobes for each in system.operating_points])
        weights = weights * all_work if np.any(weights * all_work > 0) else weights
    weights = weights / weights.sum()
    return np.broadcast_to(weights.reshape(-1, *[1] * (values.ndim - 1)), values.shape)


def of_all_points(
    system: System, name: str, values: Float[np.ndarray, "point *sample"]
) -> Float[np.ndarray, " *sample"]:
    """The result itself."""
    return np.sum(point_shares(system, name, values) * values, axis=0)


__all__ = ["of_all_points", "point_shares"]

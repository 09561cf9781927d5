"""The moves of the downhill simplex, as points: no values, no decisions.

A simplex that is clipped at a bound goes flat and never leaves it again. Here it
moves freely in angles whose cosines are the coordinates of the box: beyond a
bound it comes back inside, and a minimum on a bound is a smooth minimum.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float


@dataclass(frozen=True)
class Coefficients:
    """How far each move goes.

    Gao and Han (2012), Implementing the Nelder-Mead simplex algorithm with
    adaptive parameters: the classical values stall in many dimensions.
    """

    reflection: float
    expansion: float
    contraction: float
    shrink: float

    @staticmethod
    def classical() -> "Coefficients":
        """Nelder and Mead (1965)."""
        return Coefficients(1.0, 2.0, 0.5, 0.5)

    @staticmethod
    def adapted_to(dimension: int) -> "Coefficients":
        """Gao and Han's; the classical ones in two dimensions and below."""
        if dimension <= 2:
            return Coefficients.classical()
        return Coefficients(
            1.0, 1.0 + 2.0 / dimension, 0.75 - 0.5 / dimension, 1.0 - 1.0 / dimension
        )


def to_angles(point: Float[np.ndarray, "*shape"]) -> Float[np.ndarray, "*shape"]:
    """Angles, in half turns, that stand for coordinates in [0, 1]."""
    return np.asarray(np.arccos(np.clip(1.0 - 2.0 * np.asarray(point), -1.0, 1.0)) / np.pi)


def to_box(angles: Float[np.ndarray, "*shape"]) -> Float[np.ndarray, "*shape"]:
    """The coordinates in [0, 1] that angles, any real number of half turns, stand for."""
    return np.asarray(np.clip(0.5 - 0.5 * np.cos(np.pi * np.asarray(angles)), 0.0, 1.0))


def start_simplex(
    start: Float[np.ndarray, " dimension"], step: float
) -> Float[np.ndarray, "dimension dimension"]:
    """Angles of the other vertices: one step in the box along each axis, away from a near bound."""
    steps = np.where(start + step <= 1.0, step, -step)
    return to_angles(start + np.diag(steps))


def along(
    worst: Float[np.ndarray, " dimension"],
    others: Float[np.ndarray, "dimension dimension"],
    factor: float,
) -> Float[np.ndarray, " dimension"]:
    """``centroid + factor (centroid - worst)``.

    Factor 1 reflects, more expands, between 0 and 1 contracts outside, below 0 inside.
    """
    centroid = np.mean(others, axis=0)
    return np.asarray(centroid + factor * (centroid - worst))


def shrunk(
    best: Float[np.ndarray, " dimension"],
    others: Float[np.ndarray, "dimension dimension"],
    factor: float,
) -> Float[np.ndarray, "dimension dimension"]:
    """Every other vertex moved towards the best one."""
    return best + factor * (others - best)


def diameter(vertices: Float[np.ndarray, "dimension+1 dimension"]) -> float:
    """The largest distance along any axis from the first vertex."""
    return float(np.max(np.abs(vertices[1:] - vertices[0])))


def flatness(vertices: Float[np.ndarray, "dimension+1 dimension"]) -> float:
    """Smallest over largest extent: 0 when the simplex has lost a direction."""
    extents = np.linalg.svd(vertices[1:] - vertices[0], compute_uv=False)
    return float(extents[-1] / max(extents[0], np.finfo(float).tiny))

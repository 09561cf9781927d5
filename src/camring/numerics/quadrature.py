"""Gauss-Legendre points on the unit interval."""

import numpy as np


def gauss_legendre(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Points in (0, 1) and weights that add up to one; exact to degree 2 count - 1."""
    points, weights = np.polynomial.legendre.leggauss(count)
    return (points + 1) / 2, weights / 2

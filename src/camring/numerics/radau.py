"""Radau IIA with three stages: order 5, L-stable, stiffly accurate.

Ehle (1969); Hairer and Wanner (1996), section IV.5. Sums over the three stages
are written out, so that they fuse with what is around them; arrays run over
stages first and over elements last.
"""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

STAGES = np.array([(4 - 6**0.5) / 10, (4 + 6**0.5) / 10, 1.0])
"""Radau points of an element of unit width."""


def _stage_integrals() -> np.ndarray:
    """Integrals from 0 to each stage of the polynomials that interpolate the stages."""
    powers = np.arange(3)
    integrated = STAGES[:, None] ** (powers + 1) / (powers + 1)
    return integrated @ np.linalg.inv(STAGES[:, None] ** powers)


STAGE_INTEGRALS = _stage_integrals()
"""The Butcher matrix; its last row holds the quadrature weights."""

_TO_POWERS = np.linalg.inv(np.vander(np.concatenate([[0.0], STAGES]), 4, increasing=True))


def element_powers(
    node_state: Float[Array, " element"], stage_state: Float[Array, "3 element"]
) -> Float[Array, "4 element"]:
    """Coefficients of the cubic through an element's start and its three stages."""
    known = [node_state, *stage_state]
    return jnp.stack([combine(row, known) for row in _TO_POWERS])


def combine(factors: np.ndarray, arrays: list[Array]) -> Array:
    """A short linear combination."""
    total = float(factors[0]) * arrays[0]
    for factor, array in zip(factors[1:], arrays[1:], strict=True):
        total = total + float(factor) * array
    return total


def horner(powers: Array | list[Array], fraction: Array) -> Array:
    """A polynomial from its coefficients along the first axis, lowest power first."""
    total = powers[-1]
    for coefficient in powers[-2::-1]:
        total = total * fraction + coefficient
    return total


def solve_stages(matrix: list[list[Array]], *right_sides: list[Array]) -> tuple[list[Array], ...]:
    """Cramer's rule for the 3 x 3 stage systems of all elements at once."""
    (a, b, c), (d, e, f), (g, h, i) = matrix
    cofactors = [
        [e * i - f * h, c * h - b * i, b * f - c * e],
        [f * g - d * i, a * i - c * g, c * d - a * f],
        [d * h - e * g, b * g - a * h, a * e - b * d],
    ]
    scale = 1 / (a * cofactors[0][0] + b * cofactors[1][0] + c * cofactors[2][0])
    return tuple(
        [scale * (row[0] * right[0] + row[1] * right[1] + row[2] * right[2]) for row in cofactors]
        for right in right_sides
    )

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
    """Gaussian elimination for the 3 x 3 stage systems of all elements at once.

    Without exchange of rows: where the rate falls with the state, all three leading minors
    of `1 - width A slope` are sums of positive terms.
    """
    (a, b, c), (d, e, f), (g, h, i) = matrix
    one = 1 / a
    down, further = d * one, g * one
    e, f, h, i = e - down * b, f - down * c, h - further * b, i - further * c
    two = 1 / e
    last = h * two
    three = 1 / (i - last * f)

    def solved(right: list[Array]) -> list[Array]:
        first, second, third = right
        second = second - down * first
        z = three * (third - further * first - last * second)
        y = two * (second - f * z)
        return [one * (first - b * y - c * z), y, z]

    return tuple(solved(right) for right in right_sides)

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
    """Gaussian elimination for the stage systems of all elements at once, written out.

    Of three rows for one equation, of six for two that are coupled. Without exchange of
    rows: where the rate falls with the state, all leading minors of `1 - width A slope`
    are sums of positive terms.
    """
    rows, count = [list(row) for row in matrix], len(matrix)
    inverse: list[Array] = []
    share: list[dict[int, Array]] = []
    for k in range(count):
        inverse.append(1 / rows[k][k])
        share.append({i: rows[i][k] * inverse[k] for i in range(k + 1, count)})
        for i, down in share[k].items():
            rows[i][k + 1 :] = [
                entry - down * above
                for entry, above in zip(rows[i][k + 1 :], rows[k][k + 1 :], strict=True)
            ]

    def solved(right: list[Array]) -> list[Array]:
        found = list(right)
        for k in range(count):
            for i, down in share[k].items():
                found[i] = found[i] - down * found[k]
        for k in reversed(range(count)):
            for j in range(k + 1, count):
                found[k] = found[k] - rows[k][j] * found[j]
            found[k] = inverse[k] * found[k]
        return found

    return tuple(solved(right) for right in right_sides)

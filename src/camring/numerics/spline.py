"""Uniform periodic B-splines of any degree, with exact derivatives.

One period carries `n` control values at equal spacing `h`; control value `j`
acts at `j h`, where the cardinal B-spline it multiplies is centred
(Schoenberg 1946; de Boor 1978). On each knot span the spline is a polynomial
whose coefficients are a fixed matrix times `degree + 1` neighbouring control
values, so derivatives are exact and cost one Horner scheme each.
"""

from fractions import Fraction
from functools import cache
from math import comb, factorial
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Inexact


class Jet(NamedTuple):
    """A function and its first three derivatives at the same places."""

    value: Inexact[Array, "*grid"]
    first: Inexact[Array, "*grid"]
    second: Inexact[Array, "*grid"]
    third: Inexact[Array, "*grid"]


@cache
def basis_matrix(degree: int) -> np.ndarray:
    """Powers of the span coordinate in each basis piece, shape (degree + 1, degree + 1).

    Row `k` holds the coefficients, lowest power first, of `N(t + k)` for
    `t` in [0, 1], `N` being the B-spline on the knots 0, 1, ..., degree + 1:
    `N(x) = 1/p! * sum_j (-1)^j C(p + 1, j) (x - j)_+^p`. Exact rational
    arithmetic; degree 3 gives the familiar (1, 4, 1)/6.
    """
    matrix = np.zeros((degree + 1, degree + 1))
    for piece in range(degree + 1):
        for power in range(degree + 1):
            total = sum(
                Fraction((-1) ** j * comb(degree + 1, j) * comb(degree, power))
                * Fraction(piece - j) ** (degree - power)
                for j in range(piece + 1)
            )
            matrix[piece, power] = float(total / factorial(degree))
    return matrix


def floor_past_rounding(position: Float[Array, "*grid"]) -> Float[Array, "*grid"]:
    """`floor`, counting what lies a hair below a whole number as having reached it.

    A compiler may compute the same position twice with different rounding; at
    a knot, span and remainder would then come from different sides.
    """
    return jnp.floor(position + 1e-9)


def knots(count: int, period: float, degree: int) -> np.ndarray:
    """Where one polynomial piece meets the next, shape (count,), within [0, period)."""
    offset = 0.0 if degree % 2 else 0.5
    return (np.arange(count) + offset) * (period / count)


def evaluate_periodic(
    control: Inexact[Array, " control"],
    angle: Float[Array, "*grid"],
    period: float,
    degree: int,
) -> Jet:
    """The spline and three exact derivatives with respect to the angle.

    Parameters
    ----------
    control
        One period of control values, real or complex, at least `degree + 1` of them.
    angle
        Any real angles; the spline repeats after `period`.
    """
    count = control.shape[-1]
    spacing = period / count
    position = angle / spacing + (degree + 1) / 2
    span = floor_past_rounding(position)
    return evaluate_span(control, span.astype(jnp.int32), position - span, spacing, degree)


def span_powers(
    control: Inexact[Array, " control"], degree: int
) -> Inexact[Array, "control powers"]:
    """Coefficients of each span's polynomial in the span coordinate, lowest power first.

    Row `i` belongs to the span that `evaluate_periodic` numbers `i` modulo the count.
    """
    matrix = basis_matrix(degree)
    shifted = [jnp.roll(control, k) for k in range(degree + 1)]
    return jnp.stack(
        [
            sum(float(matrix[k, power]) * shifted[k] for k in range(degree + 1))
            for power in range(degree + 1)
        ],
        axis=-1,
    )


def evaluate_span(
    control: Inexact[Array, " control"],
    span: Array,
    within: Float[Array, "*grid"],
    spacing: float,
    degree: int,
) -> Jet:
    """The spline at fraction `within` of the numbered knot span.

    At a knot the caller chooses the side: the end of one span (`within = 1`)
    or the start of the next, which matters to the highest derivatives.
    """
    count = control.shape[-1]
    chosen = span_powers(control, degree)[span % count]
    coefficients = [chosen[..., power] for power in range(degree + 1)]
    derivatives = []
    for order in range(4):
        total = jnp.zeros_like(coefficients[0])
        for power in range(degree, order - 1, -1):
            falling = factorial(power) // factorial(power - order)
            total = total * within + falling * coefficients[power]
        derivatives.append(total / spacing**order)
    return Jet(*derivatives)

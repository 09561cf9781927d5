"""Extremes and travel of a piecewise smooth function, found between its samples.

A parabola through three neighbouring samples tells in which element the extreme
lies, a quartic through all five of that element's what it is. The place is held
constant under differentiation, which is exact at an extreme (envelope theorem):
slopes are as good as values.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from camring.numerics.selection import bounded, larger, largest, smaller

EXTREMUM_FRACTIONS = np.linspace(0, 1, 5)
"""Where `maximum` wants its elements sampled: ends, quarters and middle."""

_TO_POWERS = np.linalg.inv(np.vander(EXTREMUM_FRACTIONS, increasing=True))
_NEWTON_STEPS = 3


def maximum(samples: Float[Array, "5 element"]) -> Float[Array, ""]:
    """Maximum over all elements, each sampled at `EXTREMUM_FRACTIONS`.

    Only samples of one element are joined, so a kink between elements is left
    alone.
    """
    tops = vertex_value(samples[:-2], samples[1:-1], samples[2:])
    element = jnp.argmax(largest(jax.lax.stop_gradient(tops), axis=0))
    return quartic_top(samples[:, element])


def minimum(samples: Float[Array, "5 element"]) -> Float[Array, ""]:
    """Minimum over all elements; see `maximum`."""
    return -maximum(-samples)


def quartic_top(samples: Float[Array, " 5"]) -> Float[Array, ""]:
    """Top of the quartic through five samples of one element, beside the largest of them.

    The largest sample itself where it stands at an end and the quartic only rises
    beyond it.
    """
    fixed = jax.lax.stop_gradient(samples)
    best = jnp.argmax(fixed)
    powers = jnp.asarray(_TO_POWERS) @ fixed
    rise, bend = powers[1:] * np.arange(1, 5), powers[2:] * (np.arange(2, 5) * np.arange(1, 4))
    place = best / 4
    low, high = larger(place - 0.25, 0), smaller(place + 0.25, 1)
    at = place
    for _ in range(_NEWTON_STEPS):
        slope = ((rise[3] * at + rise[2]) * at + rise[1]) * at + rise[0]
        curvature = (bend[2] * at + bend[1]) * at + bend[0]
        step = jnp.where(curvature < 0, slope / jnp.where(curvature < 0, curvature, 1), 0)
        at = bounded(at - step, low, high)
    weights = at ** np.arange(5) @ jnp.asarray(_TO_POWERS)
    refined, sampled = weights @ samples, samples[best]
    return jnp.where(refined > sampled, refined, sampled)


def vertex_value(
    before: Float[Array, "*grid"], here: Float[Array, "*grid"], after: Float[Array, "*grid"]
) -> Float[Array, "*grid"]:
    """Top of the parabola through three equidistant values, within their span.

    Where they bend upwards or the top lies outside, the largest of the three.
    """
    slope = (after - before) / 2
    bend = before - 2 * here + after
    offset = -slope / jnp.where(bend < 0, bend, -1.0)
    inside = (bend < 0) & (jnp.abs(offset) <= 1)
    top = here - slope**2 / (2 * jnp.where(bend < 0, bend, -1.0))
    return jnp.where(inside, top, larger(larger(before, after), here))


def total_variation(
    value: Float[Array, "point element"],
    slope: Float[Array, "point element"],
    spacing: Float[Array, " element"],
) -> Float[Array, ""]:
    """All rises and all falls together, from equidistant samples of each element.

    Between two samples with slopes of one sign it is the difference of the values;
    where the slope turns, it is that to and from the turning point of the cubic
    through both values and slopes.
    """
    rise = value[1:] - value[:-1]
    there = rise_to_turn(slope[:-1] * spacing, slope[1:] * spacing, rise)
    return jnp.sum(jnp.abs(there) + jnp.abs(rise - there))


def rise_to_turn(
    start: Float[Array, "*grid"], end: Float[Array, "*grid"], rise: Float[Array, "*grid"]
) -> Float[Array, "*grid"]:
    """What the cubic through both values and slopes rises until its slope changes sign.

    All of its rise where both slopes have one sign.

    Parameters
    ----------
    start, end
        Slopes at both ends, times the element's width.
    rise
        Of the values, from one end to the other.
    """
    turns = start * end < 0
    # Its slope is start + linear t + square t^2; one root lies between 0 and 1.
    square = 3 * (start + end) - 6 * rise
    linear = end - start - square
    # Not below zero but by rounding, where both roots are one: a curve that runs out into a flat.
    discriminant = linear**2 - 4 * square * start
    apart = turns & (discriminant > 0)
    root = jnp.where(apart, jnp.sqrt(jnp.where(apart, discriminant, 1.0)), 0.0)
    half = -(linear + jnp.where(linear < 0, -root, root)) / 2
    one = start / jnp.where(turns, half, 1.0)
    other = half / jnp.where(turns & (square != 0), square, 1.0)
    # A root at an end, one rounding outside, would else be taken for the other, far away.
    turn = bounded(jnp.where((one > 0) & (one < 1), one, other), 0.0, 1.0)
    there = ((square / 3 * turn + linear / 2) * turn + start) * turn
    return jnp.where(turns, there, rise)

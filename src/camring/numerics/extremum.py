"""Largest value and total travel of a piecewise smooth function, found between its samples."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

EXTREMUM_FRACTIONS = np.linspace(0, 1, 5)
"""Where `maximum` wants its elements sampled: ends, quarters and middle."""


def maximum(samples: Float[Array, "5 element"]) -> Float[Array, ""]:
    """Maximum over all elements, each sampled at `EXTREMUM_FRACTIONS`.

    Parabolas through three neighbouring samples of one element refine it, so a
    kink between elements is left alone.
    """
    return jnp.max(vertex_value(samples[:-2], samples[1:-1], samples[2:]))


def minimum(samples: Float[Array, "5 element"]) -> Float[Array, ""]:
    """Minimum over all elements; see `maximum`."""
    return -maximum(-samples)


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
    return jnp.where(inside, top, jnp.maximum(jnp.maximum(before, after), here))


def total_variation(
    value: Float[Array, "point element"],
    slope: Float[Array, "point element"],
    spacing: Float[Array, " element"],
) -> Float[Array, ""]:
    """All rises and all falls together, from equidistant samples of each element.

    Between two samples with slopes of one sign it is the difference of the values;
    where the slope turns, it is taken as linear.
    """
    before, after = slope[:-1], slope[1:]
    turns = before * after < 0
    bend = jnp.where(turns, jnp.abs(after - before), 1.0)
    about_the_turn = spacing * (before**2 + after**2) / (2 * bend)
    return jnp.sum(jnp.where(turns, about_the_turn, jnp.abs(value[1:] - value[:-1])))

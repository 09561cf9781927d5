"""Extremes of cubics on the elements of meshes, side by side (`numerics/batch.py`)."""

import jax.numpy as jnp
from jax.lax import stop_gradient
from jaxtyping import Array, Float

from camring.numerics.radau import element_powers, horner
from camring.numerics.selection import larger, largest


def highest_of_cubics(powers: list[Float[Array, "element batch"]]) -> Float[Array, " batch"]:
    """Largest value of all cubics from 0 to 1, by their coefficients, lowest power first."""
    end = powers[0] + powers[1] + powers[2] + powers[3]
    return _highest(powers, larger(powers[0], end))


def highest_of_samples(values: Float[Array, "4 element batch"]) -> Float[Array, " batch"]:
    """Largest value of the cubics through an element's start and its three points."""
    return _highest(list(element_powers(values[0], values[1:])), largest(values, axis=0))


def _highest(powers: list[Array], best: Float[Array, "element batch"]) -> Float[Array, " batch"]:
    _, first, second, third = powers
    # The slope's roots without cancellation; those outside the element do not count.
    linear, square = 2 * second, 3 * third
    discriminant = linear**2 - 4 * square * first
    turns = discriminant > 0
    root = jnp.where(turns, jnp.sqrt(jnp.where(turns, discriminant, 1)), 0)
    half = -(linear + jnp.where(linear < 0, -root, root)) / 2
    one = half / jnp.where(square == 0, 1, square)
    other = first / jnp.where(half == 0, 1, half)
    # An extreme does not notice, to first order, where it is (envelope theorem).
    for place in (stop_gradient(one), stop_gradient(other)):
        inside = turns & (place > 0) & (place < 1)
        top = horner(powers, place)
        best = jnp.where(inside, larger(best, top), best)
    return largest(best, axis=0)

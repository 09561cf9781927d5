"""Fourier sums of equidistant samples, many waves side by side (`numerics/lanes.py`).

Cosines see what is even about the middle of the period, sines what is odd; and of both,
orders that are even see what is even about the quarter, odd orders what is odd. Samples are
added and subtracted so beforehand, and a quarter of the products is left.
"""

from functools import partial
from math import pi
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

Wave = Float[Array, "place lane"]


class Quarters(NamedTuple):
    """What each kind of order sees, or has: cosines of even and odd orders, then sines."""

    even_cosine: Float[Array, "row lane"]
    odd_cosine: Float[Array, "row lane"]
    even_sine: Float[Array, "row lane"]
    odd_sine: Float[Array, "row lane"]


@partial(jax.custom_jvp, nondiff_argnums=(1,))
def power_of_orders(wave: Wave, orders: int) -> Float[Array, " lane"]:
    """Sum of squared Fourier coefficients of orders 1 to `orders` of a period's samples.

    Their number is a multiple of four, and more than twice the orders.
    """
    return _power(_coefficients(wave, orders))


@power_of_orders.defjvp
def _power_slope(orders: int, primals: tuple, tangents: tuple) -> tuple[Array, Array]:
    # Coefficients are wanted once, however many directions there are.
    wave = primals[0]
    found = _coefficients(wave, orders)
    tables = _tables(wave.shape[0], orders)
    back = [jnp.asarray(2 * t.T) @ each for t, each in zip(tables, found, strict=True)]
    return _power(found), jnp.sum(_unfolded(Quarters(*back)) * tangents[0], axis=0)


def _power(coefficients: Quarters) -> Float[Array, " lane"]:
    parts = [jnp.sum(each**2, axis=0) for each in coefficients]
    return sum(parts[1:], parts[0])


def _coefficients(wave: Wave, orders: int) -> Quarters:
    tables = _tables(wave.shape[0], orders)
    return Quarters(*(jnp.asarray(t) @ w for t, w in zip(tables, _folded(wave), strict=True)))


def _folded(wave: Wave) -> Quarters:
    half = wave.shape[0] // 2
    quarter = half // 2
    ahead, behind = wave[1:half], wave[half + 1 :][::-1]
    even = jnp.concatenate([wave[:1], ahead + behind, wave[half : half + 1]])
    odd = ahead - behind
    near, far = even[:quarter], even[quarter + 1 :][::-1]
    left, right = odd[: quarter - 1], odd[quarter:][::-1]
    return Quarters(
        jnp.concatenate([near + far, even[quarter : quarter + 1]]),
        near - far,
        left - right,
        jnp.concatenate([left + right, odd[quarter - 1 : quarter]]),
    )


def _unfolded(parts: Quarters) -> Wave:
    """The transpose of `_folded`."""
    quarter = parts.odd_cosine.shape[0]
    near = parts.even_cosine[:quarter]
    even = jnp.concatenate(
        [near + parts.odd_cosine, parts.even_cosine[quarter:], (near - parts.odd_cosine)[::-1]]
    )
    left = parts.odd_sine[: quarter - 1]
    odd = jnp.concatenate(
        [left + parts.even_sine, parts.odd_sine[quarter - 1 :], (left - parts.even_sine)[::-1]]
    )
    inner = even[1:-1]
    return jnp.concatenate([even[:1], inner + odd, even[-1:], (inner - odd)[::-1]])


def _tables(count: int, orders: int) -> tuple[np.ndarray, ...]:
    """Shape (order, place) for each of the `Quarters`."""
    quarter = count // 4
    even, odd = np.arange(2, orders + 1, 2), np.arange(1, orders + 1, 2)

    def at(function: np.ufunc, order: np.ndarray, first: int, last: int) -> np.ndarray:
        return function(2 * pi / count * np.outer(order, np.arange(first, last + 1))) / count

    return (
        at(np.cos, even, 0, quarter),
        at(np.cos, odd, 0, quarter - 1),
        at(np.sin, even, 1, quarter - 1),
        at(np.sin, odd, 1, quarter),
    )

"""Fourier sums of equidistant samples, many waves side by side (`numerics/batch.py`).

Two stages of a fast transform (Cooley and Tukey 1965), as products with known matrices:
samples a whole number of parts apart first, then what lies within a part. Of the real
wave's orders, `k` and `-k` come from the same sums.
"""

from functools import lru_cache, partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

Wave = Float[Array, "place batch"]


class Tables(NamedTuple):
    """What is known beforehand for `part * parts` samples."""

    across: Float[np.ndarray, "both part"]
    """Cosines, then minus sines, of each remainder of an order by the number of parts."""
    cosine: Float[np.ndarray, "place remainder 1"]
    sine: Float[np.ndarray, "place remainder 1"]
    within: Float[np.ndarray, "both place"]
    """Cosines, then sines, of each quotient."""
    ahead: Float[np.ndarray, "quotient remainder 1"]
    """Where quotient times parts plus remainder is an order that counts, the power of it that a
    derivative brings: one without. Else nil."""
    behind: Float[np.ndarray, "quotient remainder 1"]
    """The same with the remainder taken off."""


class Sums(NamedTuple):
    """Of real and imaginary parts times cosines and sines, shape (quotient, remainder, batch)."""

    real_cosine: Array
    real_sine: Array
    imaginary_cosine: Array
    imaginary_sine: Array


@partial(jax.custom_jvp, nondiff_argnums=(1, 2))
def power_of_orders(wave: Wave, orders: int, derivative: int = 0) -> Float[Array, " batch"]:
    """Sum of squared Fourier coefficients of orders 1 to `orders` of a period's samples.

    There must be more than twice as many samples as orders.

    Parameters
    ----------
    derivative
        Which derivative of the wave counts, by the angle of which a period has `2 pi`.
    """
    tables = _tables(wave.shape[0], orders, derivative)
    ahead, behind = _coefficients(_sums(wave, tables), tables)
    return jnp.sum(sum(each**2 for each in (*ahead, *behind)), axis=(0, 1))


@power_of_orders.defjvp
def _power_slope(
    orders: int, derivative: int, primals: tuple[Any, ...], tangents: tuple[Any, ...]
) -> tuple[Array, Array]:
    # The gradient once, by the transposes of all stages, however many directions there are.
    (wave,) = primals
    tables = _tables(wave.shape[0], orders, derivative)
    (real, imaginary), (real_behind, imaginary_behind) = ahead, behind = _coefficients(
        _sums(wave, tables), tables
    )
    power = jnp.sum(sum(each**2 for each in (*ahead, *behind)), axis=(0, 1))
    real, imaginary = real * tables.ahead, imaginary * tables.ahead
    real_behind, imaginary_behind = real_behind * tables.behind, imaginary_behind * tables.behind
    sums = Sums(
        real + real_behind,
        imaginary_behind - imaginary,
        imaginary + imaginary_behind,
        real - real_behind,
    )
    return power, jnp.sum(2 * _wave(sums, tables) * tangents[0], axis=0)


def _sums(wave: Wave, tables: Tables) -> Sums:
    parts = tables.across.shape[1]
    both = _product(tables.across, wave.reshape(parts, -1, wave.shape[-1]))
    half = both.shape[0] // 2
    real, imaginary = (jnp.swapaxes(each, 0, 1) for each in (both[:half], both[half:]))
    turned = (
        real * tables.cosine + imaginary * tables.sine,
        imaginary * tables.cosine - real * tables.sine,
    )
    found = [_product(tables.within, each) for each in turned]
    count = tables.ahead.shape[0]
    return Sums(found[0][:count], found[0][count:], found[1][:count], found[1][count:])


def _wave(sums: Sums, tables: Tables) -> Wave:
    """The transpose of `_sums`."""
    back = tables.within.T
    real = _product(back, jnp.concatenate([sums.real_cosine, sums.real_sine]))
    imaginary = _product(back, jnp.concatenate([sums.imaginary_cosine, sums.imaginary_sine]))
    turned = (
        real * tables.cosine - imaginary * tables.sine,
        real * tables.sine + imaginary * tables.cosine,
    )
    both = jnp.concatenate([jnp.swapaxes(each, 0, 1) for each in turned])
    found = _product(tables.across.T, both)
    return found.reshape(-1, found.shape[-1])


def _product(matrix: np.ndarray, rows: Array) -> Array:
    return jnp.tensordot(jnp.asarray(matrix), rows, axes=1)


def _coefficients(sums: Sums, tables: Tables) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Real and imaginary parts of the orders that count, remainders added and taken off."""
    ahead = (sums.real_cosine + sums.imaginary_sine, sums.imaginary_cosine - sums.real_sine)
    behind = (sums.real_cosine - sums.imaginary_sine, sums.imaginary_cosine + sums.real_sine)
    return (
        (ahead[0] * tables.ahead, ahead[1] * tables.ahead),
        (behind[0] * tables.behind, behind[1] * tables.behind),
    )


@lru_cache(maxsize=32)
def _tables(count: int, orders: int, derivative: int) -> Tables:
    parts = _parts(count, orders)
    remainder = np.arange(parts // 2 + 1)
    quotient = np.arange((orders + parts // 2) // parts + 1)
    place = np.arange(count // parts)
    across = 2 * np.pi / parts * np.outer(remainder, np.arange(parts))
    turn = 2 * np.pi / count * np.outer(place, remainder)[..., None]
    within = 2 * np.pi * parts / count * np.outer(quotient, place)
    ahead = parts * quotient[:, None] + remainder
    behind = parts * quotient[:, None] - remainder
    twice = (remainder == 0) | (2 * remainder == parts)  # the same orders as ahead
    return Tables(
        np.concatenate([np.cos(across), -np.sin(across)]) / count,
        np.cos(turn),
        np.sin(turn),
        np.concatenate([np.cos(within), np.sin(within)]),
        _counts(ahead, orders, derivative),
        _counts(np.where(twice, 0, behind), orders, derivative),
    )


def _counts(
    order: np.ndarray, orders: int, derivative: int
) -> Float[np.ndarray, "quotient remainder 1"]:
    counts = (order >= 1) & (order <= orders)
    return np.where(counts, order.astype(float) ** derivative, 0.0)[..., None]


def _parts(count: int, orders: int) -> int:
    """How many parts take the fewest products in both stages."""
    divisors = [parts for parts in range(1, count + 1) if count % parts == 0]
    return min(divisors, key=lambda parts: count * (parts + 2 + 2 * orders / parts))

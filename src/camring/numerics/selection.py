"""Larger, smaller, largest and smallest, with slopes that no rounding takes away.

JAX differentiates a maximum by asking which number *equals* it. A compiler that computes a
number twice, once with a fused multiply-add and once without, finds that none does, and the slope
is lost: on some processors, in some programs, for some of the samples. Here the comparison
asks which number is larger, and a number that misses the largest by rounding counts as it.
"""

from typing import Any

import jax
import jax.numpy as jnp
from jax.typing import ArrayLike
from jaxtyping import Array, Bool, Float

_SAME = 1e-9
"""Of the range of the numbers: what is nearer to the largest counts as the largest."""
_ROUNDING = 1e-14
"""The same, of the largest itself, for numbers that are all alike."""


def larger(one: ArrayLike, other: ArrayLike) -> Array:
    """The larger of two, element by element; where they are equal both slopes count half."""
    numbers = _alike(one, other)
    return _larger(*numbers) if _has_slopes(numbers[0]) else jnp.maximum(*numbers)


def smaller(one: ArrayLike, other: ArrayLike) -> Array:
    """The smaller of two, element by element; see `larger`."""
    numbers = _alike(one, other)
    return _smaller(*numbers) if _has_slopes(numbers[0]) else jnp.minimum(*numbers)


def bounded(value: ArrayLike, low: ArrayLike | None, high: ArrayLike | None = None) -> Array:
    """Not below `low` and not above `high`; None bounds nothing."""
    found = jnp.asarray(value)
    if low is not None:
        found = larger(found, low)
    return found if high is None else smaller(found, high)


def largest(values: Array, axis: int | tuple[int, ...] | None = None) -> Array:
    """The largest along some axes; the slope is the mean of those that are it."""
    return _largest(values, axis) if _has_slopes(values) else jnp.max(values, axis=axis)


def smallest(values: Array, axis: int | tuple[int, ...] | None = None) -> Array:
    """The smallest along some axes; see `largest`."""
    return -largest(-values, axis)


def _has_slopes(values: Array) -> bool:
    return jnp.issubdtype(values.dtype, jnp.floating)


def _alike(one: ArrayLike, other: ArrayLike) -> tuple[Array, Array]:
    kind = jnp.result_type(one, other)
    return jnp.asarray(one, kind), jnp.asarray(other, kind)


@jax.custom_jvp
def _larger(one: Array, other: Array) -> Array:
    return jnp.maximum(one, other)


@jax.custom_jvp
def _smaller(one: Array, other: Array) -> Array:
    return jnp.minimum(one, other)


def _chosen(
    first: Bool[Array, "*grid"], second: Bool[Array, "*grid"], slopes: tuple[Any, ...]
) -> Array:
    one, other = slopes
    return jnp.where(first, one, jnp.where(second, other, (one + other) / 2))


@_larger.defjvp
def _larger_slope(numbers: tuple[Any, ...], slopes: tuple[Any, ...]) -> tuple[Array, Array]:
    one, other = numbers
    return _larger(one, other), _chosen(one > other, other > one, slopes)


@_smaller.defjvp
def _smaller_slope(numbers: tuple[Any, ...], slopes: tuple[Any, ...]) -> tuple[Array, Array]:
    one, other = numbers
    return _smaller(one, other), _chosen(one < other, other < one, slopes)


def _largest(values: Float[Array, "*grid"], axis: int | tuple[int, ...] | None) -> Array:
    @jax.custom_jvp
    def found(values: Array) -> Array:
        return jnp.max(values, axis=axis)

    @found.defjvp
    def slope(numbers: tuple[Any, ...], slopes: tuple[Any, ...]) -> tuple[Array, Array]:
        (values,), (slopes_of_all,) = numbers, slopes
        top = jnp.max(values, axis=axis, keepdims=True)
        span = top - jnp.min(values, axis=axis, keepdims=True)
        near = jnp.where(jnp.isfinite(span), _SAME * span, 0) + _ROUNDING * jnp.abs(top)
        counted = (values >= top - near) | (values == top)
        total = jnp.sum(jnp.where(counted, slopes_of_all, 0), axis=axis)
        return found(values), total / jnp.sum(counted, axis=axis)

    return found(values)

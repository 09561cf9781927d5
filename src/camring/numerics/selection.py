"""Larger, smaller, largest and smallest, with slopes that no rounding takes away.

JAX differentiates a maximum by asking which number *equals* it. A compiler that computes a
number twice, once with a fused multiply-add and once without, finds that none does, and the slope
is lost: on some processors, in some programs, for some of the samples. Here the comparison
asks which number is larger, and a number that misses the largest by rounding counts as it.
"""

from collections.abc import Callable
from functools import partial

import jax
import jax.numpy as jnp
from jax.typing import ArrayLike
from jaxtyping import Array, Float

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


def _selection(
    choose: Callable[[Array, Array], Array], goes_first: Callable[[Array, Array], Array]
) -> Callable[[Array, Array], Array]:
    """One of two numbers, whose slope is that of the one that goes first."""

    @jax.custom_jvp
    def chosen(one: Array, other: Array) -> Array:
        return choose(one, other)

    @chosen.defjvp
    def slope(numbers: tuple[Array, Array], slopes: tuple[Array, Array]) -> tuple[Array, Array]:
        (one, other), (along_one, along_other) = numbers, slopes
        of_equal = jnp.where(goes_first(other, one), along_other, (along_one + along_other) / 2)
        return chosen(one, other), jnp.where(goes_first(one, other), along_one, of_equal)

    return chosen


_larger = _selection(jnp.maximum, jnp.greater)
_smaller = _selection(jnp.minimum, jnp.less)


@partial(jax.custom_jvp, nondiff_argnums=(1,))
def _largest(values: Float[Array, "*grid"], axis: int | tuple[int, ...] | None) -> Array:
    return jnp.max(values, axis=axis)


@_largest.defjvp
def _largest_slope(
    axis: int | tuple[int, ...] | None, numbers: tuple[Array], slopes: tuple[Array]
) -> tuple[Array, Array]:
    (values,), (along,) = numbers, slopes
    top = jnp.max(values, axis=axis, keepdims=True)
    span = top - jnp.min(values, axis=axis, keepdims=True)
    near = jnp.where(jnp.isfinite(span), _SAME * span, 0) + _ROUNDING * jnp.abs(top)
    counted = (values >= top - near) | (values == top)
    total = jnp.sum(jnp.where(counted, along, 0), axis=axis)
    return _largest(values, axis), total / jnp.sum(counted, axis=axis)

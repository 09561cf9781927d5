"""What is known before anything runs, computed by NumPy.

JAX would compile a program for every step and shape: hundreds of small ones. Only steps
that both compute to the last bit alike stand here (but for numbers below 2.2e-308, which JAX
takes for nil); for the others JAX is asked.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

Known = np.ndarray


def _iota(*, shape: tuple[int, ...], dimension: int, dtype: Any, **_: Any) -> Known:
    along = [1] * len(shape)
    along[dimension] = shape[dimension]
    return np.broadcast_to(np.arange(shape[dimension], dtype=dtype).reshape(along), shape)


def _broadcast(
    value: Known, *, shape: tuple[int, ...], broadcast_dimensions: tuple[int, ...], **_: Any
) -> Known:
    lead = [1] * len(shape)
    for axis, size in zip(broadcast_dimensions, value.shape, strict=True):
        lead[axis] = size
    return np.broadcast_to(value.reshape(lead), shape)


def _sliced(
    value: Known,
    *,
    start_indices: tuple[int, ...],
    limit_indices: tuple[int, ...],
    strides: tuple[int, ...] | None,
) -> Known:
    steps = strides or (1,) * value.ndim
    return value[tuple(map(slice, start_indices, limit_indices, steps))]


def _chosen(choice: Known, no: Known, *more: Known, **_: Any) -> Known:
    """By truths or by numbers, one for each place or one for all."""
    return np.choose(choice.astype(int), [no, *more]) if more else no


def _reshaped(
    value: Known, *, new_sizes: tuple[int, ...], dimensions: tuple[int, ...] | None = None, **_: Any
) -> Known:
    return (value if dimensions is None else value.transpose(dimensions)).reshape(new_sizes)


def _plain(function: Callable[..., Any]) -> Callable[..., Any]:
    """Without what a step's parameters say of devices and of types, which the caller knows;
    silent, as JAX is, where numbers grow too large."""

    def found(*given: Known, **_: Any) -> Known:
        with np.errstate(all="ignore"):
            return function(*given)

    return found


PLAIN: dict[str, Callable[..., Any]] = {
    "add": _plain(np.add),
    "sub": _plain(np.subtract),
    "mul": _plain(np.multiply),
    "neg": _plain(np.negative),
    "abs": _plain(np.abs),
    "lt": _plain(np.less),
    "le": _plain(np.less_equal),
    "gt": _plain(np.greater),
    "ge": _plain(np.greater_equal),
    "eq": _plain(np.equal),
    "ne": _plain(np.not_equal),
    "and": _plain(np.bitwise_and),
    "or": _plain(np.bitwise_or),
    "select_n": _chosen,
    "iota": _iota,
    "broadcast_in_dim": _broadcast,
    "slice": _sliced,
    "reshape": _reshaped,
    "squeeze": lambda value, *, dimensions, **_: np.squeeze(value, dimensions),
    "transpose": lambda value, *, permutation, **_: value.transpose(permutation),
    "concatenate": lambda *given, dimension, **_: np.concatenate(given, dimension),
    "rev": lambda value, *, dimensions, **_: np.flip(value, dimensions),
}
"""By the names of JAX's primitives."""

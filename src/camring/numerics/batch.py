"""Arrays whose last axis counts independent problems: a member for each.

A processor works on four or eight neighbouring numbers as fast as on one, a graphics
card on thousands. What is done to every problem alike therefore runs fastest when the
problems lie side by side along the last axis, and whatever else an array has (rows,
elements, points) lies before it. Plain arithmetic needs no change for that; this
file holds what does: finding, taking and sorting along the first axis, each member by
itself.
"""

import jax.numpy as jnp
import numpy as np
from jax import lax
from jaxtyping import Array, Float, Int

from camring.numerics.selection import bounded, smaller


def take(
    rows: Float[Array, "row batch"], number: Int[Array, "*grid batch"]
) -> Float[Array, "*grid batch"]:
    """In each member the rows of these numbers, which must be within range."""
    wanted = number.reshape(-1, number.shape[-1])
    found = jnp.take_along_axis(rows, wanted, axis=0, mode="promise_in_bounds")
    return found.reshape(number.shape)


def locate(
    ascending: Float[Array, "row batch"], value: Float[Array, "wanted batch"]
) -> Int[Array, "wanted batch"]:
    """Number of the last row not above each value; 0 where all are above it.

    Bisection: as many takes as the number of rows has binary digits.
    """
    count = ascending.shape[0]
    found = jnp.zeros(value.shape, jnp.int32)
    step = 1 << (count - 1).bit_length() >> 1
    while step:
        probe = found + step
        reached = take(ascending, smaller(probe, count - 1)) <= value
        found = jnp.where((probe < count) & reached, probe, found)
        step >>= 1
    return found


_IN_EACH_MEMBER = lax.ScatterDimensionNumbers(
    update_window_dims=(),
    inserted_window_dims=(0,),
    scatter_dims_to_operand_dims=(0,),
    operand_batching_dims=(1,),
    scatter_indices_batching_dims=(1,),
)


def reached(number: Int[Array, "one batch"], rows: int) -> Int[Array, "row batch"]:
    """How many of each member's numbers are not above the number of each of so many rows.

    Where it can be said at which row each of some thresholds is passed, this finds all
    rows' thresholds at once, without a search.
    """
    within = bounded(number, 0, rows).astype(jnp.int32)
    ones = jnp.ones_like(within)
    counts = lax.scatter_add(
        jnp.zeros((rows + 1, number.shape[-1]), jnp.int32),
        within[..., None],
        ones,
        _IN_EACH_MEMBER,
        mode="promise_in_bounds",
    )
    return jnp.cumsum(counts[:-1], axis=0)


def interpolate(
    value: Float[Array, "wanted batch"],
    ascending: Float[Array, "row batch"],
    results: Float[Array, "row batch"],
) -> Float[Array, "wanted batch"]:
    """Piecewise linear interpolation on rows that may coincide; constant beyond the ends."""
    before = smaller(locate(ascending, value), ascending.shape[0] - 2)
    low, start = take(ascending, before), take(results, before)
    gap, rise = take(ascending, before + 1) - low, take(results, before + 1) - start
    share = jnp.where(gap > 0, (value - low) / jnp.where(gap > 0, gap, 1), 0)
    return start + bounded(share, 0, 1) * rise


def ascending_rows(
    rows: Float[Array, "row batch"], *carried: Float[Array, "row batch"]
) -> tuple[Float[Array, "row batch"], ...]:
    """Each member's few rows in order, and what is carried with them.

    By counting how many rows lie before each: quadratic in their number, but without a
    branch. Equal rows stay in the order in which they are given.
    """
    number = np.arange(rows.shape[0])
    earlier = jnp.asarray(number[None, :] < number[:, None])[..., None]
    before = (rows[None] < rows[:, None]) | ((rows[None] == rows[:, None]) & earlier)
    rank = jnp.sum(before, axis=1)
    return tuple(
        jnp.stack([jnp.sum(jnp.where(rank == place, each, 0), axis=0) for place in number])
        for each in (rows, *carried)
    )


def running_total(rows: Float[Array, "row batch"]) -> Float[Array, "row_and_one batch"]:
    """Sums of all rows before each, and of all."""
    return jnp.concatenate([jnp.zeros_like(rows[:1]), jnp.cumsum(rows, axis=0)])

"""Newton on the stage states of a whole period at once, held back where it leaps."""

from collections.abc import Callable
from typing import Any, TypeVar

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from camring.numerics.selection import smaller

Stages = TypeVar("Stages")


def damped_newton(
    improved: Callable[[Stages], Stages],
    share: Callable[[Stages, Stages], Float[Array, "*batch"]],
    stages: Stages,
    tolerance: float | Float[Array, ""],
    limit: int,
) -> tuple[Stages, Int[Array, ""]]:
    """Stages at which Newton's step is small, and how many steps it took.

    Against a rate like a root with its sign, which turns steep where a flow
    reverses, Newton leaps to and fro for ever. A stage whose step turns back
    without shrinking takes half of it, and wins its full step back later.

    Where problems lie side by side, each stops by its own step: what it ends with is, to
    the last bit, the same beside any others. One that has no number any more stops too.

    Parameters
    ----------
    improved
        One full Newton step.
    share
        How large a step is against the range of the stages that it leads to. One number,
        or one for each member where problems lie side by side along the last axis.
    stages
        One array, or a tree of several.
    limit
        Steps at most; so many are a sign that it is lost.
    """

    def unfinished(carry: tuple[Any, ...]) -> Array:
        _, _, _, size, count = carry
        return jnp.any(size > tolerance) & (count < limit)

    def improve(carry: tuple[Any, ...]) -> tuple[Any, ...]:
        current, before, part, size, count = carry
        updated = improved(current)
        step = jax.tree.map(jnp.subtract, updated, current)
        part = jax.tree.map(_part, step, before, part)
        going = size > tolerance

        def onward(at: Array, part: Array, step: Array) -> Array:
            return jnp.where(going, at + part * step, at)

        moved = jax.tree.map(onward, current, part, step)
        return moved, step, part, jnp.where(going, share(step, updated), size), count + 1

    start = stages, jax.tree.map(jnp.zeros_like, stages), jax.tree.map(jnp.ones_like, stages)
    sizes = jax.eval_shape(share, stages, stages)
    stages, _, _, _, count = jax.lax.while_loop(
        unfinished, improve, (*start, jnp.full(sizes.shape, jnp.inf), jnp.asarray(0))
    )
    return stages, count


def _part(step: Array, before: Array, part: Array) -> Array:
    """Of its step that each stage takes, after the step before."""
    leaps = (step * before < 0) & (2 * jnp.abs(step) > jnp.abs(before))
    return jnp.where(leaps, part / 2, smaller(2 * part, 1))

"""Newton on the stage states of a whole period at once, held back where it leaps."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

Stages = Float[Array, "*stages"]


def damped_newton(
    improved: Callable[[Stages], Stages],
    extent: Callable[[Stages], Float[Array, "*lane"]],
    stages: Stages,
    tolerance: float | Float[Array, ""],
    limit: int,
) -> tuple[Stages, Int[Array, ""]]:
    """Stages at which Newton's step is small, and how many steps it took.

    Against a rate like a root with its sign, which turns steep where a flow
    reverses, Newton leaps to and fro for ever. A stage whose step turns back
    without shrinking takes half of it, and wins its full step back later.

    Parameters
    ----------
    improved
        One full Newton step.
    extent
        What a step is measured against: `tolerance` is a share of it. One number, or one
        for each lane where problems lie side by side along the last axis; the worst decides.
    limit
        Steps at most; so many are a sign that it is lost.
    """

    def unfinished(carry: tuple) -> Array:
        _, _, _, size, count = carry
        return (size > tolerance) & (count < limit)

    def improve(carry: tuple) -> tuple:
        current, before, share, _, count = carry
        updated = improved(current)
        step = updated - current
        leaps = (step * before < 0) & (2 * jnp.abs(step) > jnp.abs(before))
        share = jnp.where(leaps, share / 2, jnp.minimum(2 * share, 1))
        size = jnp.max(jnp.max(jnp.abs(step), axis=(0, 1)) / extent(updated))
        return current + share * step, step, share, size, count + 1

    start = (stages, jnp.zeros_like(stages), jnp.ones_like(stages))
    stages, _, _, _, count = jax.lax.while_loop(
        unfinished, improve, (*start, jnp.asarray(jnp.inf), jnp.asarray(0))
    )
    return stages, count

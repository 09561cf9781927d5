"""Making the compiler store what several loops read."""

from typing import TypeVar

import jax
import jax.numpy as jnp
from jax.lax import cond

Values = TypeVar("Values")


def computed_once(values: Values) -> Values:
    """The same arrays, stored before anything goes on with them.

    The compiler writes the computation of an array into every loop that reads it, and
    forgets its own barriers (`optimization_barrier`) before it does so. It does not
    look through a branch; so here is one, whose other side is never taken: no number's
    modulus is below minus one, and a NaN is below nothing. Where a predicate is batched
    (`vmap`) the branch becomes a selection and nothing is stored.
    """
    number = next(
        leaf for leaf in jax.tree.leaves(values) if jnp.issubdtype(leaf.dtype, jnp.floating)
    )
    never = jnp.abs(number.ravel()[0]) < -1

    def other(given: Values) -> Values:
        return jax.tree.map(lambda leaf: jnp.full_like(leaf, 0), given)

    return cond(never, other, lambda given: given, values)

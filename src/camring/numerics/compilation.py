"""What the compiler must know: what to store, and what is one program."""

from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

import equinox as eqx
import jax
import jax.numpy as jnp
from jax.lax import cond

Values = TypeVar("Values")
Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


def one_program(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """The function, compiled whole where it is called by itself, on numbers.

    JAX would compile each of its operations, of which a spline has thirty, for every shape of
    arrays, some hundredths of a second each. Within a traced function nothing is changed:
    the operations stand there as if the function were not marked.
    """
    jitted: Any = eqx.filter_jit  # its types know no options of `jax.jit`
    found: Callable[Arguments, Result] = jitted(function, inline=True)
    return found


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

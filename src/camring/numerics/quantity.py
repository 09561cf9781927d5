"""Units in annotations, and the float64 arrays that carry them.

`Q[Float[Array, "*grid"], "Pa"]` says shape and unit of a number at the place
where it is declared. Nothing converts units inside the program (everything is
SI); the annotation is documentation that a test makes true by rescaling the
metre, the kilogram and the second.
"""

from typing import Annotated as Q

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float
from jaxtyping import ArrayLike as ArrayLike

# JAX writes no types for this one.
jax.config.update("jax_enable_x64", True)  # type: ignore[no-untyped-call]

__all__ = ["Q", "real", "real_if_given"]


def real(value: ArrayLike) -> Float[Array, "..."]:
    """The value as a float64 array: the converter of every number a noun holds."""
    if isinstance(value, float | int | np.ndarray | np.generic):
        value = np.asarray(value, dtype=np.float64)  # JAX would compile a program to convert it
    return jnp.asarray(value, dtype=jnp.float64)


def real_if_given(value: ArrayLike | None) -> Float[Array, "..."] | None:
    """The same for a number that may be left out, where its law then takes a plainer form."""
    return None if value is None else real(value)

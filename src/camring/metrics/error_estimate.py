"""How wrong results may be, from a second look at a coarser resolution."""

import equinox as eqx
import jax
import jax.numpy as jnp

from camring.metrics.summary import Metrics

FACTOR = 3
"""How many times that difference is claimed: extremes and ripples need not shrink evenly."""

FLOOR = 1.5e-5
"""Share of a result below which two meshes may agree by chance."""


@eqx.filter_jit
def error_estimate(results: Metrics, coarser: Metrics) -> Metrics:
    """Absolute error of each result: several times what a coarser mesh changes, and a floor.

    The coarser mesh (`Resolution.second_look`) has about four times the error, so
    the difference is mostly its own and overstates that of the finer mesh. Extremes
    move by less regular steps, hence the factor; the floor stands for places where
    both happen to agree. Both numbers are measured: against the independent solver,
    on sound and on awkward random motors (docs/notes/verification.md).
    """
    return jax.tree.map(
        lambda fine, coarse: FACTOR * jnp.abs(fine - coarse) + FLOOR * jnp.abs(fine),
        results,
        coarser,
    )

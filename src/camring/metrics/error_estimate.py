"""How wrong results may be, from a second look at half the resolution."""

import equinox as eqx
import jax
import jax.numpy as jnp

from camring.metrics.summary import Metrics

FLOOR = 3e-6
"""Share of a result below which two meshes may agree by chance."""


@eqx.filter_jit
def error_estimate(results: Metrics, halved: Metrics) -> Metrics:
    """Absolute error of each result: what halving the mesh changes, and a floor.

    The coarser mesh is the less accurate one by far (the pressure solver is of
    order five), so the difference is mostly its own error and overstates that
    of the finer mesh; the floor stands for places where both happen to agree.
    """
    return jax.tree.map(
        lambda fine, coarse: jnp.abs(fine - coarse) + FLOOR * jnp.abs(fine), results, halved
    )

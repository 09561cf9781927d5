"""Nodes where the solution itself meets a kink of its equation.

A rate may have a corner at a certain state, wherever the solution comes to be
there: no breakpoint knows that place beforehand. Each refinement of the mesh
finds it on the solution before and moves the nearest free node onto it, so
that no element holds the corner and the method keeps its order.
"""

import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.numerics.mesh import Mesh
from camring.numerics.selection import bounded, larger

BISECTIONS, NEWTON_STEPS = 3, 4


def crossings(
    mesh: Mesh, powers: Float[Array, "4 element"], level: Float[Array, ""]
) -> Float[Array, " element"]:
    """Where each element's cubic passes the level; NaN in elements that do not."""
    constant, first, second, third = powers
    start = constant - level
    end = start + first + second + third

    def height(fraction: Array) -> Array:
        return ((third * fraction + second) * fraction + first) * fraction + start

    low, high = jnp.zeros_like(start), jnp.ones_like(start)
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        same = jnp.sign(height(middle)) == jnp.sign(start)
        low, high = jnp.where(same, middle, low), jnp.where(same, high, middle)
    fraction = (low + high) / 2
    for _ in range(NEWTON_STEPS):
        slope = (3 * third * fraction + 2 * second) * fraction + first
        step = height(fraction) / jnp.where(slope == 0, 1, slope)
        fraction = bounded(fraction - step, low, high)
    return jnp.where(start * end < 0, mesh.start + fraction * mesh.width, jnp.nan)


def with_nodes_at(mesh: Mesh, positions: Float[Array, " position"]) -> Mesh:
    """The mesh with the node nearest to each position moved onto it.

    Nodes on breakpoints stay; a position between two of them without a node
    between is left alone, like one that is NaN.
    """
    count = mesh.start.shape[0]
    real = jnp.isfinite(positions)
    element, fraction = mesh.locate(jnp.where(real, positions, mesh.start[0]))
    following = (element + 1) % count
    behind_free, ahead_free = ~mesh.is_first[element], ~mesh.is_first[following]
    take_behind = behind_free & ((fraction < 0.5) | ~ahead_free)
    node = jnp.where(take_behind, element, following)
    moved = real & (behind_free | ahead_free)
    start = mesh.start.at[jnp.where(moved, node, count)].set(positions, mode="drop")
    end = (mesh.start[-1] + mesh.width[-1])[None]
    width = larger(jnp.diff(jnp.concatenate([start, end])), 0)
    return Mesh(start, width, mesh.is_first)

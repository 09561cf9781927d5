"""Nodes where solutions themselves meet a kink of their equation, side by side.

What `crossing.py` does for one orbit: each place where the solution before passes a
kink becomes a node. Here nothing is scattered. An element of the new mesh finds the last
place before its end and, where that lies behind its start, moves the nearer of its two
nodes there: a selection among neighbouring rows.
"""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from camring.numerics.batch import take
from camring.numerics.crossing import crossings
from camring.numerics.mesh import Mesh
from camring.numerics.selection import larger

Rows = Float[Array, "element batch"]


def with_nodes_at_kinks(
    mesh: Mesh,
    within: Int[Array, "element batch"],
    state: Rows,
    before: Mesh,
    powers: Float[Array, "4 element batch"],
    levels: tuple[Float[Array, " batch"], ...],
) -> tuple[Mesh, Rows]:
    """Meshes with a node at each place where the solution before passes one of the levels.

    Parameters
    ----------
    within
        In which element of the mesh before each element begins.
    state
        Of the solution before, at the nodes.
    before, powers
        That solution.

    Returns
    -------
    Meshes, and the state at their nodes. Breakpoints stay, and so does a place between two of
    them without a node between.
    """
    end = (mesh.start[-1:] + mesh.width[-1:], jnp.full_like(within[:1], before.start.shape[0] - 1))
    start, fixed = mesh.start, mesh.is_first
    beyond = jnp.concatenate([within[1:], end[1]])
    for level in levels:
        following = jnp.concatenate([start[1:], end[0]])
        place = _last_before(before, powers, level, beyond, following)
        inside = (place > start) & (place < following)
        fixed_ahead = jnp.concatenate([fixed[1:], jnp.ones_like(fixed[:1])])
        nearer = (place - start < following - place) | fixed_ahead
        mine, next_one = inside & ~fixed & nearer, inside & ~fixed_ahead & ~(nearer & ~fixed)
        moved = _pushed(next_one, jnp.zeros_like(next_one[:1]))
        start = jnp.where(moved, _pushed(place, place[:1]), start)
        start = jnp.where(mine, place, start)
        state = jnp.where(mine | moved, level, state)
        fixed = fixed | mine | moved
    width = larger(jnp.concatenate([start[1:], end[0]]) - start, 0)
    return Mesh(start, width, mesh.is_first), state


def _last_before(
    mesh: Mesh,
    powers: Float[Array, "4 element batch"],
    level: Float[Array, " batch"],
    element: Int[Array, "wanted batch"],
    position: Float[Array, "wanted batch"],
) -> Float[Array, "wanted batch"]:
    """The last crossing not behind positions within numbered elements; else minus infinity."""
    found = crossings(mesh, powers, level)
    found = jnp.where(found > mesh.start, found, -jnp.inf)
    here = take(found, element)
    here = jnp.where(here <= position, here, -jnp.inf)
    return larger(here, take(_latest(found), element))


def _latest(rows: Rows) -> Rows:
    """The largest of all rows before each."""

    def further(so_far: Array, row: Array) -> tuple[Array, Array]:
        return larger(so_far, row), so_far

    return jax.lax.scan(further, jnp.full_like(rows[0], -jnp.inf), rows)[1]


def _pushed(
    rows: Float[Array, "element batch"] | Bool[Array, "element batch"], first: Array
) -> Array:
    """Each row where the next one was."""
    return jnp.concatenate([first, rows[:-1]])

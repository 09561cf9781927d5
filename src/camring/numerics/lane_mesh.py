"""Meshes of many orbits side by side, each with its own breakpoints.

The same two meshes as in `mesh.py`, a graded one to begin with and one that gives
every element an equal share of a density (de Boor 1973), laid for all lanes at
once: every lane has the same number of elements and breakpoints, and nothing is
decided by a branch.
"""

import jax.numpy as jnp
import numpy as np
from jax.lax import stop_gradient
from jaxtyping import Array, Float

from camring.numerics.lanes import interpolate, locate, running_total, take
from camring.numerics.mesh import LAYER_ELEMENTS, Mesh, graded_fractions

Rows = Float[Array, "breakpoint lane"]


def graded_lanes(breakpoints: Rows, period: float, per_segment: int) -> Mesh:
    """The same few elements between any two breakpoints, finer towards both."""
    fractions = graded_fractions(per_segment)
    lanes = breakpoints.shape[-1]
    span = (_ends(breakpoints, period) - breakpoints)[:, None]
    start = breakpoints[:, None] + span * fractions[:-1, None]
    width = span * np.diff(fractions)[:, None]
    first = np.tile(np.arange(per_segment) == 0, breakpoints.shape[0])
    return Mesh(start.reshape(-1, lanes), width.reshape(-1, lanes), jnp.asarray(first)[:, None])


def equidistribute_lanes(
    graded: Mesh,
    density: Float[Array, "element lane"],
    breakpoints: Rows,
    sharp: Rows,
    layer: Rows,
    period: float,
    elements: int,
) -> Mesh:
    """Meshes whose elements hold equal shares of the density on a graded mesh.

    Behind a sharp breakpoint (1, else 0; as many in every lane) lie two thin elements, of
    three and nine relaxation lengths `layer`, unless ordinary elements are as thin.
    """
    segments = breakpoints.shape[0]
    mass = running_total(density * graded.width)
    node = jnp.concatenate([graded.start, breakpoints[:1] + period])
    mass_at = mass[:: graded.start.shape[0] // segments]
    thin = LAYER_ELEMENTS * sharp
    promised = running_total(1 + thin)
    first = jnp.round(mass_at / mass_at[-1] * (elements - promised[-1])) + promised
    ordinary = first[1:] - first[:-1] - thin
    share = (mass_at[1:] - mass_at[:-1]) / ordinary
    end = _ends(breakpoints, period)
    # Behind the layer the first ordinary element gives up the layer's length.
    one_share = interpolate(mass_at[:-1] + share, mass, node)
    first_width = jnp.where(ordinary == 1, end, jnp.clip(one_share, breakpoints, end)) - breakpoints

    number = jnp.arange(elements, dtype=float)[:, None]
    number = jnp.broadcast_to(number, (elements, breakpoints.shape[-1]))
    segment = locate(first[:-1], number)
    from_first = number - take(first[:-1], segment)
    past_thin = from_first - take(thin, segment)
    wanted = take(mass_at[:-1], segment) + jnp.maximum(past_thin, 0) * take(share, segment)
    behind, ahead = take(breakpoints, segment), take(end, segment)
    start = jnp.clip(interpolate(wanted, mass, node), behind, ahead)
    nearest = take(jnp.minimum(3 * layer, first_width / 8), segment)
    nearer = take(jnp.minimum(12 * layer, first_width / 2), segment)
    start = jnp.where(past_thin == 0, behind + nearer, start)
    start = jnp.where(past_thin == -1, behind + nearest, start)
    is_first = from_first == 0
    start = jnp.where(is_first, behind, start)
    following = jnp.concatenate([start[1:], breakpoints[:1] + period])
    return Mesh(start, jnp.maximum(following - start, 0), is_first)


def follow_in_lanes(mesh: Mesh, breakpoints: Rows, period: float) -> Mesh:
    """The same meshes, their nodes carried along by the breakpoints they lie between."""
    segment = jnp.cumsum(mesh.is_first, axis=0) - 1
    begin = take(breakpoints, segment)
    span = take(_ends(breakpoints, period) - breakpoints, segment)
    here, there = stop_gradient(begin), stop_gradient(span)
    safe = jnp.where(there > 0, there, 1)
    left = stop_gradient(jnp.where(there > 0, (mesh.start - here) / safe, 0))
    share = stop_gradient(jnp.where(there > 0, mesh.width / safe, 0))
    return Mesh(begin + left * span, share * span, mesh.is_first)


def positions(mesh: Mesh, fraction: Float[Array, " point"]) -> Float[Array, "point element lane"]:
    """Positions at the same fractions of every element of every lane."""
    return mesh.start + fraction[:, None, None] * mesh.width


def locate_in_lanes(
    mesh: Mesh, position: Float[Array, "wanted lane"]
) -> tuple[Array, Float[Array, "wanted lane"]]:
    """Element number and fraction of positions within the period that each mesh covers."""
    element = locate(mesh.start, position)
    width = take(mesh.width, element)
    offset = position - take(mesh.start, element)
    return element, jnp.where(width > 0, offset / jnp.where(width > 0, width, 1), 1)


def _ends(breakpoints: Rows, period: float) -> Rows:
    return jnp.concatenate([breakpoints[1:], breakpoints[:1] + period])

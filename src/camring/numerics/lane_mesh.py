"""Meshes of many orbits side by side, each with its own breakpoints.

The same two meshes as in `mesh.py`, a graded one to begin with and one that gives
every element an equal share of a density (de Boor 1973), laid for all lanes at
once: every lane has the same number of elements and breakpoints, and nothing is
decided by a branch.
"""

import jax.numpy as jnp
import numpy as np
from jax.lax import stop_gradient
from jaxtyping import Array, Float, Int

from camring.numerics.lanes import interpolate, reached, running_total, take
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
) -> tuple[Mesh, Int[Array, "element lane"]]:
    """Meshes whose elements hold equal shares of the density on a graded mesh.

    Behind a sharp breakpoint (1, else 0; as many in every lane) lie two thin elements, of
    three and nine relaxation lengths `layer`, unless ordinary elements are as thin.

    Returns the meshes, and in which element of the graded mesh each of their own begins.
    """
    each = graded.start.shape[0] // breakpoints.shape[0]
    mass = running_total(density * graded.width)
    node = jnp.concatenate([graded.start, breakpoints[:1] + period])
    mass_at = mass[::each]
    thin = LAYER_ELEMENTS * sharp
    promised = running_total(1 + thin)
    first = jnp.round(mass_at / mass_at[-1] * (elements - promised[-1])) + promised
    ordinary = first[1:] - first[:-1] - thin
    share = (mass_at[1:] - mass_at[:-1]) / ordinary
    # Behind the layer the first ordinary element gives up the layer's length.
    one_share = interpolate(mass_at[:-1] + share, mass, node)
    end = _ends(breakpoints, period)
    first_width = jnp.where(ordinary == 1, end, jnp.clip(one_share, breakpoints, end)) - breakpoints
    nearest = breakpoints + jnp.minimum(3 * layer, first_width / 8)
    nearer = breakpoints + jnp.minimum(12 * layer, first_width / 2)
    first = first[:-1]

    # Each node of the graded mesh lies behind so many new ones: those of the segments
    # before, of the layer, and the ordinary ones that have had their share.
    position = graded.start

    def at(rows: Rows) -> Float[Array, "element lane"]:
        return _repeated(rows, each)

    shares = (mass[:-1] - at(mass_at[:-1])) / at(jnp.where(share > 0, share, 1))
    past = jnp.clip(jnp.ceil(shares) - 1, 0, at(ordinary) - 1)
    past = past + (position > at(breakpoints))
    past = past + at(sharp) * ((position > at(nearest)) + 1.0 * (position > at(nearer)))
    within = reached(at(first) + past, elements) - 1

    segment = reached(first, elements) - 1
    past_thin = jnp.arange(elements, dtype=float)[:, None] - take(first + thin, segment)
    wanted = take(mass_at[:-1], segment) + past_thin * take(share, segment)
    start = take(node[:-1], within) + (wanted - take(mass[:-1], within)) / take(density, within)
    start = jnp.where(past_thin == 0, take(nearer, segment), start)
    start = jnp.where(past_thin == -1, take(nearest, segment), start)
    before = jnp.concatenate([jnp.full_like(segment[:1], -1), segment[:-1]])
    is_first = segment != before
    start = jnp.where(is_first, take(breakpoints, segment), start)
    following = jnp.concatenate([start[1:], breakpoints[:1] + period])
    return Mesh(start, jnp.maximum(following - start, 0), is_first), within


def _repeated(rows: Rows, times: int) -> Float[Array, "row lane"]:
    count, lanes = rows.shape
    return jnp.broadcast_to(rows[:, None], (count, times, lanes)).reshape(-1, lanes)


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


def locate_round(
    mesh: Mesh, count: int, period: float
) -> tuple[Int[Array, "place lane"], Float[Array, "place lane"]]:
    """Element and fraction of `count` places round the period, equally far apart from 0 on.

    Each mesh covers a period of its own, which begins at its first node.
    """
    elements = mesh.start.shape[0]
    passed = jnp.ceil(mesh.start * (count / period))
    beyond = passed >= count
    behind = jnp.sum(beyond, axis=0, dtype=jnp.int32)
    element = reached(jnp.where(beyond, passed - count, passed), count) - 1 - behind
    element = jnp.where(element < 0, element + elements, element)
    place = jnp.arange(count)[:, None] * (period / count)
    offset = place - take(mesh.start, element)
    # But for rounding, what lies before its element lies behind it one period later.
    offset = jnp.where(offset < -1e-9 * period, offset + period, offset)
    width = take(mesh.width, element)
    return element, jnp.where(width > 0, offset / jnp.where(width > 0, width, 1), 1)


def _ends(breakpoints: Rows, period: float) -> Rows:
    return jnp.concatenate([breakpoints[1:], breakpoints[:1] + period])

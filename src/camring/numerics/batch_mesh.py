"""Meshes of many orbits side by side, each with its own breakpoints.

The same meshes as in `mesh.py`, a graded one to begin with and others that give
every element an equal share of a density (de Boor 1973), laid for all members at
once: every member has the same number of elements and breakpoints, and nothing is
decided by a branch.
"""

from typing import NamedTuple, Protocol

import jax.numpy as jnp
import numpy as np
from jax.lax import stop_gradient
from jaxtyping import Array, Float, Int

from camring.numerics.batch import interpolate, reached, running_total, take
from camring.numerics.mesh import LAYER_ELEMENTS, Mesh, graded_fractions
from camring.numerics.selection import bounded, larger, smaller

Rows = Float[Array, "breakpoint batch"]


def graded_batch(breakpoints: Rows, period: float, per_segment: int) -> Mesh:
    """The same few elements between any two breakpoints, finer towards both."""
    fractions = graded_fractions(per_segment)
    members = breakpoints.shape[-1]
    span = (_ends(breakpoints, period) - breakpoints)[:, None]
    start = breakpoints[:, None] + span * fractions[:-1, None]
    width = span * np.diff(fractions)[:, None]
    first = np.tile(np.arange(per_segment) == 0, breakpoints.shape[0])
    return Mesh(start.reshape(-1, members), width.reshape(-1, members), jnp.asarray(first)[:, None])


class Segments(Protocol):
    """Which elements of a mesh lie between which two breakpoints."""

    def first(self, rows: Rows) -> Rows:
        """Of each element, or of each node: those at the beginnings of the segments.

        Of all nodes, the period's end included, that end is left in.
        """

    def spread(self, rows: Rows) -> Rows:
        """Of each segment, for every element of it."""


class EvenSegments(NamedTuple):
    """As many elements in every segment."""

    each: int

    def first(self, rows: Rows) -> Rows:
        return rows[:: self.each]

    def spread(self, rows: Rows) -> Rows:
        return _repeated(rows, self.each)


class CountedSegments(NamedTuple):
    """Other numbers of elements in every segment, and in every member."""

    number: Int[Array, "breakpoint_and_end batch"]
    """Of the first element of each segment, and how many elements there are."""
    segment: Int[Array, "element batch"]

    def first(self, rows: Rows) -> Rows:
        ends = rows.shape[0] > self.segment.shape[0]
        return take(rows, self.number if ends else self.number[:-1])

    def spread(self, rows: Rows) -> Rows:
        return take(rows, self.segment)


class Laid(NamedTuple):
    """A mesh laid by a solution on another."""

    mesh: Mesh
    within: Int[Array, "element batch"]
    """In which element of the other mesh each of its elements begins."""
    segments: CountedSegments


def equidistribute_batch(
    given: Mesh,
    segments: Segments,
    density: Float[Array, "element batch"],
    breakpoints: Rows,
    sharp: Rows,
    layer: Rows,
    period: float,
    elements: int,
    used: Float[Array, " batch"] | None = None,
) -> Laid:
    """Meshes whose elements hold equal shares of the density on a given mesh.

    Behind a sharp breakpoint (1, else 0; as many in every member) lie two thin elements, of
    three and nine relaxation lengths `layer`, unless ordinary elements are as thin.

    Parameters
    ----------
    used
        Into how many elements each member's period is divided, at most `elements`; all of them
        if not given. The others have no width and lie at its end.
    """
    mass = running_total(density * given.width)
    node = jnp.concatenate([given.start, breakpoints[:1] + period])
    mass_at = segments.first(mass)
    thin = LAYER_ELEMENTS * sharp
    promised = running_total(1 + thin)
    in_use = elements if used is None else used
    first = jnp.round(mass_at / mass_at[-1] * (in_use - promised[-1])) + promised
    ordinary = first[1:] - first[:-1] - thin
    share = (mass_at[1:] - mass_at[:-1]) / ordinary
    # Behind the layer the first ordinary element gives up the layer's length.
    one_share = interpolate(mass_at[:-1] + share, mass, node)
    end = _ends(breakpoints, period)
    first_width = jnp.where(ordinary == 1, end, bounded(one_share, breakpoints, end)) - breakpoints
    nearest = breakpoints + smaller(3 * layer, first_width / 8)
    nearer = breakpoints + smaller(12 * layer, first_width / 2)
    number, first = first, first[:-1]

    # Each node of the given mesh lies behind so many new ones: those of the segments
    # before, of the layer, and the ordinary ones that have had their share.
    position, at = given.start, segments.spread
    shares = (mass[:-1] - at(mass_at[:-1])) / at(jnp.where(share > 0, share, 1))
    past = bounded(jnp.ceil(shares) - 1, 0, at(ordinary) - 1)
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
    if used is not None:
        left_over = jnp.arange(elements, dtype=float)[:, None] >= used
        start = jnp.where(left_over, breakpoints[:1] + period, start)
    following = jnp.concatenate([start[1:], breakpoints[:1] + period])
    mesh = Mesh(start, larger(following - start, 0), is_first)
    return Laid(mesh, within, CountedSegments(number.astype(jnp.int32), segment))


def _repeated(rows: Rows, times: int) -> Float[Array, "row batch"]:
    count, members = rows.shape
    return jnp.broadcast_to(rows[:, None], (count, times, members)).reshape(-1, members)


def follow_in_batch(mesh: Mesh, breakpoints: Rows, period: float) -> Mesh:
    """The same meshes, their nodes carried along by the breakpoints they lie between."""
    segment = jnp.cumsum(mesh.is_first, axis=0) - 1
    begin = take(breakpoints, segment)
    span = take(_ends(breakpoints, period) - breakpoints, segment)
    here, there = stop_gradient(begin), stop_gradient(span)
    safe = jnp.where(there > 0, there, 1)
    left = stop_gradient(jnp.where(there > 0, (mesh.start - here) / safe, 0))
    share = stop_gradient(jnp.where(there > 0, mesh.width / safe, 0))
    return Mesh(begin + left * span, share * span, mesh.is_first)


def positions(mesh: Mesh, fraction: Float[Array, " point"]) -> Float[Array, "point element batch"]:
    """Positions at the same fractions of every element of every member."""
    return mesh.start + fraction[:, None, None] * mesh.width


def locate_round(
    mesh: Mesh, count: int, period: float
) -> tuple[Int[Array, "place batch"], Float[Array, "place batch"]]:
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

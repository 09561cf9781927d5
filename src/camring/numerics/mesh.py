"""Meshes of one period that keep breakpoints as nodes and go where they are needed.

Every mesh has a fixed number of elements. Equidistribution (de Boor 1973)
gives each an equal share of a density; rounding the count between breakpoints
to whole elements puts a node on every one of them.
"""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jax.lax import stop_gradient
from jaxtyping import Array, Bool, Float, Int

from camring.numerics.selection import bounded, larger, smaller
from camring.numerics.spline import floor_past_rounding

LAYER_ELEMENTS = 2
"""Elements kept for the thin layer behind each sharp breakpoint."""

ROUNDING = 1e-12
"""Of the range of the orbit: below it a cubic coefficient is not trusted."""


class Breakpoints(NamedTuple):
    """Where the forcing is not smooth, ascending within one period; may coincide."""

    position: Float[Array, " breakpoint"]
    sharp: Bool[Array, " breakpoint"]
    """Whether the rate itself has a kink there, behind which a stiff state lags in a thin layer."""


class Mesh(NamedTuple):
    """Elements of one period; zero-width ones are allowed."""

    start: Float[Array, " element"]
    width: Float[Array, " element"]
    is_first: Bool[Array, " element"]
    """Whether a breakpoint lies at the element's start."""

    def at(self, fraction: Float[Array, " point"]) -> Float[Array, "point element"]:
        """Positions at the same fractions of every element."""
        return self.start + fraction[:, None] * self.width

    def locate(self, position: Float[Array, "*grid"]) -> tuple[Array, Float[Array, "*grid"]]:
        """Element number and fraction of positions within the period."""
        element = jnp.searchsorted(self.start, position, side="right") - 1
        element = bounded(element, 0)
        width = self.width[element]
        offset = position - self.start[element]
        return element, jnp.where(width > 0, offset / jnp.where(width > 0, width, 1), 1)


class ElementCount(NamedTuple):
    """How many elements a mesh has room for, and how many of them it divides the period into.

    The others have no width and lie at its end. So meshes of different fineness are
    arrays of one shape, and one compiled program.
    """

    capacity: int
    used: int | Int[Array, ""]


def segment_ends(breakpoints: Float[Array, " breakpoint"], period: float) -> tuple[Array, Array]:
    """Where each stretch between breakpoints begins and ends."""
    following = jnp.concatenate([breakpoints[1:], breakpoints[:1] + period])
    return breakpoints, following


def folded(
    position: Float[Array, " position"], part: float, parts: int
) -> tuple[Float[Array, " position"], Float[Array, " position"]]:
    """In which of the period's equal parts each position lies, and how far behind its begin.

    Positions ascend; the first is where the period begins.
    """
    from_first = position - position[0]
    own = bounded(floor_past_rounding(stop_gradient(from_first) / part), 0, parts - 1)
    return own, larger(from_first - own * part, 0)


def graded_fractions(count: int) -> np.ndarray:
    """Nodes of `count` elements of the unit interval, finer towards both its ends."""
    steepness = 2.2
    line = np.linspace(-1, 1, count + 1)
    return (np.tanh(steepness * line) / np.tanh(steepness) + 1) / 2


def graded_mesh(
    breakpoints: Float[Array, " breakpoint"], period: float, per_segment: int = 4
) -> Mesh:
    """The same few elements between any two breakpoints, finer towards both."""
    fractions = graded_fractions(per_segment)
    begin, end = segment_ends(breakpoints, period)
    span = (end - begin)[:, None]
    first = np.tile(np.arange(per_segment) == 0, len(breakpoints))
    return Mesh(
        (begin[:, None] + span * fractions[:-1]).reshape(-1),
        (span * np.diff(fractions)).reshape(-1),
        jnp.asarray(first),
    )


def equidistribute(
    mesh: Mesh,
    density: Float[Array, " element"],
    breakpoints: Breakpoints,
    layer: Float[Array, " breakpoint"],
    period: float,
    elements: ElementCount,
) -> Mesh:
    """A mesh whose elements hold equal shares of the density's integral.

    Each segment between breakpoints gets at least one element. A segment that
    begins at a sharp breakpoint gets two thin ones more, of three and nine
    relaxation lengths `layer`, unless ordinary elements are as thin.
    """
    begin, end = segment_ends(breakpoints.position, period)
    mass = jnp.concatenate([jnp.zeros(1), jnp.cumsum(density * mesh.width)])
    node = jnp.concatenate([mesh.start, begin[:1] + period])
    mass_at = _interpolate_sorted(jnp.concatenate([begin, end[-1:]]), node, mass)
    thin = LAYER_ELEMENTS * breakpoints.sharp
    promised = jnp.concatenate([jnp.zeros(1, thin.dtype), jnp.cumsum(1 + thin)])
    wanted = jnp.round(mass_at / mass_at[-1] * (elements.used - promised[-1]))
    first = wanted.astype(jnp.int32) + promised
    ordinary = first[1:] - first[:-1] - thin

    element = jnp.arange(elements.capacity)
    segment = jnp.searchsorted(first[:-1], element, side="right") - 1
    share_mass = (mass_at[1:] - mass_at[:-1]) / ordinary
    past_thin = element - (first[:-1] + thin)[segment]
    target = mass_at[segment] + larger(past_thin, 0) * share_mass[segment]
    inner = _interpolate_sorted(target, mass, node)
    # Behind the layer the first ordinary element gives up the layer's length.
    one_share = _interpolate_sorted(mass_at[:-1] + share_mass, mass, node)
    first_width = jnp.where(ordinary == 1, end, bounded(one_share, begin, end)) - begin
    nearest = (begin + smaller(3 * layer, first_width / 8))[segment]
    nearer = (begin + smaller(12 * layer, first_width / 2))[segment]
    behind, ahead = begin[segment], end[segment]
    start = bounded(inner, behind, ahead)
    start = jnp.where(past_thin == -1, nearest, jnp.where(past_thin == 0, nearer, start))
    is_first = element == first[:-1][segment]
    start = jnp.where(is_first, behind, start)
    following = jnp.concatenate([start[1:], begin[:1] + period])
    return Mesh(start, larger(following - start, 0), is_first)


def follow_breakpoints(mesh: Mesh, breakpoints: Float[Array, " breakpoint"], period: float) -> Mesh:
    """The same mesh, its nodes carried along by the breakpoints they lie between."""
    begin, end = segment_ends(breakpoints, period)
    segment = jnp.cumsum(mesh.is_first) - 1
    span = stop_gradient(end - begin)[segment]
    safe = jnp.where(span > 0, span, 1.0)
    left = stop_gradient(jnp.where(span > 0, (mesh.start - begin[segment]) / safe, 0.0))
    share = stop_gradient(jnp.where(span > 0, mesh.width / safe, 0.0))
    moving = (end - begin)[segment]
    return Mesh(begin[segment] + left * moving, share * moving, mesh.is_first)


def fourth_derivative_density(
    mesh: Mesh,
    third_coefficient: Float[Array, " element"],
    extent: Float[Array, ""],
    period: float,
) -> Float[Array, " element"]:
    """Elements wanted for each unit of length by a piecewise cubic's own error term.

    The fourth derivative is the change of third derivative from element to
    element, not counted across breakpoints, where it jumps of right.
    """
    width = larger(mesh.width, 1e-14 * period)
    third = 6 * third_coefficient / width**3 / extent
    # What a thin element's third derivative owes to rounding must not count in a wide neighbour.
    noise = 6 * ROUNDING / width**3
    jump = jnp.abs(third - jnp.roll(third, 1, axis=0)) - noise - jnp.roll(noise, 1, axis=0)
    change = larger(jump, 0) / ((width + jnp.roll(width, 1, axis=0)) / 2)
    change = jnp.where(mesh.is_first, 0.0, change)
    density = jnp.sqrt(jnp.sqrt(larger(change, jnp.roll(change, -1, axis=0))))
    behind, ahead = (
        jnp.roll(density, k, axis=0) * smaller(1, jnp.roll(width, k, axis=0) / width)
        for k in (1, -1)
    )
    spread = larger(behind, ahead) / 2
    return _level(smaller(larger(density, spread), 1e7 / period), mesh, period)


def _level(
    density: Float[Array, " element"], mesh: Mesh, period: float
) -> Float[Array, " element"]:
    """Half the elements by density, half evenly, so that none grows wide."""
    return density + jnp.sum(density * mesh.width, axis=0) / period + 1 / period


def _interpolate_sorted(
    wanted: Float[Array, " wanted"], grid: Float[Array, " grid"], values: Float[Array, " grid"]
) -> Float[Array, " wanted"]:
    """Piecewise linear interpolation on an ascending grid that may hold equal values."""
    after = jnp.searchsorted(grid, wanted, side="right")
    right = bounded(after, 1, grid.shape[0] - 1)
    left = right - 1
    span = grid[right] - grid[left]
    share = jnp.where(span > 0, (wanted - grid[left]) / jnp.where(span > 0, span, 1), 0)
    return values[left] + bounded(share, 0, 1) * (values[right] - values[left])

"""Many periodic orbits at once, each a member of one batch.

The method is that of `periodic.py` (three-stage Radau collocation, Newton on the
whole period, one scan for periodicity), laid out for throughput: every array has
its problems along the last axis, meshes have the same number of elements in every
member, and each Newton step is one sweep of plain arithmetic over all of them. As it
comes there are two meshes: a graded one between the breakpoints, solved roughly, and from it
the one that counts. What is given up for speed: corners that the solution meets where
no breakpoint stands have no node of their own. `refinements` of more than one lays
further meshes, with nodes at these corners, as `periodic.py` does.

Newton stops for each member by itself, at most after `limit` steps; a member
that has not says so by its residual and drags nobody along for longer.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import reduce
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax.lax import stop_gradient
from jaxtyping import Array, Float, Int

from camring.numerics.batch import take
from camring.numerics.batch_crossing import with_nodes_at_kinks
from camring.numerics.batch_mesh import (
    EvenSegments,
    Laid,
    Segments,
    equidistribute_batch,
    follow_in_batch,
    graded_batch,
)
from camring.numerics.compilation import computed_once
from camring.numerics.equation import Equation, Forcing
from camring.numerics.mesh import Mesh, fourth_derivative_density
from camring.numerics.newton import damped_newton
from camring.numerics.periodic import Orbit, collocation_residual, eliminate, extent
from camring.numerics.radau import STAGE_INTEGRALS, STAGES, element_powers, horner
from camring.numerics.selection import larger, largest, smaller, smallest

Rows = Float[Array, "element batch"]
Step = Callable[[Equation, Forcing, Mesh, list[Rows]], tuple[Rows, list[Rows]]]


class PeriodicResolution(NamedTuple):
    """How finely every orbit of a batch is looked at; all static."""

    elements: int
    """In one period, those included that the breakpoints take for themselves."""
    per_segment: int = 6
    """Elements between two breakpoints on the first mesh."""
    tolerance: float = 1e-4
    """Newton stops when its step is this small against the range of the orbit; it is
    quadratic, and one more step follows."""
    rough_tolerance: float = 0.2
    """The same on the first mesh, which only serves to lay the other."""
    limit: int = 20
    """Newton steps at most on each mesh."""
    refinements: int = 1
    """Meshes laid from a solution; all but the first have nodes at the equation's kinks."""
    middle_tolerance: float = 1e-3
    """Newton's on a mesh between the first and the last."""
    compact: bool = False
    """Whether the law is written once for all three stages and no step is taken between two
    meshes: less code to compile, more memory to pass over."""


class BatchOrbit(NamedTuple):
    """Orbits with what the equation was given at their collocation points."""

    orbit: Orbit
    """Its arrays are (element, batch) and (3, element, batch)."""
    at_stages: Forcing
    decay: Float[Array, " batch"]
    """Minus the logarithm of the Floquet multiplier: how fast a disturbance is forgotten."""


def _step(
    equation: Equation, at_stages: Forcing, mesh: Mesh, stages: list[Rows]
) -> tuple[Rows, list[Rows]]:
    """`newton_step` with each of the three stages by itself: all of it is one loop."""
    found = [
        equation.rate_and_slope(jax.tree.map(lambda leaf, k=k: leaf[k], at_stages), stage)
        for k, stage in enumerate(stages)
    ]
    value, slope = (list(each) for each in zip(*found, strict=True))
    return eliminate(value, slope, mesh, stages)


def _compact_step(
    equation: Equation, at_stages: Forcing, mesh: Mesh, stages: list[Rows]
) -> tuple[Rows, list[Rows]]:
    """The same with the law written once for all three stages."""
    value, slope = computed_once(equation.rate_and_slope(at_stages, jnp.stack(stages)))
    return eliminate(list(value), list(slope), mesh, stages)


def solve_periodic_batch(
    equation: Equation,
    breakpoints: Float[Array, "breakpoint batch"],
    sharp: Float[Array, "breakpoint batch"],
    period: float,
    resolution: PeriodicResolution,
    used: Float[Array, " batch"] | None = None,
) -> BatchOrbit:
    """The periodic solutions of one equation with other parameters in every member.

    Parameters
    ----------
    equation
        Parameters with the batch along their last axis; its laws are plain arithmetic.
    breakpoints
        Ascending within one period in every member.
    sharp
        1 where the rate itself has a kink, behind which a stiff state lags; else 0.
    used
        How many of the elements divide each member's period, if not all of them.

    Notes
    -----
    No derivative passes through: `settle_batch` takes a solution at hand.
    """
    breakpoints, frozen = stop_gradient(breakpoints), equation.frozen()
    rough = computed_once(graded_batch(breakpoints, period, resolution.per_segment))
    at_stages = computed_once(frozen.forcing(rough, jnp.asarray(STAGES)))
    stages = frozen.guess(at_stages)
    limit = resolution.limit
    step = _compact_step if resolution.compact else _step
    stages, _ = _newton(frozen, at_stages, rough, stages, resolution.rough_tolerance, limit, step)
    mesh = rough
    segments: Segments = EvenSegments(resolution.per_segment)
    elements = resolution.elements

    for refinement in range(resolution.refinements):
        last = refinement == resolution.refinements - 1
        if resolution.compact:  # what an element ends with the next begins with
            known = Known(mesh, segments, jnp.roll(stages[2], 1, axis=0), stages)
        else:
            node_state, found = _step(frozen, at_stages, mesh, list(stages))
            known = Known(mesh, segments, node_state, jnp.stack(found))
        mesh, segments, stages = lay_from(
            frozen, known, breakpoints, sharp, period, elements, used, at_kinks=refinement > 0
        )
        at_stages = computed_once(frozen.forcing(mesh, jnp.asarray(STAGES)))
        tolerance = resolution.tolerance if last else resolution.middle_tolerance
        stages, count = _newton(frozen, at_stages, mesh, stages, tolerance, limit, step)
    return _settled(frozen, at_stages, mesh, stages, count, step)


class Known(NamedTuple):
    """A solution that the next mesh is laid from."""

    mesh: Mesh
    segments: Segments
    node_state: Rows
    stages: Float[Array, "3 element batch"]


def lay_from(
    equation: Equation,
    known: Known,
    breakpoints: Float[Array, "breakpoint batch"],
    sharp: Float[Array, "breakpoint batch"],
    period: float,
    elements: int,
    used: Float[Array, " batch"] | None = None,
    at_kinks: bool = False,
) -> tuple[Mesh, Segments, Float[Array, "3 element batch"]]:
    """The mesh that a solution asks for, and stages to begin with there.

    Parameters
    ----------
    at_kinks
        Whether nodes are moved to where the solution meets kinks of the equation, which
        a solution on a graded mesh is too rough to tell.
    """
    powers = computed_once(element_powers(known.node_state, known.stages))
    density = _density(known.mesh, powers, known.stages, period)
    layer = _layer_width(equation, known.mesh, known.segments, known.node_state, period)
    density, layer = computed_once((density, layer))
    laid = computed_once(
        equidistribute_batch(
            known.mesh, known.segments, density, breakpoints, sharp, layer, period, elements, used
        )
    )
    state, slope = computed_once(_carried_over(known.mesh, powers, laid))
    if not at_kinks:
        return laid.mesh, laid.segments, _guessed(laid.mesh, state, None)
    mesh, state = computed_once(
        with_nodes_at_kinks(laid.mesh, laid.within, state, known.mesh, powers, equation.kinks)
    )
    return mesh, laid.segments, _guessed(mesh, state, slope)


def carry_batch(
    equation: Equation, breakpoints: Float[Array, "breakpoint batch"], period: float, known: Orbit
) -> tuple[Orbit, Forcing]:
    """Solutions at hand on meshes that their breakpoints carry along, and the equation's forcing
    there; `settle_batch` goes on."""
    mesh = follow_in_batch(known.mesh, breakpoints, period)
    at_stages = computed_once(equation.forcing(mesh, jnp.asarray(STAGES)))
    return replace(known, mesh=mesh), at_stages


def step_batch(equation: Equation, at_stages: Forcing, known: Orbit) -> Orbit:
    """One Newton step from solutions at hand, whose residual stays what it was."""
    node_state, stages = _step(equation, at_stages, known.mesh, list(known.stage_state))
    return replace(known, node_state=node_state, stage_state=jnp.stack(stages))


def settle_batch(equation: Equation, at_stages: Forcing, known: Orbit) -> BatchOrbit:
    """Solutions at hand as a function of the equation: one Newton step from a constant.

    Its derivatives are those of the discrete orbits (implicit function theorem).
    """
    stages = stop_gradient(known.stage_state)
    return _settled(equation, at_stages, known.mesh, stages, known.iterations)


def _settled(
    equation: Equation,
    at_stages: Forcing,
    mesh: Mesh,
    stages: Float[Array, "3 element batch"],
    iterations: Int[Array, ""],
    step: Step = _step,
) -> BatchOrbit:
    node_state, found = step(equation, at_stages, mesh, list(stages))
    node_state, stages = computed_once((node_state, jnp.stack(found)))
    rate, slope = equation.rate_and_slope(at_stages, stages)
    residual = collocation_residual(list(rate), mesh, node_state, stages)
    weight = STAGE_INTEGRALS[-1][:, None, None] * mesh.width
    decay = -jnp.sum(weight * slope, axis=(0, 1))
    return BatchOrbit(Orbit(mesh, node_state, stages, residual, iterations), at_stages, decay)


def _newton(
    equation: Equation,
    at_stages: Forcing,
    mesh: Mesh,
    stages: Float[Array, "3 element batch"],
    tolerance: float,
    limit: int,
    step: Step = _step,
) -> tuple[Float[Array, "3 element batch"], Int[Array, ""]]:
    def improved(current: list[Rows]) -> list[Rows]:
        return step(equation, at_stages, mesh, current)[1]

    found, count = damped_newton(improved, _share_of_range, list(stages), tolerance, limit)
    return jnp.stack(found), count


def _share_of_range(step: list[Rows], stages: list[Rows]) -> Float[Array, " batch"]:
    """The largest part of a step, over the range of the stages."""
    most = reduce(larger, [largest(jnp.abs(each), axis=0) for each in step])
    highest = reduce(larger, [largest(each, axis=0) for each in stages])
    lowest = reduce(smaller, [smallest(each, axis=0) for each in stages])
    return most / (highest - lowest + 1e-300)


def _density(
    mesh: Mesh,
    powers: Float[Array, "4 element batch"],
    stages: Float[Array, "3 element batch"],
    period: float,
) -> Rows:
    # An element without width ends one that its neighbour beyond knows nothing of.
    apart = mesh._replace(is_first=mesh.is_first | (mesh.width <= 0))
    return fourth_derivative_density(apart, powers[3], extent(stages), period)


def _carried_over(
    before: Mesh, powers: Float[Array, "4 element batch"], laid: Laid
) -> tuple[Rows, Rows]:
    """What a solution is at the nodes of the mesh that was laid from it, and its slope there."""
    width = take(before.width, laid.within)
    offset = laid.mesh.start - take(before.start, laid.within)
    # Breakpoints may coincide: then there is nothing between them to look at.
    safe = jnp.where(width > 0, width, 1)
    fraction = jnp.where(width > 0, offset / safe, 0)
    constant, first, second, third = (take(each, laid.within) for each in powers)
    state = horner([constant, first, second, third], fraction)
    return state, horner([first, 2 * second, 3 * third], fraction) / safe


def _guessed(mesh: Mesh, state: Rows, slope: Rows | None) -> Float[Array, "3 element batch"]:
    """Stages to begin with: straight lines between the nodes, or parabolas that leave them
    with a slope."""
    rise = jnp.roll(state, -1, axis=0) - state
    fraction = jnp.asarray(STAGES)[:, None, None]
    if slope is None:
        return state + fraction * rise
    onward = slope * mesh.width
    return state + fraction * (onward + fraction * (rise - onward))


def _layer_width(
    equation: Equation, mesh: Mesh, segments: Segments, node_state: Rows, period: float
) -> Float[Array, "breakpoint batch"]:
    """Relaxation length `1/|slope of the rate|` just behind each breakpoint."""
    behind = Mesh(segments.first(mesh.start), segments.first(mesh.width), mesh.is_first)
    at_start = jax.tree.map(lambda leaf: leaf[0], equation.forcing(behind, jnp.zeros(1)))
    _, slope = equation.rate_and_slope(at_start, segments.first(node_state))
    return 1 / larger(jnp.abs(slope), 1 / period)

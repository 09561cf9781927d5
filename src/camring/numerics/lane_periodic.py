"""Many periodic orbits at once, each in a lane of its own.

The method is that of `periodic.py` (three-stage Radau collocation, Newton on the
whole period, one scan for periodicity), laid out for throughput: every array has
its problems along the last axis, meshes have the same number of elements in every
lane, and each Newton step is one sweep of plain arithmetic over all of them. Two
meshes only: a graded one between the breakpoints, solved roughly, and from it the
one that counts. What is given up for speed: corners that the solution meets where
no breakpoint stands have no node of their own, so the last digits belong to
`periodic.py`.

Newton stops when the slowest lane has converged, at most after `limit` steps; a lane
that has not says so by its residual and drags nobody along for longer.
"""

from functools import reduce
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax.lax import stop_gradient
from jaxtyping import Array, Float, Int

from camring.numerics.equation import Equation, Forcing
from camring.numerics.lane_mesh import (
    equidistribute_lanes,
    follow_in_lanes,
    graded_lanes,
)
from camring.numerics.lanes import take
from camring.numerics.mesh import Mesh, fourth_derivative_density
from camring.numerics.newton import damped_newton
from camring.numerics.once import computed_once
from camring.numerics.periodic import Orbit, collocation_residual, eliminate, extent
from camring.numerics.radau import STAGE_INTEGRALS, STAGES, element_powers, horner

Rows = Float[Array, "element lane"]


class LaneResolution(NamedTuple):
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


class LaneOrbit(NamedTuple):
    """Orbits with what the equation was told at their collocation points."""

    orbit: Orbit
    """Its arrays are (element, lane) and (3, element, lane)."""
    at_stages: Forcing
    decay: Float[Array, " lane"]
    """Minus the logarithm of the Floquet multiplier: how fast a disturbance is forgotten."""


def solve_lanes(
    equation: Equation,
    breakpoints: Float[Array, "breakpoint lane"],
    sharp: Float[Array, "breakpoint lane"],
    period: float,
    resolution: LaneResolution,
) -> LaneOrbit:
    """The periodic solutions of one equation with other parameters in every lane.

    Parameters
    ----------
    equation
        Parameters with lanes along their last axis; its laws are plain arithmetic.
    breakpoints
        Ascending within one period in every lane.
    sharp
        1 where the rate itself has a kink, behind which a stiff state lags; else 0.

    Notes
    -----
    No derivative passes through: `settle_lanes` takes a solution at hand.
    """
    breakpoints, frozen = stop_gradient(breakpoints), equation.frozen()
    rough = computed_once(graded_lanes(breakpoints, period, resolution.per_segment))
    at_stages = computed_once(frozen.forcing(rough, jnp.asarray(STAGES)))
    stages = frozen.guess(at_stages)
    limit = resolution.limit
    stages, _ = _newton(frozen, at_stages, rough, stages, resolution.rough_tolerance, limit)
    node_state, found = _step(frozen, at_stages, rough, list(stages))
    stages = jnp.stack(found)
    powers = computed_once(element_powers(node_state, stages))

    density = fourth_derivative_density(rough, powers[3], extent(stages), period)
    layer = _layer_width(frozen, rough, node_state, period, resolution.per_segment)
    density, layer = computed_once((density, layer))
    mesh, within = computed_once(
        equidistribute_lanes(rough, density, breakpoints, sharp, layer, period, resolution.elements)
    )
    stages = _carried_over(rough, powers, mesh, within)
    at_stages = computed_once(frozen.forcing(mesh, jnp.asarray(STAGES)))
    stages, count = _newton(frozen, at_stages, mesh, stages, resolution.tolerance, limit)
    return _settled(frozen, at_stages, mesh, stages, count)


def settle_lanes(
    equation: Equation, breakpoints: Float[Array, "breakpoint lane"], period: float, known: Orbit
) -> LaneOrbit:
    """Solutions at hand as a function of the equation: one Newton step from a constant.

    Its derivatives are those of the discrete orbits (implicit function theorem); meshes
    are carried along by the breakpoints.
    """
    mesh = follow_in_lanes(known.mesh, breakpoints, period)
    at_stages = computed_once(equation.forcing(mesh, jnp.asarray(STAGES)))
    stages = stop_gradient(known.stage_state)
    return _settled(equation, at_stages, mesh, stages, known.iterations)


def _settled(
    equation: Equation,
    at_stages: Forcing,
    mesh: Mesh,
    stages: Float[Array, "3 element lane"],
    iterations: Int[Array, ""],
) -> LaneOrbit:
    node_state, found = _step(equation, at_stages, mesh, list(stages))
    node_state, stages = computed_once((node_state, jnp.stack(found)))
    rate, slope = equation.rate_and_slope(at_stages, stages)
    residual = collocation_residual(list(rate), mesh, node_state, stages)
    weight = STAGE_INTEGRALS[-1][:, None, None] * mesh.width
    decay = -jnp.sum(weight * slope, axis=(0, 1))
    return LaneOrbit(Orbit(mesh, node_state, stages, residual, iterations), at_stages, decay)


def _newton(
    equation: Equation,
    at_stages: Forcing,
    mesh: Mesh,
    stages: Float[Array, "3 element lane"],
    tolerance: float,
    limit: int,
) -> tuple[Float[Array, "3 element lane"], Int[Array, ""]]:
    def improved(current: list[Rows]) -> list[Rows]:
        return _step(equation, at_stages, mesh, current)[1]

    found, count = damped_newton(improved, _share_of_range, list(stages), tolerance, limit)
    return jnp.stack(found), count


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


def _share_of_range(step: list[Rows], stages: list[Rows]) -> Float[Array, " lane"]:
    """The largest part of a step, over the range of the stages."""
    largest = reduce(jnp.maximum, [jnp.max(jnp.abs(each), axis=0) for each in step])
    highest = reduce(jnp.maximum, [jnp.max(each, axis=0) for each in stages])
    lowest = reduce(jnp.minimum, [jnp.min(each, axis=0) for each in stages])
    return largest / (highest - lowest + 1e-300)


def _carried_over(
    rough: Mesh,
    powers: Float[Array, "4 element lane"],
    mesh: Mesh,
    within: Int[Array, "element lane"],
) -> Float[Array, "3 element lane"]:
    """Stages to begin with: straight lines between what a rough solution is at the nodes."""
    width = take(rough.width, within)
    offset = mesh.start - take(rough.start, within)
    # Breakpoints may coincide: then there is nothing between them to look at.
    fraction = jnp.where(width > 0, offset / jnp.where(width > 0, width, 1), 0)
    here = horner([take(each, within) for each in powers], fraction)
    rise = jnp.roll(here, -1, axis=0) - here
    return here + STAGES[:, None, None] * rise


def _layer_width(
    equation: Equation,
    graded: Mesh,
    node_state: Float[Array, "element lane"],
    period: float,
    per_segment: int,
) -> Float[Array, "breakpoint lane"]:
    """Relaxation length `1/|slope of the rate|` just behind each breakpoint."""
    behind = Mesh(*(leaf[::per_segment] for leaf in graded))
    at_start = jax.tree.map(lambda leaf: leaf[0], equation.forcing(behind, jnp.zeros(1)))
    _, slope = equation.rate_and_slope(at_start, node_state[::per_segment])
    return 1 / jnp.maximum(jnp.abs(slope), 1 / period)

"""Periodic orbits of many equal equations that share one or a few more states.

`links` copies of a scalar equation run through the same orbit `y`, each a
`links`-th of the period behind the one before, and all of them feed and are fed
by the shared states `z`, whose period therefore is that part:

    dy/dx = rate(forcing(x), y, z)
    dz/dx = shared_rate(z, sum over copies of draw(forcing, y, z))

Cut into parts and laid side by side, the whole period is one of the parts with
the states of `links` copies and the shared ones, closed by a shift: each copy ends where the
next began. It is
solved as `periodic.py` solves the scalar equation: Radau collocation, one Newton
iteration for all elements and the closure together (`coupled/step.py`).

It is solved twice: roughly on a mesh laid from an orbit without coupling, and then
on one laid from that solution, which knows what the copies do to one another.
"""

from collections.abc import Sequence
from functools import reduce
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jax.lax import stop_gradient
from jaxtyping import Array, Float, Int

from camring.numerics.coupled.step import (
    CoupledEquation,
    coupled_residual,
    coupled_step,
    forcing_at_stages,
    stage_extent,
)
from camring.numerics.crossing import crossings, with_nodes_at
from camring.numerics.mesh import (
    Breakpoints,
    ElementCount,
    Mesh,
    equidistribute,
    folded,
    follow_breakpoints,
    fourth_derivative_density,
    segment_ends,
)
from camring.numerics.newton import damped_newton
from camring.numerics.periodic import Orbit, extent
from camring.numerics.radau import STAGES
from camring.numerics.selection import larger, largest

TOLERANCE = 1e-9  # of Newton's step against the range of the states; one more step follows
ROUGH_TOLERANCE = 1e-3  # on the mesh that only serves to lay the next one
ITERATIONS = 40


class CoupledOrbit(NamedTuple):
    """One period of a copy and of each shared state, on one mesh."""

    own: Orbit
    shared: tuple[Orbit, ...]


def fold(mesh: Mesh, period: float, links: int) -> Mesh:
    """A mesh with nodes wherever any copy has one: every part divided like every other."""
    part = period / links
    _, within = folded(mesh.start, part, links)
    order = jnp.argsort(stop_gradient(within))
    start = within[order]
    width = larger(jnp.concatenate([start[1:], jnp.full(1, part)]) - start, 0)
    shifts = mesh.start[0] + part * jnp.arange(links)
    return Mesh(
        (shifts[:, None] + start).reshape(-1),
        jnp.tile(width, links),
        jnp.tile(mesh.is_first[order], links),
    )


def solve_coupled(
    equation: CoupledEquation,
    breakpoints: Breakpoints,
    period: float,
    links: int,
    elements: ElementCount,
    uncoupled: Orbit,
    shared_guess: Sequence[Float[Array, ""]],
) -> CoupledOrbit:
    """The periodic solution.

    Parameters
    ----------
    elements
        Of the mesh in one period of a copy, before it is folded.
    uncoupled
        An orbit of a copy without coupling: the first guess, and the first mesh.
    shared_guess
        The shared states, as if they stood still.

    Notes
    -----
    Nothing is raised; a residual that stays large is for the caller's verdict.
    Differentiable like `solve_periodic`: one last Newton step from a constant.
    """
    frozen, fixed = equation.frozen(), jax.tree.map(stop_gradient, breakpoints)

    def refine(current: tuple[Any, ...], tolerance: Array) -> tuple[Any, ...]:
        """Solves on a mesh, and lays the next one; kept is what was solved."""
        laid, stages = current
        mesh = fold(laid, period, links)
        stages, iterations = _newton(frozen, mesh, stages, tolerance)
        orbit = _orbit(frozen, mesh, stages, iterations)
        finer = _laid_anew(frozen, orbit, fixed, period, links, elements)
        own, *shared = (
            _at_stages(each, fold(finer, period, links), period)
            for each in (orbit.own, *orbit.shared)
        )
        return (finer, side_by_side(own, shared, links)), (laid, stages, iterations)

    alone = jax.tree.map(stop_gradient, uncoupled)
    own = _at_stages(alone, fold(alone.mesh, period, links), period)
    still = [jnp.broadcast_to(stop_gradient(each), own.shape) for each in shared_guess]
    tolerances = jnp.array([ROUGH_TOLERANCE, TOLERANCE])
    refined: tuple[Any, ...]
    _, refined = jax.lax.scan(refine, (alone.mesh, side_by_side(own, still, links)), tolerances)
    laid, stages, iterations = jax.tree.map(lambda each: each[-1], refined)

    mesh = fold(laid, period, links)
    return settle_coupled(equation, breakpoints, period, mesh, stages, iterations)


def settle_coupled(
    equation: CoupledEquation,
    breakpoints: Breakpoints,
    period: float,
    mesh: Mesh,
    stages: Float[Array, "3 state element"],
    iterations: Int[Array, ""],
) -> CoupledOrbit:
    """A solution at hand, on a folded mesh, as a function of the equation; see `settle`."""
    links = equation.links_of(stages)
    part, first = period / links, breakpoints.position[0]
    # Every part of the period has the breakpoints of all copies.
    _, within = folded(breakpoints.position, part, links)
    everywhere = (first + part * jnp.arange(links)[:, None] + jnp.sort(within)).reshape(-1)
    mesh = follow_breakpoints(mesh, everywhere, period)
    return _orbit(equation, mesh, stop_gradient(stages), iterations)


def _at_stages(orbit: Orbit, mesh: Mesh, period: float) -> Float[Array, "3 element"]:
    """States at the stages of a mesh that may reach beyond the orbit's own period."""
    first = orbit.mesh.start[0]
    return orbit.at_position(first + (mesh.at(jnp.asarray(STAGES)) - first) % period)


def side_by_side(
    own: Array, shared: Sequence[Array], links: int
) -> Float[Array, "3 state element"]:
    """Copies side by side and the shared states last, from one period of each."""
    parts = [each.reshape(3, links, -1)[:, :1] for each in shared]
    return jnp.concatenate([own.reshape(3, links, -1), *parts], axis=1)


def _newton(
    equation: CoupledEquation,
    mesh: Mesh,
    stages: Float[Array, "3 state element"],
    tolerance: Float[Array, ""],
) -> tuple[Float[Array, "3 state element"], Int[Array, ""]]:
    links = equation.links_of(stages)
    at_stages, width = forcing_at_stages(equation, mesh, links), mesh.width.reshape(links, -1)[0]

    def improved(current: Float[Array, "3 state element"]) -> Float[Array, "3 state element"]:
        return coupled_step(equation, at_stages, width, current)[1]

    def share(step: Array, reached: Array) -> Array:
        return largest(jnp.abs(step)) / stage_extent(reached, links)

    return damped_newton(improved, share, stages, tolerance, ITERATIONS)


def _orbit(
    equation: CoupledEquation,
    mesh: Mesh,
    stages: Float[Array, "3 state element"],
    iterations: Int[Array, ""],
) -> CoupledOrbit:
    """One more Newton step, and what it gives as orbits over the whole period."""
    links = equation.links_of(stages)
    at_stages, width = forcing_at_stages(equation, mesh, links), mesh.width.reshape(links, -1)[0]
    nodes, stages = coupled_step(equation, at_stages, width, stages)
    residual = coupled_residual(equation, at_stages, width, nodes, stages)
    whole = stages[:, :links].reshape(3, -1)
    return CoupledOrbit(
        Orbit(mesh, nodes[:links].reshape(-1), whole, residual, iterations),
        tuple(
            Orbit(
                mesh,
                jnp.tile(nodes[state], links),
                jnp.tile(stages[:, state], (1, links)),
                residual,
                iterations,
            )
            for state in range(links, stages.shape[1])
        ),
    )


def _laid_anew(
    equation: CoupledEquation,
    orbit: CoupledOrbit,
    breakpoints: Breakpoints,
    period: float,
    links: int,
    elements: ElementCount,
) -> Mesh:
    """A mesh of one period, not yet folded, by what copy and shared states do when coupled."""
    own, shared = orbit
    powers = own.coefficients
    whole = extent(own.stage_state)
    # A small swing of a shared state counts for less than its shape asks, and for more than
    # its size: by the mean of both no element is missing where a copy needs it.
    densities = [_density(period, own, whole)] + [
        _density(period, each, jnp.sqrt(whole * extent(each.stage_state))) for each in shared
    ]
    density = reduce(larger, densities)
    begin, end = segment_ends(breakpoints.position, period)
    forcing = equation.forcing_law(equation.parameters, begin, end - begin, jnp.zeros(1))
    state = own.at_position(begin[None])
    common = tuple(each.at_position(begin[None]) for each in shared)

    def rate(state: Float[Array, "1 breakpoint"]) -> Float[Array, "1 breakpoint"]:
        return equation.rate(equation.parameters, forcing, state, common)

    _, slope = jax.jvp(rate, (state,), (jnp.ones_like(state),))
    layer = 1 / larger(jnp.abs(slope[0]), 1 / period)
    laid = equidistribute(own.mesh, density, breakpoints, layer, period, elements)
    for level in equation.kinks:
        laid = with_nodes_at(laid, crossings(own.mesh, powers, level))
    end_of_part = own.mesh.start[0] + period / links
    for each in shared:
        for level in equation.shared_kinks:
            # In one part only: folding puts a node into every other.
            found = crossings(own.mesh, each.coefficients, level)
            laid = with_nodes_at(laid, jnp.where(found < end_of_part, found, jnp.nan))
        if equation.bends_at_equality:
            apart = powers - each.coefficients
            laid = with_nodes_at(laid, crossings(own.mesh, apart, jnp.zeros(())))
    return laid


def _density(period: float, orbit: Orbit, range_: Float[Array, ""]) -> Float[Array, " element"]:
    return fourth_derivative_density(orbit.mesh, orbit.coefficients[3], range_, period)

"""Periodic orbits of many equal equations that share one more state.

`links` copies of a scalar equation run through the same orbit `y`, each a
`links`-th of the period behind the one before, and all of them feed and are fed
by one shared state `z`, whose period therefore is that part:

    dy/dx = rate(forcing(x), y, z)
    dz/dx = shared_rate(z, sum over copies of draw(forcing, y, z))

Cut into parts and laid side by side, the whole period is one of the parts with
`links + 1` states, closed by a shift: each copy ends where the next began. It is
solved as `periodic.py` solves the scalar equation: Radau collocation, one Newton
iteration for all elements and the closure together. In each element the copies
meet in the shared state only, so stages are eliminated copy by copy, and three
stages of the shared state remain.

It is solved twice: roughly on a mesh laid from an orbit without coupling, and then
on one laid from that solution, which knows what the copies do to one another.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jax.lax import stop_gradient
from jaxtyping import Array, Float, Int

from camring.numerics.crossing import crossings, with_nodes_at
from camring.numerics.equation import Forcing
from camring.numerics.mesh import (
    Breakpoints,
    Mesh,
    equidistribute,
    folded,
    follow_breakpoints,
    fourth_derivative_density,
    segment_ends,
)
from camring.numerics.newton import damped_newton
from camring.numerics.periodic import Orbit, extent
from camring.numerics.radau import STAGE_INTEGRALS, STAGES, combine, solve_stages

TOLERANCE = 1e-9  # of Newton's step against the range of the states; one more step follows
ROUGH_TOLERANCE = 1e-3  # on the mesh that only serves to lay the next one
ITERATIONS = 40


class CoupledEquation(eqx.Module):
    """The two rates, elementwise, with their parameters in the open."""

    parameters: Any
    rate: Callable[..., Array] = eqx.field(static=True)
    """`(parameters, forcing, state, shared)`."""
    draw: Callable[..., Array] = eqx.field(static=True)
    """The same arguments: what one copy takes out of the shared state."""
    shared_rate: Callable[..., Array] = eqx.field(static=True)
    """`(parameters, shared, total drawn)`."""
    forcing_law: Callable[..., Forcing] = eqx.field(static=True)
    kinks: tuple[Float[Array, ""], ...] = ()
    """States of a copy at which its rate's slope may jump."""
    bends_at_equality: bool = eqx.field(static=True, default=False)
    """Whether it may jump, too, where a copy's state is the shared one."""

    def frozen(self) -> "CoupledEquation":
        """The same equation, through which no derivative passes to its parameters."""
        constant = jax.tree.map(stop_gradient, (self.parameters, self.kinks))
        return eqx.tree_at(lambda each: (each.parameters, each.kinks), self, constant)


class CoupledOrbit(NamedTuple):
    """One period of a copy and of the shared state, on one mesh."""

    own: Orbit
    shared: Orbit


class _Linear(NamedTuple):
    """Both rates, their slopes at the stages; of copies (3, link, element), else (3, element)."""

    rate: Array
    by_own: Array
    by_shared: Array
    shared_rate: Array
    shared_by_own: Array
    shared_by_shared: Array


def fold(mesh: Mesh, period: float, links: int) -> Mesh:
    """A mesh with nodes wherever any copy has one: every part divided like every other."""
    part = period / links
    _, within = folded(mesh.start, part, links)
    order = jnp.argsort(stop_gradient(within))
    start = within[order]
    width = jnp.maximum(jnp.concatenate([start[1:], jnp.full(1, part)]) - start, 0)
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
    elements: int,
    uncoupled: Orbit,
    shared_guess: Float[Array, ""],
) -> CoupledOrbit:
    """The periodic solution.

    Parameters
    ----------
    elements
        Of the mesh in one period of a copy, before it is folded.
    uncoupled
        An orbit of a copy without coupling: the first guess, and the first mesh.
    shared_guess
        The shared state, as if it stood still.

    Notes
    -----
    Nothing is raised; a residual that stays large is for the caller's verdict.
    Differentiable like `solve_periodic`: one last Newton step from a constant.
    """
    frozen, fixed = equation.frozen(), jax.tree.map(stop_gradient, breakpoints)

    def look(current: tuple, tolerance: Array) -> tuple:
        """Solves on a mesh, and lays the next one; kept is what was solved."""
        laid, stages = current
        mesh = fold(laid, period, links)
        stages, iterations = _newton(frozen, mesh, stages, tolerance)
        orbit = _orbit(frozen, mesh, stages, iterations)
        finer = _laid_anew(frozen, orbit, fixed, period, elements)
        own, shared = (_at_stages(each, fold(finer, period, links), period) for each in orbit)
        return (finer, side_by_side(own, shared, links)), (laid, stages, iterations)

    alone = jax.tree.map(stop_gradient, uncoupled)
    own = _at_stages(alone, fold(alone.mesh, period, links), period)
    still = jnp.broadcast_to(stop_gradient(shared_guess), own.shape)
    tolerances = jnp.array([ROUGH_TOLERANCE, TOLERANCE])
    looks: tuple
    _, looks = jax.lax.scan(look, (alone.mesh, side_by_side(own, still, links)), tolerances)
    laid, stages, iterations = jax.tree.map(lambda each: each[-1], looks)

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
    links = stages.shape[1] - 1
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


def side_by_side(own: Array, shared: Array, links: int) -> Float[Array, "3 state element"]:
    """Copies side by side and the shared state last, from one period of each."""
    part = shared.reshape(3, links, -1)[:, :1]
    return jnp.concatenate([own.reshape(3, links, -1), part], axis=1)


def _newton(
    equation: CoupledEquation,
    mesh: Mesh,
    stages: Float[Array, "3 state element"],
    tolerance: Float[Array, ""],
) -> tuple[Float[Array, "3 state element"], Int[Array, ""]]:
    links = stages.shape[1] - 1
    at_stages, width = _forcing(equation, mesh, links), mesh.width.reshape(links, -1)[0]

    def improved(current: Float[Array, "3 state element"]) -> Float[Array, "3 state element"]:
        return _step(equation, at_stages, width, current)[1]

    return damped_newton(improved, _own_extent, stages, tolerance, ITERATIONS)


def _orbit(
    equation: CoupledEquation,
    mesh: Mesh,
    stages: Float[Array, "3 state element"],
    iterations: Int[Array, ""],
) -> CoupledOrbit:
    """One more Newton step, and what it gives as orbits over the whole period."""
    links = stages.shape[1] - 1
    at_stages, width = _forcing(equation, mesh, links), mesh.width.reshape(links, -1)[0]
    nodes, stages = _step(equation, at_stages, width, stages)
    residual = _residual(equation, at_stages, width, nodes, stages)
    whole = stages[:, :-1].reshape(3, -1)
    repeated = jnp.tile(stages[:, -1], (1, links))
    return CoupledOrbit(
        Orbit(mesh, nodes[:-1].reshape(-1), whole, residual, iterations),
        Orbit(mesh, jnp.tile(nodes[-1], links), repeated, residual, iterations),
    )


def _laid_anew(
    equation: CoupledEquation,
    orbit: CoupledOrbit,
    breakpoints: Breakpoints,
    period: float,
    elements: int,
) -> Mesh:
    """A mesh of one period, not yet folded, by what the copy does when coupled."""
    own, shared = orbit
    powers = own.coefficients
    density = fourth_derivative_density(own.mesh, powers[3], extent(own.stage_state), period)
    begin, end = segment_ends(breakpoints.position, period)
    forcing = equation.forcing_law(equation.parameters, begin, end - begin, jnp.zeros(1))
    state, common = (orbit.at_position(begin[None]) for orbit in (own, shared))

    def rate(state: Float[Array, "1 breakpoint"]) -> Float[Array, "1 breakpoint"]:
        return equation.rate(equation.parameters, forcing, state, common)

    _, slope = jax.jvp(rate, (state,), (jnp.ones_like(state),))
    layer = 1 / jnp.maximum(jnp.abs(slope[0]), 1 / period)
    laid = equidistribute(own.mesh, density, breakpoints, layer, period, elements)
    for level in equation.kinks:
        laid = with_nodes_at(laid, crossings(own.mesh, powers, level))
    if equation.bends_at_equality:
        apart = powers - shared.coefficients
        laid = with_nodes_at(laid, crossings(own.mesh, apart, jnp.zeros(())))
    return laid


def _forcing(equation: CoupledEquation, mesh: Mesh, links: int) -> Forcing:
    """The forcing at the stages, leaves (3, link, element)."""
    flat = equation.forcing_law(equation.parameters, mesh.start, mesh.width, jnp.asarray(STAGES))
    return jax.tree.map(lambda leaf: leaf.reshape(3, links, -1), flat)


def _linear(equation: CoupledEquation, forcing: Forcing, stages: Array) -> _Linear:
    own, shared = stages[:, :-1], stages[:, -1:]
    spread = jnp.broadcast_to(shared, own.shape)
    one, none = jnp.ones_like(own), jnp.zeros_like(own)

    def both(state: Array, common: Array) -> tuple[Array, Array]:
        return (
            equation.rate(equation.parameters, forcing, state, common),
            equation.draw(equation.parameters, forcing, state, common),
        )

    (rate, drawn), (by_own, drawn_by_own) = jax.jvp(both, (own, spread), (one, none))
    _, (by_shared, drawn_by_shared) = jax.jvp(both, (own, spread), (none, one))
    total, common = jnp.sum(drawn, axis=1), stages[:, -1]

    def of_shared(state: Array, taken: Array) -> Array:
        return equation.shared_rate(equation.parameters, state, taken)

    one, none = jnp.ones_like(common), jnp.zeros_like(common)
    shared_rate, direct = jax.jvp(of_shared, (common, total), (one, none))
    _, by_total = jax.jvp(of_shared, (common, total), (none, one))
    return _Linear(
        rate,
        stop_gradient(by_own),
        stop_gradient(by_shared),
        shared_rate,
        stop_gradient(by_total[:, None] * drawn_by_own),
        stop_gradient(direct + by_total * jnp.sum(drawn_by_shared, axis=1)),
    )


def _step(
    equation: CoupledEquation, forcing: Forcing, width: Float[Array, " element"], stages: Array
) -> tuple[Float[Array, "state element"], Float[Array, "3 state element"]]:
    """One Newton step of all collocation equations and the closure together.

    Returns states at the nodes and the stages, the shared one last.
    """
    here = _linear(equation, forcing, stages)
    integrals = STAGE_INTEGRALS
    step = stop_gradient(width)

    def weighted(row: int, slopes: Array) -> list[Array]:
        return [step * float(integrals[row, j]) * slopes[j] for j in range(3)]

    # Every copy: its stages from its start, from itself, and from the shared stages.
    own_matrix = [
        [float(i == j) - entry for j, entry in enumerate(weighted(i, here.by_own))]
        for i in range(3)
    ]
    own_defect = [width * combine(integrals[i], list(here.rate)) - stages[i, :-1] for i in range(3)]
    ones = jnp.ones_like(stages[0, :-1])
    pulled = [[weighted(i, here.by_shared)[j] for i in range(3)] for j in range(3)]
    growth, offset, *response = solve_stages(own_matrix, [ones] * 3, own_defect, *pulled)

    # The shared state, with every copy's answer in it.
    def felt(answer: list[Array]) -> list[Array]:
        """What the copies' stages do to the shared equations, each copy by itself."""
        return [_dot(weighted(i, here.shared_by_own), answer) for i in range(3)]

    back = [[jnp.sum(each, axis=0) for each in felt(response[j])] for j in range(3)]
    shared_matrix = [
        [float(i == j) - weighted(i, here.shared_by_shared)[j] - back[j][i] for j in range(3)]
        for i in range(3)
    ]
    shared_defect = [
        width * combine(integrals[i], list(here.shared_rate))
        - stages[i, -1]
        + jnp.sum(felt(offset)[i], axis=0)
        for i in range(3)
    ]
    one = jnp.ones_like(step)
    from_itself, alone = solve_stages(shared_matrix, [one] * 3, shared_defect)
    broad = [[jnp.broadcast_to(entry, ones.shape) for entry in row] for row in shared_matrix]
    (from_copies,) = solve_stages(broad, felt(growth))

    # From the states at an element's start to all its stages: (3, state, state, element).
    def through(shared_answer: list[Array]) -> list[Array]:
        """Stages of the copies that follow from stages of the shared state."""
        return [_dot([response[j][i] for j in range(3)], shared_answer) for i in range(3)]

    links = ones.shape[0]
    identity = jnp.eye(links)[..., None]
    transfer, constant = [], []
    for i in range(3):
        copies = identity * growth[i][None] + sum(
            response[j][i][:, None] * from_copies[j][None] for j in range(3)
        )
        column = through(from_itself)[i][:, None]
        upper = jnp.concatenate([copies, column], axis=1)
        lower = jnp.concatenate([from_copies[i], from_itself[i][None]], axis=0)[None]
        transfer.append(jnp.concatenate([upper, lower], axis=0))
        rest = jnp.concatenate([(offset[i] + through(alone)[i]), alone[i][None]], axis=0)
        constant.append(stages[i] + rest)
    nodes = _close(transfer[2], constant[2])
    updated = jnp.stack(
        [
            jnp.sum(matrix * nodes[None], axis=1) + rest
            for matrix, rest in zip(transfer, constant, strict=True)
        ]
    )
    return nodes, updated


def _dot(factors: list[Array], arrays: list[Array]) -> Array:
    """Sum of three products, written out so that it fuses with what is around it."""
    first, second, third = zip(factors, arrays, strict=True)
    return first[0] * first[1] + second[0] * second[1] + third[0] * third[1]


def _close(
    transfer: Float[Array, "state state element"], constant: Float[Array, "state element"]
) -> Float[Array, "state element"]:
    """States at all nodes: each copy ends where the next began, the shared one where it began."""

    def compose(so_far: tuple, element: tuple) -> tuple:
        product, total = so_far
        matrix, rest = element
        return (matrix @ product, matrix @ total + rest), so_far

    count = constant.shape[0]
    start = (jnp.eye(count), jnp.zeros(count))
    products: Array
    totals: Array
    (product, total), (products, totals) = jax.lax.scan(
        compose, start, (jnp.moveaxis(transfer, -1, 0), constant.T)
    )
    following = [*range(1, count - 1), 0, count - 1]
    first = jnp.linalg.solve(jnp.eye(count)[jnp.array(following)] - product, total)
    return (products @ first + totals).T


def _own_extent(stages: Array) -> Float[Array, ""]:
    """Range of a copy's orbit: the shared state moves less, but in the same unit."""
    return extent(stages[:, :-1])


def _residual(
    equation: CoupledEquation,
    forcing: Forcing,
    width: Float[Array, " element"],
    nodes: Array,
    stages: Array,
) -> Float[Array, ""]:
    """Largest violation of stage equations or closure, over the range of a copy's orbit."""
    here = _linear(equation, forcing, stages)
    rate = jnp.concatenate([here.rate, here.shared_rate[:, None]], axis=1)
    errors = [
        jnp.abs(nodes + width * combine(row, list(rate)) - stages[i])
        for i, row in enumerate(STAGE_INTEGRALS)
    ]
    inner = jnp.abs(stages[2, :, :-1] - nodes[:, 1:])
    ends, begins = stages[2, :, -1], nodes[:, 0]
    closure = jnp.abs(ends - jnp.concatenate([jnp.roll(begins[:-1], -1), begins[-1:]]))
    largest = jnp.max(jnp.stack(errors))
    return jnp.maximum(jnp.maximum(largest, jnp.max(inner)), jnp.max(closure)) / _own_extent(stages)

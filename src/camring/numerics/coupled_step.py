"""One Newton step for many equal equations that share one more state.

In each element the copies meet in the shared state only: their stages are
eliminated copy by copy as functions of their start and of the three stages of the
shared state, and a 3 x 3 Schur complement is left for those. An element becomes
an affine map of all states; a scan multiplies the maps, and one linear solve closes
the period, each copy ending where the next began.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jax.lax import stop_gradient
from jaxtyping import Array, Float

from camring.numerics.equation import Forcing
from camring.numerics.mesh import Mesh
from camring.numerics.periodic import extent
from camring.numerics.radau import STAGE_INTEGRALS, STAGES, combine, solve_stages


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


class _Linear(NamedTuple):
    """Both rates, their slopes at the stages; of copies (3, link, element), else (3, element)."""

    rate: Array
    by_own: Array
    by_shared: Array
    shared_rate: Array
    shared_by_own: Array
    shared_by_shared: Array


def forcing_at_stages(equation: CoupledEquation, mesh: Mesh, links: int) -> Forcing:
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


def coupled_step(
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


def own_extent(stages: Array) -> Float[Array, ""]:
    """Range of a copy's orbit: the shared state moves less, but in the same unit."""
    return extent(stages[:, :-1].reshape(3, -1))


def coupled_residual(
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
    return jnp.maximum(jnp.maximum(largest, jnp.max(inner)), jnp.max(closure)) / own_extent(stages)

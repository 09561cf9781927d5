"""One Newton step for many equal equations that share one or a few more states.

In each element the copies meet in the shared states only: their stages are
eliminated copy by copy as functions of their start and of the three stages of each
shared state, and a small dense Schur complement is left for those, of three rows for
each. An element becomes an affine map of all states; a scan multiplies the maps, and one
linear solve closes the period, each copy ending where the next began.
"""

from collections.abc import Callable
from functools import reduce
from operator import add
from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jax.lax import stop_gradient
from jaxtyping import Array, Float

from camring.numerics.compilation import computed_once
from camring.numerics.equation import Forcing
from camring.numerics.mesh import Mesh
from camring.numerics.periodic import extent
from camring.numerics.radau import STAGE_INTEGRALS, STAGES, combine, solve_stages
from camring.numerics.selection import larger, largest


class CoupledEquation(eqx.Module):
    """The two rates, elementwise, with their parameters in the open.

    Shared states and what is drawn from them are tuples, one array for each.
    """

    parameters: Any
    rate: Callable[..., Array] = eqx.field(static=True)
    """`(parameters, forcing, state, shared)`."""
    draw: Callable[..., tuple[Array, ...]] = eqx.field(static=True)
    """The same arguments: what one copy takes out of each shared state."""
    shared_rate: Callable[..., tuple[Array, ...]] = eqx.field(static=True)
    """`(parameters, shared, total drawn)`."""
    shared_count: int = eqx.field(static=True)
    forcing_law: Callable[..., Forcing] = eqx.field(static=True)
    kinks: tuple[Float[Array, ""], ...] = ()
    """States of a copy at which its rate's slope may jump."""
    shared_kinks: tuple[Float[Array, ""], ...] = ()
    """Shared states at which their own may."""
    bends_at_equality: bool = eqx.field(static=True, default=False)
    """Whether it may jump, too, where a copy's state is a shared one."""

    def frozen(self) -> "CoupledEquation":
        """The same equation, through which no derivative passes to its parameters."""
        given = (self.parameters, self.kinks, self.shared_kinks)
        constant = jax.tree.map(stop_gradient, given)
        return eqx.tree_at(
            lambda each: (each.parameters, each.kinks, each.shared_kinks), self, constant
        )

    def links_of(self, stages: Float[Array, "3 state element"]) -> int:
        """Copies among the states that lie side by side, the shared ones last."""
        return stages.shape[1] - self.shared_count


class _Linear(NamedTuple):
    """Both rates, their slopes at the stages; of copies (3, link, element), else (3, element).

    In tuples one array for each shared state, first that whose rate it is.
    """

    rate: Array
    by_own: Array
    by_shared: tuple[Array, ...]
    shared_rate: tuple[Array, ...]
    shared_by_own: tuple[Array, ...]
    shared_by_shared: tuple[tuple[Array, ...], ...]


def forcing_at_stages(equation: CoupledEquation, mesh: Mesh, links: int) -> Forcing:
    """The forcing at the stages, leaves (3, link, element)."""
    flat = equation.forcing_law(equation.parameters, mesh.start, mesh.width, jnp.asarray(STAGES))
    return jax.tree.map(lambda leaf: leaf.reshape(3, links, -1), flat)


def _slope(function: Callable[[Array], Any], at: Array) -> tuple[Any, Any]:
    """Value and elementwise slope."""
    return jax.jvp(function, (at,), (jnp.ones_like(at),))


def _slope_by(
    number: int, function: Callable[[tuple[Any, ...]], Any], at: tuple[Array, ...]
) -> Any:
    """Elementwise slope by one of some arrays."""
    return _slope(lambda one: function((*at[:number], one, *at[number + 1 :])), at[number])[1]


def _linear(equation: CoupledEquation, forcing: Forcing, stages: Array) -> _Linear:
    links, numbers = equation.links_of(stages), range(equation.shared_count)
    own = stages[:, :links]
    common = tuple(stages[:, links + s] for s in numbers)
    spread = tuple(jnp.broadcast_to(each[:, None], own.shape) for each in common)

    def both(state: Array, shared: tuple[Any, ...]) -> tuple[Array, tuple[Array, ...]]:
        return (
            equation.rate(equation.parameters, forcing, state, shared),
            equation.draw(equation.parameters, forcing, state, shared),
        )

    def of_shared(shared: tuple[Any, ...], taken: tuple[Any, ...]) -> tuple[Array, ...]:
        return equation.shared_rate(equation.parameters, shared, taken)

    # What does not depend on an argument stays outside of its derivative.
    (rate, drawn), (by_own, drawn_by_own) = _slope(lambda state: both(state, spread), own)
    by_each = [_slope_by(t, lambda shared: both(own, shared), spread) for t in numbers]
    total = tuple(jnp.sum(each, axis=1) for each in drawn)
    shared_rate = of_shared(common, total)
    direct = [_slope_by(t, lambda shared: of_shared(shared, total), common) for t in numbers]
    by_total = [_slope_by(t, lambda taken: of_shared(common, taken), total) for t in numbers]

    def through_draw(s: int, change: tuple[Array, ...]) -> Array:
        """How a shared rate follows a change of what is drawn."""
        return sum_of([by_total[t][s] * change[t] for t in numbers])

    def by_shared_state(s: int, t: int) -> Array:
        drawn_by_it = tuple(jnp.sum(each, axis=1) for each in by_each[t][1])
        return direct[t][s] + through_draw(s, drawn_by_it)

    def by_own_state(s: int) -> Array:
        return sum_of([by_total[t][s][:, None] * drawn_by_own[t] for t in numbers])

    return _Linear(
        rate,
        stop_gradient(by_own),
        stop_gradient(tuple(slope for slope, _ in by_each)),
        shared_rate,
        stop_gradient(tuple(map(by_own_state, numbers))),
        stop_gradient(tuple(tuple(by_shared_state(s, t) for t in numbers) for s in numbers)),
    )


def coupled_step(
    equation: CoupledEquation, forcing: Forcing, width: Float[Array, " element"], stages: Array
) -> tuple[Float[Array, "state element"], Float[Array, "3 state element"]]:
    """One Newton step of all collocation equations and the closure together.

    Returns states at the nodes and the stages, the shared ones last.
    """
    here = computed_once(_linear(equation, forcing, stages))
    links, numbers = equation.links_of(stages), range(equation.shared_count)
    integrals = STAGE_INTEGRALS
    step = stop_gradient(width)

    def weighted(row: int, slopes: Array) -> list[Array]:
        return [step * float(integrals[row, j]) * slopes[j] for j in range(3)]

    # Every copy: its stages from its start, from itself, and from the shared stages.
    chamber_matrix = [
        [float(i == j) - entry for j, entry in enumerate(weighted(i, here.by_own))]
        for i in range(3)
    ]
    chamber_defect = [
        width * combine(integrals[i], list(here.rate)) - stages[i, :links] for i in range(3)
    ]
    ones = jnp.ones_like(stages[0, :links])
    places = [(s, i) for s in numbers for i in range(3)]  # stages of the shared states
    pulled = [[weighted(i, here.by_shared[t])[j] for i in range(3)] for t, j in places]
    growth, offset, *response = computed_once(
        solve_stages(chamber_matrix, [ones] * 3, chamber_defect, *pulled)
    )

    # The shared states, with every copy's answer in them.
    def felt(answer: list[Array]) -> list[Array]:
        """What the copies' stages do to the shared equations, each copy by itself."""
        return [sum_of(_products(weighted(i, here.shared_by_own[s]), answer)) for s, i in places]

    back = [[jnp.sum(each, axis=0) for each in felt(answer)] for answer in response]
    shared_matrix = [
        [
            float((s, i) == (t, j))
            - weighted(i, here.shared_by_shared[s][t])[j]
            - back[column][row]
            for column, (t, j) in enumerate(places)
        ]
        for row, (s, i) in enumerate(places)
    ]
    shared_defect = [
        width * combine(integrals[i], list(here.shared_rate[s]))
        - stages[i, links + s]
        + jnp.sum(each, axis=0)
        for (s, i), each in zip(places, felt(offset), strict=True)
    ]
    one, none = jnp.ones_like(step), jnp.zeros_like(step)
    starts = [[one if s == t else none for s, _ in places] for t in numbers]
    # The last right side has one of its kind for every copy.
    *from_shared, alone, from_copies = computed_once(
        solve_stages(shared_matrix, *starts, shared_defect, felt(growth))
    )

    # From the states at an element's start to all its stages: (3, state, state, element).
    def through(shared_answer: list[Array], i: int) -> Array:
        """A stage of the copies that follows from stages of the shared states."""
        return sum_of(_products([answer[i] for answer in response], shared_answer))

    identity = jnp.eye(links)[..., None]
    transfer, constant = [], []
    for i in range(3):
        copies = identity * growth[i][None] + sum_of(
            [
                answer[i][:, None] * from_copy[None]
                for answer, from_copy in zip(response, from_copies, strict=True)
            ]
        )
        columns = [through(answer, i)[:, None] for answer in from_shared]
        rows = [jnp.concatenate([copies, *columns], axis=1)]
        for s in numbers:
            own = [answer[3 * s + i][None] for answer in from_shared]
            rows.append(jnp.concatenate([from_copies[3 * s + i], *own], axis=0)[None])
        transfer.append(jnp.concatenate(rows, axis=0))
        own_rest = [alone[3 * s + i][None] for s in numbers]
        rest = jnp.concatenate([offset[i] + through(alone, i), *own_rest], axis=0)
        constant.append(stages[i] + rest)
    nodes = _close(transfer[2], constant[2], links)
    updated = jnp.stack(
        [
            jnp.sum(matrix * nodes[None], axis=1) + rest
            for matrix, rest in zip(transfer, constant, strict=True)
        ]
    )
    return nodes, updated


def _products(factors: list[Array], arrays: list[Array]) -> list[Array]:
    return [factor * array for factor, array in zip(factors, arrays, strict=True)]


def sum_of(arrays: list[Array]) -> Array:
    """A short sum, written out so that it fuses with what is around it."""
    return reduce(add, arrays)


def _close(
    transfer: Float[Array, "state state element"],
    constant: Float[Array, "state element"],
    links: int,
) -> Float[Array, "state element"]:
    """States at all nodes: each copy ends where the next began, a shared one where it began."""

    def compose(so_far: tuple[Any, ...], element: tuple[Any, ...]) -> tuple[Any, ...]:
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
    following = [*range(1, links), 0, *range(links, count)]
    first = jnp.linalg.solve(jnp.eye(count)[jnp.array(following)] - product, total)
    return (products @ first + totals).T


def stage_extent(stages: Array, links: int) -> Float[Array, ""]:
    """Range of a copy's orbit: shared states move less, but in the same unit."""
    return extent(stages[:, :links].reshape(3, -1))


def coupled_residual(
    equation: CoupledEquation,
    forcing: Forcing,
    width: Float[Array, " element"],
    nodes: Array,
    stages: Array,
) -> Float[Array, ""]:
    """Largest violation of stage equations or closure, over the range of a copy's orbit."""
    here = _linear(equation, forcing, stages)
    links = equation.links_of(stages)
    rate = jnp.concatenate([here.rate, jnp.stack(here.shared_rate, axis=1)], axis=1)
    errors = [
        jnp.abs(nodes + width * combine(row, list(rate)) - stages[i])
        for i, row in enumerate(STAGE_INTEGRALS)
    ]
    inner = jnp.abs(stages[2, :, :-1] - nodes[:, 1:])
    ends, begins = stages[2, :, -1], nodes[:, 0]
    following = jnp.concatenate([jnp.roll(begins[:links], -1), begins[links:]])
    worst = largest(jnp.stack(errors))
    missed = larger(largest(inner), largest(jnp.abs(ends - following)))
    return larger(worst, missed) / stage_extent(stages, links)

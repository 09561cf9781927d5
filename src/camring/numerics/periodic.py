"""The periodic orbit of one stiff scalar equation, found directly.

Given `dy/dx = rate(forcing(x), y)` with a forcing of known period and known
breakpoints, this finds `y` with `y(x + period) = y(x)` by collocation: one
Newton iteration acts on every element of the period at once, and the condition
of periodicity closes the linear system. No revolution is marched to decay.

Method
------
Radau IIA with three stages, order 5, L-stable, stiffly accurate (Ehle 1969;
Hairer and Wanner 1996, section IV.5). In each element the linearised stage
equations are a 3 x 3 system; eliminating the stages leaves
`y[k+1] = growth[k] y[k] + offset[k]`, a cyclic recurrence whose product of
growths is the Floquet multiplier of the orbit, so the periodic solve costs one
pass and tells how unique the orbit is.

The mesh has a fixed number of elements and keeps every breakpoint as a node.
It is laid three times by equidistribution (de Boor 1973): from a backward Euler
sweep on a graded mesh, again from the sweep repeated on that mesh, and last
from the fourth derivative of the collocation solution itself.

Derivatives pass through one last Newton step taken from a constant, which is
the implicit function theorem on the discrete orbit; the mesh moves with its
breakpoints, element fractions held.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jax.lax import stop_gradient
from jaxtyping import Array, Bool, Float, Int

STAGES = np.array([(4 - 6**0.5) / 10, (4 + 6**0.5) / 10, 1.0])
"""Radau points of an element of unit width."""


def _stage_integrals() -> np.ndarray:
    """Integrals from 0 to each stage of the polynomials that interpolate the stages."""
    powers = np.arange(3)
    integrated = STAGES[:, None] ** (powers + 1) / (powers + 1)
    return integrated @ np.linalg.inv(STAGES[:, None] ** powers)


STAGE_INTEGRALS = _stage_integrals()
"""The Butcher matrix; its last row holds the quadrature weights."""

_TO_POWERS = np.linalg.inv(np.vander(np.concatenate([[0.0], STAGES]), 4, increasing=True))

Forcing = Any


class Equation(eqx.Module):
    """`dy/dx = rate(parameters, forcing, y)`, with its parameters in the open.

    `rate` is elementwise in forcing and state. `forcing(parameters, start,
    width, fraction)` gives the forcing at the same fractions of every element,
    leaves of shape (element, point).
    """

    parameters: Any
    rate_law: Callable[..., Float[Array, "*grid"]] = eqx.field(static=True)
    forcing_law: Callable[..., Forcing] = eqx.field(static=True)

    def rate(self, forcing: Forcing, state: Float[Array, "*grid"]) -> Float[Array, "*grid"]:
        return self.rate_law(self.parameters, forcing, state)

    def rate_and_slope(
        self, forcing: Forcing, state: Float[Array, "*grid"]
    ) -> tuple[Float[Array, "*grid"], Float[Array, "*grid"]]:
        """The rate and its derivative with respect to the state."""
        return jax.jvp(lambda y: self.rate(forcing, y), (state,), (jnp.ones_like(state),))

    def forcing(self, mesh: "Mesh", fraction: Float[Array, " point"]) -> Forcing:
        return self.forcing_law(self.parameters, mesh.start, mesh.width, fraction)

    def frozen(self) -> "Equation":
        """The same equation, through which no derivative passes to its parameters."""
        constant = jax.tree.map(stop_gradient, self.parameters)
        return Equation(constant, self.rate_law, self.forcing_law)


class PeriodicResolution(NamedTuple):
    """How finely an orbit is looked at; all static."""

    elements: int
    """Elements in one period, more than there are breakpoints."""
    refinements: int = 1
    """Times the mesh is laid anew from a collocation solution."""
    iterations: int = 24
    """Newton iterations at most, on each of the two collocation meshes."""
    tolerance: float = 1e-11
    """Newton stops when its step is this small against the range of the orbit."""


class Breakpoints(NamedTuple):
    """Where the forcing is not smooth, ascending within one period; may coincide."""

    position: Float[Array, " breakpoint"]
    sharp: Bool[Array, " breakpoint"]
    """Whether the rate itself has a kink there, after which a stiff state lags in a thin layer."""


class Mesh(NamedTuple):
    """Elements of one period; zero-width ones are allowed."""

    start: Float[Array, " element"]
    width: Float[Array, " element"]
    is_first: Bool[Array, " element"]
    """Whether a breakpoint lies at the element's start."""


class Orbit(eqx.Module):
    """One period of the solution: cubic in each element.

    At fraction `x` of element `k` the state is `sum_p coefficients[k, p] x^p`.
    """

    mesh: Mesh
    node_state: Float[Array, " element"]
    stage_state: Float[Array, "element 3"]
    multiplier: Float[Array, ""]
    """Floquet multiplier: what remains of a disturbance after one period."""
    residual: Float[Array, ""]
    """Largest error of the collocation equations, periodicity included, over the range."""
    iterations: Int[Array, ""]

    @property
    def coefficients(self) -> Float[Array, "element 4"]:
        return element_powers(self.node_state, self.stage_state)

    def at(self, fraction: Float[Array, " point"]) -> Float[Array, "element point"]:
        """State at the same fractions of every element."""
        return self.coefficients @ (fraction ** np.arange(4)[:, None])

    def slope(self, fraction: Float[Array, " point"]) -> Float[Array, "element point"]:
        """Derivative of the state by the angle, at fractions of every element."""
        rise = self.coefficients[:, 1:] @ (
            np.arange(1, 4)[:, None] * fraction ** np.arange(3)[:, None]
        )
        width = self.mesh.width[:, None]
        return jnp.where(width > 0, rise / jnp.where(width > 0, width, 1), 0)

    def at_positions(self, position: Float[Array, "*grid"]) -> Float[Array, "*grid"]:
        """State at positions within the period that the mesh covers."""
        return _interpolate(self.mesh, self.coefficients, position)


def element_powers(
    node_state: Float[Array, " element"], stage_state: Float[Array, "element 3"]
) -> Float[Array, "element 4"]:
    """Coefficients of the cubic through an element's start and its three stages."""
    return jnp.concatenate([node_state[:, None], stage_state], axis=1) @ _TO_POWERS.T


def solve_periodic(
    equation: Equation,
    breakpoints: Breakpoints,
    period: float,
    guess: Float[Array, ""],
    resolution: PeriodicResolution,
) -> Orbit:
    """The periodic solution of an equation.

    Parameters
    ----------
    equation
        Its rate should decrease with the state, or the orbit may not be unique.
    guess
        A state from which a backward Euler sweep may begin.

    Notes
    -----
    Nothing is raised: a residual that stays large or a multiplier at one are
    for the caller's verdict. Traceable, batchable with `vmap`, differentiable
    in both modes.
    """
    fixed = jax.tree.map(stop_gradient, breakpoints)
    frozen = equation.frozen()

    mesh = _graded_mesh(fixed.position, period)
    nodes = _backward_euler(frozen, mesh, stop_gradient(guess), sweeps=2)
    for _ in range(2):
        density = _curvature_density(mesh, nodes, period)
        layer = _layer_width(frozen, mesh, nodes[:-1], period, fixed)
        mesh = _equidistribute(mesh, density, fixed, layer, period, resolution.elements)
        nodes = _backward_euler(frozen, mesh, nodes[-1], sweeps=1)
    stages = _stage_guess(frozen, mesh, nodes)
    stages, _ = _newton(frozen, mesh, stages, resolution)

    for _ in range(resolution.refinements):
        node_state, stages, _ = _periodic_step(frozen, mesh, stages)
        density = _fourth_derivative_density(mesh, node_state, stages, period)
        layer = _layer_width(frozen, mesh, node_state, period, fixed)
        old_mesh, powers = mesh, element_powers(node_state, stages)
        mesh = _equidistribute(old_mesh, density, fixed, layer, period, resolution.elements)
        places = mesh.start[:, None] + mesh.width[:, None] * STAGES
        stages = _interpolate(old_mesh, powers, places)
        stages, iterations = _newton(frozen, mesh, stages, resolution)

    mesh = _follow_breakpoints(mesh, breakpoints.position, period)
    stages = stop_gradient(stages)
    node_state, stages, multiplier = _periodic_step(equation, mesh, stages)
    residual = _collocation_residual(equation, mesh, node_state, stages)
    return Orbit(mesh, node_state, stages, multiplier, residual, iterations)


# --- meshes ---------------------------------------------------------------


def _segment_ends(breakpoints: Array, period: float) -> tuple[Array, Array]:
    following = jnp.concatenate([breakpoints[1:], breakpoints[:1] + period])
    return breakpoints, following


def _graded_mesh(breakpoints: Float[Array, " breakpoint"], period: float) -> Mesh:
    """Six elements between breakpoints, finer towards both."""
    per_segment = 6
    fractions = (np.tanh(2.2 * np.linspace(-1, 1, per_segment + 1)) / np.tanh(2.2) + 1) / 2
    begin, end = _segment_ends(breakpoints, period)
    span = (end - begin)[:, None]
    start = begin[:, None] + span * fractions[:-1]
    width = span * np.diff(fractions)
    first = np.tile(np.arange(per_segment) == 0, len(breakpoints))
    return Mesh(start.reshape(-1), width.reshape(-1), jnp.asarray(first))


LAYER_ELEMENTS = 2
"""Elements kept for the thin layer behind each sharp breakpoint."""


def _layer_width(
    equation: Equation,
    mesh: Mesh,
    node_state: Float[Array, " element"],
    period: float,
    breakpoints: Breakpoints,
) -> Float[Array, " breakpoint"]:
    """Relaxation length `1/|slope of the rate|` just behind each breakpoint."""
    at_start = jax.tree.map(lambda leaf: leaf[:, 0], equation.forcing(mesh, jnp.zeros(1)))
    _, slope = equation.rate_and_slope(at_start, node_state)
    first = jnp.nonzero(mesh.is_first, size=breakpoints.position.shape[0])[0]
    return 1 / jnp.maximum(jnp.abs(slope[first]), 1 / period)


def _equidistribute(
    mesh: Mesh,
    density: Float[Array, " element"],
    breakpoints: Breakpoints,
    layer: Float[Array, " breakpoint"],
    period: float,
    elements: int,
) -> Mesh:
    """A mesh whose elements hold equal shares of the density's integral.

    Each segment between breakpoints gets at least one element; the counts are
    rounded, so nodes fall on breakpoints exactly. A segment that begins at a
    sharp breakpoint gets two thin ones more, of three and nine relaxation lengths.
    """
    begin, end = _segment_ends(breakpoints.position, period)
    mass = jnp.concatenate([jnp.zeros(1), jnp.cumsum(density * mesh.width)])
    node = jnp.concatenate([mesh.start, begin[:1] + period])
    bounds = jnp.concatenate([begin, end[-1:]])
    mass_at = jnp.interp(bounds, node, mass)
    thin = LAYER_ELEMENTS * breakpoints.sharp
    promised = jnp.concatenate([jnp.zeros(1, thin.dtype), jnp.cumsum(1 + thin)])
    wanted = jnp.round(mass_at / mass_at[-1] * (elements - promised[-1]))
    first_element = wanted.astype(jnp.int32) + promised

    element = jnp.arange(elements)
    segment = jnp.searchsorted(first_element, element, side="right") - 1
    ordinary = first_element[segment + 1] - first_element[segment] - thin[segment]

    def by_density(share: Array) -> Array:
        target = mass_at[segment] + share * (mass_at[segment + 1] - mass_at[segment])
        inner = jnp.clip(jnp.interp(target, mass, node), begin[segment], end[segment])
        outer = jnp.where(share <= 0, begin[segment], end[segment])
        return jnp.where((share <= 0) | (share >= 1), outer, inner)

    first_width = by_density(1 / ordinary) - begin[segment]
    one = jnp.minimum(3 * layer[segment], first_width / 8)
    two = jnp.minimum(12 * layer[segment], first_width / 2)

    def place(index: Array) -> Array:
        past_thin = index - first_element[segment] - thin[segment]
        regular = by_density(jnp.maximum(past_thin, 0) / ordinary)
        within = jnp.where(past_thin == -1, one, jnp.where(past_thin == 0, two, 0.0))
        in_layer = (thin[segment] > 0) & (past_thin <= 0)
        return jnp.where(in_layer, begin[segment] + within, regular)

    start = place(element)
    width = jnp.maximum(place(element + 1) - start, 0)
    return Mesh(start, width, element == first_element[segment])


def _follow_breakpoints(
    mesh: Mesh, breakpoints: Float[Array, " breakpoint"], period: float
) -> Mesh:
    """The same mesh, its nodes carried along by the breakpoints they lie between."""
    begin, end = _segment_ends(breakpoints, period)
    segment = jnp.cumsum(mesh.is_first) - 1
    span = stop_gradient(end - begin)[segment]
    safe = jnp.where(span > 0, span, 1.0)
    left = stop_gradient(jnp.where(span > 0, (mesh.start - begin[segment]) / safe, 0.0))
    share = stop_gradient(jnp.where(span > 0, mesh.width / safe, 0.0))
    moving = (end - begin)[segment]
    return Mesh(begin[segment] + left * moving, share * moving, mesh.is_first)


def _curvature_density(
    mesh: Mesh, nodes: Float[Array, " node"], period: float
) -> Float[Array, " element"]:
    """Elements wanted for each unit of length by a first-order solution."""
    extent = jnp.max(nodes) - jnp.min(nodes) + 1e-300
    width = jnp.maximum(mesh.width, 1e-14 * period)
    slope = jnp.diff(nodes) / width / extent
    bend = jnp.abs(slope - jnp.roll(slope, 1)) / ((width + jnp.roll(width, 1)) / 2)
    density = jnp.sqrt(jnp.maximum(bend, jnp.roll(bend, -1)))
    return _level(jnp.minimum(density, 1e6 / period), mesh, period)


def _fourth_derivative_density(
    mesh: Mesh,
    node_state: Float[Array, " element"],
    stages: Float[Array, "element 3"],
    period: float,
) -> Float[Array, " element"]:
    """Elements wanted for each unit of length by the cubic's own error term.

    The fourth derivative is the change of third derivative from element to
    element, not counted across breakpoints, where it jumps of right.
    """
    extent = jnp.max(stages) - jnp.min(stages) + 1e-300
    width = jnp.maximum(mesh.width, 1e-14 * period)
    third = 6 * element_powers(node_state, stages)[:, 3] / width**3 / extent
    change = jnp.abs(third - jnp.roll(third, 1)) / ((width + jnp.roll(width, 1)) / 2)
    change = jnp.where(mesh.is_first, 0.0, change)
    density = jnp.maximum(change, jnp.roll(change, -1)) ** 0.25
    spread = jnp.maximum(jnp.roll(density, 1), jnp.roll(density, -1)) / 2
    return _level(jnp.minimum(jnp.maximum(density, spread), 1e7 / period), mesh, period)


def _level(
    density: Float[Array, " element"], mesh: Mesh, period: float
) -> Float[Array, " element"]:
    """Half the elements by density, half evenly, so that none grows wide."""
    return density + jnp.sum(density * mesh.width) / period + 1 / period


# --- first guess ----------------------------------------------------------


def _implicit_solve(
    equation: Equation,
    forcing: Forcing,
    before: Array,
    step: Array,
    guess: Array,
    iterations: int = 8,
) -> Array:
    """`y = before + step * rate(y)` by Newton kept inside a bracket that shrinks."""
    low = jnp.full_like(guess, -jnp.inf)
    high = jnp.full_like(guess, jnp.inf)
    state = guess
    for _ in range(iterations):
        value, slope = equation.rate_and_slope(forcing, state)
        excess = state - before - step * value
        low = jnp.where(excess < 0, state, low)
        high = jnp.where(excess > 0, state, high)
        newton = state - excess / jnp.maximum(1 - step * slope, 1.0)
        middle = (low + high) / 2
        outside = (newton <= low) | (newton >= high)
        state = jnp.where(outside & jnp.isfinite(middle), middle, newton)
    return state


def _backward_euler(
    equation: Equation, mesh: Mesh, begin: Float[Array, ""], sweeps: int
) -> Float[Array, " node"]:
    """Node states of one period after `sweeps` periods from `begin`: first order, robust."""
    at_end = jax.tree.map(lambda leaf: leaf[:, 0], equation.forcing(mesh, jnp.ones(1)))

    def advance(state: Array, element: tuple[Forcing, Array]) -> tuple[Array, Array]:
        end_forcing, step = element
        after = _implicit_solve(equation, end_forcing, state, step, state)
        return after, after

    for _ in range(sweeps):
        first = begin
        begin, after = jax.lax.scan(advance, begin, (at_end, mesh.width))
    return jnp.concatenate([first[None], after])


def _stage_guess(
    equation: Equation, mesh: Mesh, nodes: Float[Array, " node"]
) -> Float[Array, "element 3"]:
    """Each stage by its own backward Euler step from the element's start."""
    at_stages = equation.forcing(mesh, jnp.asarray(STAGES))
    before = nodes[:-1, None] + jnp.zeros(3)
    line = before + jnp.diff(nodes)[:, None] * STAGES
    return _implicit_solve(equation, at_stages, before, mesh.width[:, None] * STAGES, line)


# --- collocation ----------------------------------------------------------


def _solve_stages(matrix: list[list[Array]], *right_sides: list[Array]) -> tuple[list[Array], ...]:
    """Cramer's rule for the 3 x 3 stage systems of all elements at once."""
    (a, b, c), (d, e, f), (g, h, i) = matrix
    cofactors = [
        [e * i - f * h, c * h - b * i, b * f - c * e],
        [f * g - d * i, a * i - c * g, c * d - a * f],
        [d * h - e * g, b * g - a * h, a * e - b * d],
    ]
    scale = 1 / (a * cofactors[0][0] + b * cofactors[1][0] + c * cofactors[2][0])
    return tuple(
        [scale * sum(row[j] * right[j] for j in range(3)) for row in cofactors]
        for right in right_sides
    )


def _periodic_step(
    equation: Equation, mesh: Mesh, stages: Float[Array, "element 3"]
) -> tuple[Float[Array, " element"], Float[Array, "element 3"], Float[Array, ""]]:
    """One Newton step of all collocation equations and periodicity together.

    Returns node states, stage states and the Floquet multiplier.
    """
    at_stages = equation.forcing(mesh, jnp.asarray(STAGES))
    value, slope = equation.rate_and_slope(at_stages, stages)
    slope = stop_gradient(slope)
    defect = mesh.width[:, None] * (value @ STAGE_INTEGRALS.T) - stages
    step = stop_gradient(mesh.width)
    matrix = [
        [float(i == j) - step * STAGE_INTEGRALS[i, j] * slope[:, j] for j in range(3)]
        for i in range(3)
    ]
    ones = [jnp.ones_like(step)] * 3
    growth, offset = _solve_stages(matrix, ones, [defect[:, i] for i in range(3)])

    def compose(so_far: tuple, element: tuple) -> tuple:
        product, total = so_far
        product = element[0] * product
        total = element[0] * total + element[1]
        return (product, total), so_far

    last = (growth[2], stages[:, 2] + offset[2])
    unit = (jnp.ones_like(stages[0, 0]), jnp.zeros_like(stages[0, 0]))
    product: Array
    before: Array
    (multiplier, total), (product, before) = jax.lax.scan(compose, unit, last, unroll=8)
    node_state = product * (total / (1 - multiplier)) + before
    updated = jnp.stack(
        [stages[:, i] + growth[i] * node_state + offset[i] for i in range(3)], axis=1
    )
    return node_state, updated, multiplier


def _newton(
    equation: Equation,
    mesh: Mesh,
    stages: Float[Array, "element 3"],
    resolution: PeriodicResolution,
) -> tuple[Float[Array, "element 3"], Int[Array, ""]]:
    """Newton on the whole period until its step is small."""

    def unfinished(carry: tuple) -> Array:
        _, step, count = carry
        return (step > resolution.tolerance) & (count < resolution.iterations)

    def improve(carry: tuple) -> tuple:
        current, _, count = carry
        _, updated, _ = _periodic_step(equation, mesh, current)
        extent = jnp.max(updated) - jnp.min(updated) + 1e-300
        step = jnp.max(jnp.abs(updated - current)) / extent
        return updated, step, count + 1

    stages, _, count = jax.lax.while_loop(
        unfinished, improve, (stages, jnp.asarray(jnp.inf), jnp.asarray(0))
    )
    return stages, count


def _interpolate(
    mesh: Mesh, powers: Float[Array, "element 4"], position: Float[Array, "*grid"]
) -> Float[Array, "*grid"]:
    """A piecewise cubic at positions within its mesh."""
    element = jnp.clip(jnp.searchsorted(mesh.start, position, side="right") - 1, 0)
    width = mesh.width[element]
    offset = position - mesh.start[element]
    fraction = jnp.where(width > 0, offset / jnp.where(width > 0, width, 1), 1)
    constant, first, second, third = jnp.moveaxis(powers[element], -1, 0)
    return ((third * fraction + second) * fraction + first) * fraction + constant


def _collocation_residual(
    equation: Equation,
    mesh: Mesh,
    node_state: Float[Array, " element"],
    stages: Float[Array, "element 3"],
) -> Float[Array, ""]:
    """Largest violation of stage equations or continuity, over the orbit's range."""
    at_stages = equation.forcing(mesh, jnp.asarray(STAGES))
    rise = mesh.width[:, None] * (equation.rate(at_stages, stages) @ STAGE_INTEGRALS.T)
    stage_error = jnp.max(jnp.abs(node_state[:, None] + rise - stages))
    closure = jnp.max(jnp.abs(jnp.roll(stages[:, 2], 1) - node_state))
    extent = jnp.max(stages) - jnp.min(stages) + 1e-300
    return jnp.maximum(stage_error, closure) / extent

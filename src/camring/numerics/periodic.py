"""The periodic orbit of one stiff scalar equation, found directly.

Given `dy/dx = rate(forcing(x), y)` with a forcing of known period and known
breakpoints, this finds `y` with `y(x + period) = y(x)` by collocation: one
Newton iteration acts on every element of the period at once, and the condition
of periodicity closes the linear system. No revolution is marched to decay.

Method
------
Radau IIA with three stages (`radau.py`). In each element the linearised stage
equations are a 3 x 3 system; eliminating the stages leaves
`y[k+1] = growth[k] y[k] + offset[k]`, a cyclic recurrence whose product of
growths is the Floquet multiplier of the orbit: the periodic solve costs one pass.

The mesh (`mesh.py`) has a fixed number of elements and keeps every breakpoint
as a node. Newton begins on a small graded mesh, from states guessed place by
place from the forcing alone (a chamber that stands still under its ports), and
needs five to ten steps there, twenty where air expands to a hundredth of an
atmosphere. From that solution, and again from the next ones, the mesh is laid
by equidistribution of the fourth derivative.

Derivatives pass through one last Newton step taken from a constant, which is
the implicit function theorem on the discrete orbit; the mesh moves with its
breakpoints, element fractions held.

Arrays run over points of an element first and over elements last, so that the
long axis is the one that a vector unit runs along.
"""

from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jax.lax import stop_gradient
from jaxtyping import Array, Float, Int

from camring.numerics.compilation import computed_once
from camring.numerics.crossing import crossings, with_nodes_at
from camring.numerics.equation import Equation, Forcing
from camring.numerics.mesh import (
    Breakpoints,
    ElementCount,
    Mesh,
    equidistribute,
    follow_breakpoints,
    fourth_derivative_density,
    graded_mesh,
)
from camring.numerics.newton import damped_newton
from camring.numerics.radau import (
    STAGE_INTEGRALS,
    STAGES,
    combine,
    element_powers,
    horner,
    solve_stages,
)
from camring.numerics.selection import larger, largest, smallest

FORGOTTEN = 1e-100
"""A share of a disturbance that counts as none."""


class PeriodicResolution(NamedTuple):
    """How finely an orbit is looked at; all static but for the elements that are used."""

    elements: ElementCount
    """Elements in one period, more than the breakpoints take for themselves."""
    refinements: int = 1
    """Times the mesh is laid anew from a collocation solution."""
    iterations: int = 40
    """Newton iterations at most, on each collocation mesh."""
    tolerance: float = 1e-9
    """Newton stops when its step is this small against the range of the orbit; it is
    quadratic, and one more step follows."""
    rough_tolerance: float = 1e-3
    """The same on meshes that only serve to lay the next one."""


class Orbit(eqx.Module):
    """One period of the solution: cubic in each element.

    At fraction `x` of element `k` the state is `sum_p coefficients[p, k] x^p`.
    """

    mesh: Mesh
    node_state: Float[Array, " element"]
    stage_state: Float[Array, "3 element"]
    residual: Float[Array, ""]
    """Largest error of the collocation equations, periodicity included, over the range."""
    iterations: Int[Array, ""]

    @property
    def coefficients(self) -> Float[Array, "4 element"]:
        return element_powers(self.node_state, self.stage_state)

    def at(self, fraction: Float[Array, " point"]) -> Float[Array, "point element"]:
        """State at the same fractions of every element."""
        return horner(self.coefficients[:, None, :], fraction[:, None])

    def slope(self, fraction: Float[Array, " point"]) -> Float[Array, "point element"]:
        """Derivative of the state by position, at fractions of every element."""
        derivative = self.coefficients[1:] * np.arange(1, 4)[:, None]
        rise = horner(derivative[:, None, :], fraction[:, None])
        width = self.mesh.width
        return jnp.where(width > 0, rise / jnp.where(width > 0, width, 1), 0)

    def at_offset(
        self, element: Int[Array, "*grid"], offset: Float[Array, "*grid"]
    ) -> Float[Array, "*grid"]:
        """State at offsets from the starts of numbered elements."""
        width = self.mesh.width[element]
        fraction = jnp.where(width > 0, offset / jnp.where(width > 0, width, 1), 1)
        return horner(jnp.moveaxis(self.coefficients.T[element], -1, 0), fraction)

    def at_position(self, position: Float[Array, "*grid"]) -> Float[Array, "*grid"]:
        """State at positions within the period that the mesh covers."""
        return _interpolate(self.mesh, self.coefficients, position)


def solve_periodic(
    equation: Equation,
    breakpoints: Breakpoints,
    period: float,
    resolution: PeriodicResolution,
) -> Orbit:
    """The periodic solution of an equation.

    Parameters
    ----------
    equation
        Its rate should decrease with the state, or the orbit may not be unique.

    Notes
    -----
    Nothing is raised: a residual that stays large, or an orbit that nothing pulls
    disturbances back to, are for the caller's verdict. Traceable, batchable with
    `vmap`, differentiable in both modes.
    """
    fixed = jax.tree.map(stop_gradient, breakpoints)
    frozen = equation.frozen()

    mesh = graded_mesh(fixed.position, period)
    tolerances = [resolution.rough_tolerance] * resolution.refinements + [resolution.tolerance]
    limit = resolution.iterations
    at_stages = computed_once(frozen.forcing(mesh, jnp.asarray(STAGES)))
    stages, iterations = _newton(
        frozen, at_stages, mesh, frozen.guess(at_stages), tolerances[0], limit
    )

    def refine(
        current: tuple[Any, ...], tolerance: float | Float[Array, ""]
    ) -> tuple[tuple[Any, ...], None]:
        """Lays a mesh by what was found on the one before, and solves on it."""
        mesh, at_stages, stages, _ = current
        node_state, stages = newton_step(frozen, at_stages, mesh, stages)
        powers = element_powers(node_state, stages)
        density = fourth_derivative_density(mesh, powers[3], extent(stages), period)
        layer = _layer_width(frozen, mesh, node_state, period, fixed)
        finer = equidistribute(mesh, density, fixed, layer, period, resolution.elements)
        for level in frozen.kinks:
            finer = with_nodes_at(finer, crossings(mesh, powers, level))
        stages = _interpolate(mesh, powers, finer.at(jnp.asarray(STAGES)))
        at_stages = computed_once(frozen.forcing(finer, jnp.asarray(STAGES)))
        stages, iterations = _newton(frozen, at_stages, finer, stages, tolerance, limit)
        return (finer, at_stages, stages, iterations), None

    found = (mesh, at_stages, stages, iterations)
    if resolution.refinements:
        found, _ = refine(found, tolerances[1])
        # The other meshes have as many elements as this one: they share its program.
        found, _ = jax.lax.scan(refine, found, jnp.asarray(tolerances[2:]))
    mesh, _, stages, iterations = found
    return settle(equation, breakpoints, period, mesh, stages, iterations)


def settle(
    equation: Equation,
    breakpoints: Breakpoints,
    period: float,
    mesh: Mesh,
    stages: Float[Array, "3 element"],
    iterations: Int[Array, ""],
) -> Orbit:
    """A solution at hand as a function of the equation: one Newton step from a constant.

    Its derivatives are those of the discrete orbit (implicit function theorem); the
    mesh is carried along by the breakpoints.
    """
    mesh = follow_breakpoints(mesh, breakpoints.position, period)
    at_stages = equation.forcing(mesh, jnp.asarray(STAGES))
    node_state, stages = newton_step(equation, at_stages, mesh, stop_gradient(stages))
    rate = list(equation.rate(at_stages, stages))
    residual = collocation_residual(rate, mesh, node_state, stages)
    return Orbit(mesh, node_state, stages, residual, iterations)


def extent(states: Float[Array, "point element *batch"]) -> Float[Array, "*batch"]:
    """Range of the states, which errors are measured against; never nil."""
    return largest(states, axis=(0, 1)) - smallest(states, axis=(0, 1)) + 1e-300


def share_of_range(
    step: Float[Array, "point element *batch"], states: Float[Array, "point element *batch"]
) -> Float[Array, "*batch"]:
    """The largest part of a step, over the range of the states."""
    return largest(jnp.abs(step), axis=(0, 1)) / extent(states)


def _layer_width(
    equation: Equation,
    mesh: Mesh,
    node_state: Float[Array, " element"],
    period: float,
    breakpoints: Breakpoints,
) -> Float[Array, " breakpoint"]:
    """Relaxation length `1/|slope of the rate|` just behind each breakpoint."""
    first = jnp.nonzero(mesh.is_first, size=breakpoints.position.shape[0])[0]
    behind = Mesh(*(leaf[first] for leaf in mesh))
    at_start = jax.tree.map(lambda leaf: leaf[0], equation.forcing(behind, jnp.zeros(1)))
    _, slope = equation.rate_and_slope(at_start, node_state[first])
    return 1 / larger(jnp.abs(slope), 1 / period)


def newton_step(
    equation: Equation, at_stages: Forcing, mesh: Mesh, stages: Float[Array, "3 element"]
) -> tuple[Float[Array, " element"], Float[Array, "3 element"]]:
    """One Newton step of all collocation equations and periodicity together.

    Returns node states and stage states.
    """
    value, slope = computed_once(equation.rate_and_slope(at_stages, stages))
    node_state, updated = eliminate(list(value), list(slope), mesh, list(stages))
    return node_state, jnp.stack(updated)


def eliminate(
    value: list[Float[Array, " element"]],
    slope: list[Float[Array, " element"]],
    mesh: Mesh,
    stages: list[Float[Array, " element"]],
) -> tuple[Float[Array, " element"], list[Float[Array, " element"]]]:
    """A Newton step from rates and their slopes at each of the three stages."""
    slope = [stop_gradient(each) for each in slope]
    defect = [mesh.width * combine(row, value) - stages[i] for i, row in enumerate(STAGE_INTEGRALS)]
    step = stop_gradient(mesh.width)
    matrix = [
        [float(i == j) - step * float(STAGE_INTEGRALS[i, j]) * slope[j] for j in range(3)]
        for i in range(3)
    ]
    growth, offset = solve_stages(matrix, [jnp.ones_like(step)] * 3, defect)

    def compose(so_far: tuple[Any, ...], element: tuple[Any, ...]) -> tuple[Any, ...]:
        product, total = so_far
        product = element[0] * product
        # Far below rounding against the offsets; as a denormal number it would cost a hundred
        # cycles each time it is touched.
        product = jnp.where(jnp.abs(product) < FORGOTTEN, 0.0, product)
        total = element[0] * total + element[1]
        return (product, total), so_far

    last = (growth[2], stages[2] + offset[2])
    unit = (jnp.ones_like(stages[0][0]), jnp.zeros_like(stages[0][0]))
    product: Array
    before: Array
    (multiplier, total), (product, before) = jax.lax.scan(compose, unit, last, unroll=8)
    node_state = product * (total / (1 - multiplier)) + before
    return node_state, [stages[i] + growth[i] * node_state + offset[i] for i in range(3)]


def _newton(
    equation: Equation,
    at_stages: Forcing,
    mesh: Mesh,
    stages: Float[Array, "3 element"],
    tolerance: float | Float[Array, ""],
    limit: int,
) -> tuple[Float[Array, "3 element"], Int[Array, ""]]:
    def improved(current: Float[Array, "3 element"]) -> Float[Array, "3 element"]:
        return newton_step(equation, at_stages, mesh, current)[1]

    return damped_newton(improved, share_of_range, stages, tolerance, limit)


def _interpolate(
    mesh: Mesh, powers: Float[Array, "4 element"], position: Float[Array, "*grid"]
) -> Float[Array, "*grid"]:
    """A piecewise cubic at positions within its mesh."""
    element, fraction = mesh.locate(position)
    return horner(jnp.moveaxis(powers.T[element], -1, 0), fraction)


def collocation_residual(
    rate: list[Float[Array, " element"]],
    mesh: Mesh,
    node_state: Float[Array, " element"],
    stages: Float[Array, "3 element"],
) -> Float[Array, ""]:
    """Largest violation of stage equations or continuity, over the orbit's range."""
    errors = [
        jnp.abs(node_state + mesh.width * combine(row, rate) - stages[i])
        for i, row in enumerate(STAGE_INTEGRALS)
    ]
    closure = jnp.abs(jnp.roll(stages[2], 1, axis=0) - node_state)
    return largest(jnp.stack([*errors, closure]), axis=(0, 1)) / extent(stages)

"""A first guess of a periodic orbit: backward Euler, one bracketed root at a time.

First order and slow to settle, but it never leaps: each step's root is kept in
a bracket that shrinks, so the Newton iteration on the whole period starts near.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from camring.numerics.equation import Equation, Forcing
from camring.numerics.mesh import Mesh


def implicit_solve(
    equation: Equation,
    forcing: Forcing,
    before: Array,
    step: Array,
    guess: Array,
    iterations: int,
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


def backward_euler(
    equation: Equation, mesh: Mesh, begin: Float[Array, ""], sweeps: int
) -> Float[Array, " node"]:
    """Node states of one period after `sweeps` periods from `begin`: first order, robust."""
    at_end = jax.tree.map(lambda leaf: leaf[0], equation.forcing(mesh, jnp.ones(1)))

    def advance(state: Array, element: tuple[Forcing, Array]) -> tuple[Array, Array]:
        end_forcing, step = element
        after = implicit_solve(equation, end_forcing, state, step, state, iterations=5)
        return after, after

    for _ in range(sweeps):
        first = begin
        begin, after = jax.lax.scan(advance, begin, (at_end, mesh.width))
    return jnp.concatenate([first[None], after])


def stage_guess(
    equation: Equation,
    at_stages: Forcing,
    mesh: Mesh,
    nodes: Float[Array, " node"],
    stages: np.ndarray,
) -> Float[Array, "stage element"]:
    """Each stage by its own backward Euler step from the element's start."""
    before = jnp.broadcast_to(nodes[:-1], (len(stages), nodes.shape[0] - 1))
    line = before + stages[:, None] * jnp.diff(nodes)
    step = jnp.asarray(stages)[:, None] * mesh.width
    return implicit_solve(equation, at_stages, before, step, line, iterations=3)

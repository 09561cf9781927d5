"""A scalar differential equation whose forcing is known before its solution."""

from collections.abc import Callable
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
from jax.lax import stop_gradient
from jaxtyping import Array, Float

from camring.numerics.mesh import Mesh

Forcing = Any


class Equation(eqx.Module):
    """`dy/dx = rate(parameters, forcing(x), y)`, with its parameters in the open.

    `rate_law` is elementwise in forcing and state. `forcing_law(parameters,
    start, width, fraction)` gives the forcing at the same fractions of every
    element, leaves of shape (point, element); it is asked once for each mesh.
    `guess_law(parameters, forcing)` is elementwise, too.
    """

    parameters: Any
    rate_law: Callable[..., Float[Array, "*grid"]] = eqx.field(static=True)
    forcing_law: Callable[..., Forcing] = eqx.field(static=True)
    guess_law: Callable[..., Float[Array, "*grid"]] = eqx.field(static=True)
    kinks: tuple[Float[Array, ""], ...] = ()
    """States at which the rate's slope may jump."""

    def rate(self, forcing: Forcing, state: Float[Array, "*grid"]) -> Float[Array, "*grid"]:
        return self.rate_law(self.parameters, forcing, state)

    def rate_and_slope(
        self, forcing: Forcing, state: Float[Array, "*grid"]
    ) -> tuple[Float[Array, "*grid"], Float[Array, "*grid"]]:
        """The rate and its derivative with respect to the state."""
        return jax.jvp(lambda y: self.rate(forcing, y), (state,), (jnp.ones_like(state),))

    def forcing(self, mesh: Mesh, fraction: Float[Array, " point"]) -> Forcing:
        """The forcing at fractions of every element, leaves (point, element)."""
        return self.forcing_law(self.parameters, mesh.start, mesh.width, fraction)

    def guess(self, forcing: Forcing) -> Float[Array, "*grid"]:
        """A state to begin with, from the forcing at the same place alone."""
        return self.guess_law(self.parameters, forcing)

    def frozen(self) -> "Equation":
        """The same equation, through which no derivative passes to its parameters."""
        constant = jax.tree.map(stop_gradient, self.parameters)
        kinks = jax.tree.map(stop_gradient, self.kinks)
        return Equation(constant, self.rate_law, self.forcing_law, self.guess_law, kinks)

"""Flow through the opening between a port and a chamber."""

from abc import abstractmethod

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.numerics.quantity import Q, real
from camring.physics.fluid import AbstractFluid


class AbstractOrifice(eqx.Module):
    """A law for the volume flow that a pressure drop drives through an area."""

    @abstractmethod
    def __call__(
        self,
        area: Q[Float[Array, "*grid"], "m2"],
        drop: Q[Float[Array, "*grid"], "Pa"],
        density: Q[Float[Array, "*grid"], "kg/m3"],
        fluid: AbstractFluid,
    ) -> Q[Float[Array, "*grid"], "m3/s"]:
        """Volume flow, with the sign of the drop; zero for a closed opening."""

    @abstractmethod
    def gain(
        self, area: Q[Float[Array, ""], "m2"], fluid: AbstractFluid
    ) -> Q[Float[Array, ""], "m3/(s.Pa^0.5)"]:
        """Flow for the square root of a large pressure drop, at the fluid's liquid density."""


class TurbulentOrifice(AbstractOrifice):
    """The square-root law, carrying the sign of the drop and smooth through zero.

    `Q = Cd A sqrt(2/density) x / (x^2 + p_tr^2)^(1/4)`. Far above the
    transition pressure it is Torricelli's law, far below it flow is
    proportional to the drop. model.md section 3; Merritt (1967) for `Cd`.
    """

    discharge_coefficient: Q[Float[Array, ""], "1"] = eqx.field(converter=real)

    def __call__(
        self,
        area: Q[Float[Array, "*grid"], "m2"],
        drop: Q[Float[Array, "*grid"], "Pa"],
        density: Q[Float[Array, "*grid"], "kg/m3"],
        fluid: AbstractFluid,
    ) -> Q[Float[Array, "*grid"], "m3/s"]:
        softened = jnp.sqrt(jnp.sqrt(drop**2 + fluid.transition_pressure**2))
        return self.discharge_coefficient * area * jnp.sqrt(2 / density) * drop / softened

    def gain(
        self, area: Q[Float[Array, ""], "m2"], fluid: AbstractFluid
    ) -> Q[Float[Array, ""], "m3/(s.Pa^0.5)"]:
        return self.discharge_coefficient * area * jnp.sqrt(2 / fluid.density)

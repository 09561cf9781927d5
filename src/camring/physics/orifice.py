"""Flow through the opening between a port and a chamber."""

from abc import abstractmethod
from math import pi

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.numerics.quantity import Q, real
from camring.numerics.smooth import signed_root, tanh_ratio
from camring.physics.fluid import AbstractFluid


class AbstractOrifice(eqx.Module):
    """A law for the volume flow that a pressure drop drives through an area."""

    @property
    @abstractmethod
    def bends_at_zero(self) -> bool:
        """Whether flow against pressure drop has a jump of curvature where the drop is zero."""

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

    @property
    def bends_at_zero(self) -> bool:
        return False

    def __call__(
        self,
        area: Q[Float[Array, "*grid"], "m2"],
        drop: Q[Float[Array, "*grid"], "Pa"],
        density: Q[Float[Array, "*grid"], "kg/m3"],
        fluid: AbstractFluid,
    ) -> Q[Float[Array, "*grid"], "m3/s"]:
        root = signed_root(drop, fluid.transition_pressure)
        return self.discharge_coefficient * area * jnp.sqrt(2 / density) * root

    def gain(
        self, area: Q[Float[Array, ""], "m2"], fluid: AbstractFluid
    ) -> Q[Float[Array, ""], "m3/(s.Pa^0.5)"]:
        return self.discharge_coefficient * area * jnp.sqrt(2 / fluid.density)


class LaminarTurbulentOrifice(AbstractOrifice):
    """The square-root law that a small flow number makes laminar.

    `Q = Cd tanh(2 lam/lam_c) A sqrt(2 |x|/density) sign(x)` with the flow number
    `lam = sqrt(4 A/pi)/viscosity * sqrt(2 |x|/density)`: Torricelli's law where
    viscosity does not count, and flow proportional to the drop where it does.
    model.md section 13; the law of Simscape's and Amesim's variable orifices
    (McCloy and Martin 1980, section 2.3, for the critical flow number).
    """

    discharge_coefficient: Q[Float[Array, ""], "1"] = eqx.field(converter=real)
    critical_flow_number: Q[Float[Array, ""], "1"] = eqx.field(converter=real, default=1000.0)

    @property
    def bends_at_zero(self) -> bool:
        return True

    def __call__(
        self,
        area: Q[Float[Array, "*grid"], "m2"],
        drop: Q[Float[Array, "*grid"], "Pa"],
        density: Q[Float[Array, "*grid"], "kg/m3"],
        fluid: AbstractFluid,
    ) -> Q[Float[Array, "*grid"], "m3/s"]:
        # notation: z = 2 lam/lam_c = k sqrt(2 |x|/density), so that
        # tanh(z) sqrt(2 |x|/density) sign(x) = k (tanh(z)/z) 2 x/density
        open_area = jnp.where(area > 0, area, 1.0)
        diameter = jnp.sqrt(4 * open_area / pi)
        k = jnp.where(area > 0, 2 * diameter / (fluid.viscosity * self.critical_flow_number), 0.0)
        flow = 2 * drop / density
        speed = k * flow * tanh_ratio(k**2 * jnp.abs(flow))
        return self.discharge_coefficient * area * speed

    def gain(
        self, area: Q[Float[Array, ""], "m2"], fluid: AbstractFluid
    ) -> Q[Float[Array, ""], "m3/(s.Pa^0.5)"]:
        return self.discharge_coefficient * area * jnp.sqrt(2 / fluid.density)

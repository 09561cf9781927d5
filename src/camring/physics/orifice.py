"""Flow through the opening between a port and a chamber."""

from abc import abstractmethod
from math import pi, sqrt

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.numerics.quantity import Q, real
from camring.numerics.smooth import inverse, inverse_root, signed_root, tanh_ratio
from camring.physics.oil.fluid import AbstractFluid


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


class AbstractSquareRootOrifice(AbstractOrifice):
    """Torricelli's law where the pressure drop is large, `Cd A sqrt(2 drop/density)`."""

    discharge_coefficient: Q[Float[Array, ""], "1"] = eqx.field(converter=real)

    def gain(
        self, area: Q[Float[Array, ""], "m2"], fluid: AbstractFluid
    ) -> Q[Float[Array, ""], "m3/(s.Pa^0.5)"]:
        return self.discharge_coefficient * area * jnp.sqrt(2 / fluid.density)


class TurbulentOrifice(AbstractSquareRootOrifice):
    """The square-root law, carrying the sign of the drop and smooth through zero.

    `Q = Cd A sqrt(2/density) x / (x^2 + p_tr^2)^(1/4)`. Far above the
    transition pressure it is Torricelli's law, far below it flow is
    proportional to the drop. docs/theory.md section 3; Merritt (1967) for `Cd`.

    Examples
    --------
    >>> oil = camring.ConstantFluid(density=870.0, bulk_modulus=1.4e9, vapour_pressure=3e3)
    >>> orifice = camring.TurbulentOrifice(0.65)
    >>> [round(6e4 * float(orifice(60e-6, drop, 870.0, oil)), 1) for drop in (1e6, -1e6)]  # L/min
    [111.9, -111.9]
    """

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
        return self.discharge_coefficient * area * sqrt(2) * inverse_root(density) * root


class LaminarTurbulentOrifice(AbstractSquareRootOrifice):
    """The square-root law that a small flow number makes laminar.

    `Q = Cd tanh(2 lam/lam_c) A sqrt(2 |x|/density) sign(x)` with the flow number
    `lam = sqrt(4 A/pi)/viscosity * sqrt(2 |x|/density)`: Torricelli's law where
    viscosity does not count, and flow proportional to the drop where it does.
    docs/theory.md section 13; the law of Simscape's and Amesim's variable orifices
    (McCloy and Martin 1980, section 2.3, for the critical flow number).

    Examples
    --------
    >>> oil = camring.ConstantFluid(870.0, 1.4e9, 3e3, viscosity=46e-6)
    >>> orifice = camring.LaminarTurbulentOrifice(0.65)
    >>> [round(6e4 * float(orifice(60e-6, drop, 870.0, oil)), 2) for drop in (1e2, 1e4, 1e6)]
    [0.2, 10.65, 112.19]
    """

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
        flow = 2 * drop * inverse(density)
        speed = k * flow * tanh_ratio(k**2 * jnp.abs(flow))
        return self.discharge_coefficient * area * speed

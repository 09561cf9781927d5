"""The oil: how much of it a chamber holds at a pressure, and what that pressure costs.

The chamber balances an *amount* of oil. For the derivation's law the amount is
a volume, for a mass-conserving law it is a mass; both are amount per volume
`content(P)` times volume, and power is amount flow times `potential(P)`. One
pressure equation then serves every fluid:

    content'(P) V dP/dt = sum of amount flows - content(P) dV/dt
"""

from abc import abstractmethod
from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.numerics.quantity import Q, real
from camring.numerics.readable import readable
from camring.physics.oil.viscosity_line import ViscosityLine

Pressure = Q[Float[Array, "*grid"], "Pa"]


class OilAt(NamedTuple):
    """What a unit of volume holds at a pressure; scalars where pressure makes no difference.

    Between two pressures flows the mean of what they hold (docs/theory.md section 13).
    """

    density: Q[Float[Array, "*#grid"], "kg/m3"]
    content: Float[Array, "*#grid"]
    content_slope: Float[Array, "*#grid"]


class AbstractFluid(eqx.Module):
    """An oil whose state is its pressure alone."""

    density: eqx.AbstractVar[Q[Float[Array, ""], "kg/m3"]]
    """Density of the liquid at atmospheric pressure."""
    bulk_modulus: eqx.AbstractVar[Q[Float[Array, ""], "Pa"]]
    """Of the liquid at atmospheric pressure."""
    vapour_pressure: eqx.AbstractVar[Q[Float[Array, ""], "Pa"]]
    transition_pressure: eqx.AbstractVar[Q[Float[Array, ""], "Pa"]]
    viscosity: eqx.AbstractVar[Q[Float[Array, ""], "m2/s"]]
    """Kinematic viscosity; zero where no law asks for it."""
    atmospheric_pressure: eqx.AbstractVar[Q[Float[Array, ""], "Pa"]]
    """Pressure at which the oil met the air: below it, it gives all of that air back."""
    line: ViscosityLine | None = eqx.field(default=None, kw_only=True)
    """How the viscosity goes on with temperature; None where nothing asks for it."""

    __repr__ = readable

    @abstractmethod
    def density_at(self, pressure: Pressure) -> Q[Float[Array, "*grid"], "kg/m3"]:
        """Density at a pressure."""

    @abstractmethod
    def bulk_modulus_at(self, pressure: Pressure) -> Pressure:
        """Tangent bulk modulus `rho dP/drho` at a pressure."""

    @abstractmethod
    def content(self, pressure: Pressure) -> Float[Array, "*grid"]:
        """Amount of oil in a unit of volume; an amount is what is conserved."""

    @abstractmethod
    def at(self, pressure: Pressure) -> OilAt:
        """Density, content and the content's derivative by pressure, in one go."""

    @abstractmethod
    def potential(self, pressure: Pressure) -> Float[Array, "*grid"]:
        """Energy a unit amount brings with it at a pressure, up to a constant."""

    @abstractmethod
    def compression_power(
        self,
        pressure: Pressure,
        return_pressure: Pressure,
        volume: Q[Float[Array, "*grid"], "m3"],
        pressure_rate: Q[Float[Array, "*grid"], "Pa/s"],
    ) -> Q[Float[Array, "*grid"], "W"]:
        """Power the balance of this law leaves in compressing the chamber's oil."""

    @abstractmethod
    def kinks(self) -> tuple[Q[Float[Array, ""], "Pa"], ...]:
        """Pressures at which the law bends: `content_slope` is not smooth there."""

    @abstractmethod
    def state(self, pressure: Pressure) -> Float[Array, "*grid"]:
        """The variable in which the pressure equation is solved."""

    @abstractmethod
    def state_slope(self, pressure: Pressure) -> Float[Array, "*grid"]:
        """Derivative of the state with respect to pressure."""

    @abstractmethod
    def pressure(self, state: Float[Array, "*grid"]) -> Pressure:
        """Pressure of a state: the inverse of `state`."""


class AbstractOil(AbstractFluid):
    """A fluid with the six numbers that a data sheet has of any oil."""

    density: Q[Float[Array, ""], "kg/m3"] = eqx.field(converter=real)
    bulk_modulus: Q[Float[Array, ""], "Pa"] = eqx.field(converter=real)
    vapour_pressure: Q[Float[Array, ""], "Pa"] = eqx.field(converter=real)
    transition_pressure: Q[Float[Array, ""], "Pa"] = eqx.field(converter=real, default=1e5)
    viscosity: Q[Float[Array, ""], "m2/s"] = eqx.field(converter=real, default=0.0)
    atmospheric_pressure: Q[Float[Array, ""], "Pa"] = eqx.field(converter=real, default=101325.0)


class ConstantFluid(AbstractOil):
    """Constant density and bulk modulus, volume flow conserved: the derivation's oil.

    The plainest: it lets pressure fall below zero, where a real oil releases
    air and vaporises, and does not tell volume flow at port pressure from that at
    chamber pressure, which leaves a compression term in the power balance
    (docs/theory.md sections 3 and 6).

    Examples
    --------
    >>> oil = camring.ConstantFluid(density=870.0, bulk_modulus=1.4e9, vapour_pressure=3e3)
    >>> float(oil.bulk_modulus_at(2e7))  # Pa, at any pressure
    1400000000.0
    """

    def density_at(self, pressure: Pressure) -> Q[Float[Array, "*grid"], "kg/m3"]:
        return jnp.broadcast_to(self.density, jnp.shape(pressure))

    def bulk_modulus_at(self, pressure: Pressure) -> Pressure:
        return jnp.broadcast_to(self.bulk_modulus, jnp.shape(pressure))

    def content(self, pressure: Pressure) -> Float[Array, "*grid"]:
        return jnp.ones_like(pressure)

    def at(self, pressure: Pressure) -> OilAt:
        return OilAt(self.density, jnp.ones(()), 1 / self.bulk_modulus)

    def potential(self, pressure: Pressure) -> Float[Array, "*grid"]:
        return pressure

    def compression_power(
        self,
        pressure: Pressure,
        return_pressure: Pressure,
        volume: Q[Float[Array, "*grid"], "m3"],
        pressure_rate: Q[Float[Array, "*grid"], "Pa/s"],
    ) -> Q[Float[Array, "*grid"], "W"]:
        return (pressure - return_pressure) * volume / self.bulk_modulus * pressure_rate

    def kinks(self) -> tuple[Q[Float[Array, ""], "Pa"], ...]:
        return ()

    def state(self, pressure: Pressure) -> Float[Array, "*grid"]:
        return pressure

    def state_slope(self, pressure: Pressure) -> Float[Array, "*grid"]:
        return jnp.ones_like(pressure)

    def pressure(self, state: Float[Array, "*grid"]) -> Pressure:
        return state

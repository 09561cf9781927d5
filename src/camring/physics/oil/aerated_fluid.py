"""Oil with air in it, its mass conserved.

`rho(P) = (density + a rg) / (a th(P) (p0/P)^(1/n) + l(P))`, docs/theory.md section 13:
liquid and air together in a unit volume of liquid. The air is free below
atmospheric pressure `p0`, goes into solution up to the dissolution pressure
`pc`, and shrinks as a polytropic gas where it is free. The shape is that of
the usual homogeneous-mixture models (Merritt 1967, section 2-3; Yu, Chen and
Lu 1994; Gholizadeh, Burton and Schoenau 2011).
"""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.numerics.quantity import Q, real
from camring.numerics.selection import bounded, smaller
from camring.numerics.smooth import exponential_mean, logarithmic_mean
from camring.physics.oil.fluid import AbstractOil, OilAt, Pressure


class AeratedFluid(AbstractOil):
    """Compressible oil with free and dissolved air; density a function of pressure alone.

    With air in it, pressure stays above zero whatever a chamber does: the air
    expands instead. Without air (`air_fraction = 0`) it is a liquid that can
    be pulled, as the constant law's is. Vapour is no part of the law; how long
    the pressure is below the vapour pressure is reported.

    Notes
    -----
    The pressure equation is solved in the state `P/beta - a p0/P`, which
    is the logarithm of the density but for dissolution and curvature. So
    a trapped volume, where density goes as 1/volume, is smooth in it even when
    its last bubble collapses, where the logarithm of pressure turns a corner.
    docs/theory.md section 13.

    Examples
    --------
    Half a percent of air makes the oil soft where pressure is low:

    >>> oil = camring.AeratedFluid(density=870.0, bulk_modulus=1.4e9, vapour_pressure=3e3)
    >>> [round(float(oil.bulk_modulus_at(p)) / 1e9, 3) for p in (1e5, 1e6, 1e7)]  # GPa
    [0.019, 0.751, 1.4]
    """

    air_fraction: Q[Float[Array, ""], "1"] = eqx.field(converter=real, default=0.005)
    """Free air by volume at atmospheric pressure, in [0, 1)."""
    air_density: Q[Float[Array, ""], "kg/m3"] = eqx.field(converter=real, default=1.2)
    polytropic_index: Q[Float[Array, ""], "1"] = eqx.field(converter=real, default=1.0)
    dissolution_pressure: Q[Float[Array, ""], "Pa"] = eqx.field(converter=real, default=3e6)
    """Above it all air is in solution."""
    modulus_gain: Q[Float[Array, ""], "1"] = eqx.field(converter=real, default=0.0)
    """Rise of the liquid's bulk modulus for each unit of pressure."""

    @property
    def air_ratio(self) -> Q[Float[Array, ""], "1"]:
        """Air to liquid by volume at atmospheric pressure, `a = e/(1 - e)`."""
        return self.air_fraction / (1 - self.air_fraction)

    @property
    def mass(self) -> Q[Float[Array, ""], "kg/m3"]:
        """Oil and air that hold a unit volume of liquid at atmospheric pressure."""
        return self.density + self.air_ratio * self.air_density

    def undissolved(
        self, pressure: Pressure
    ) -> tuple[Q[Float[Array, "*grid"], "1"], Q[Float[Array, "*grid"], "1/Pa"]]:
        """Share of the air that is free, and its derivative by pressure."""
        span = self.dissolution_pressure - self.atmospheric_pressure
        x = bounded((pressure - self.atmospheric_pressure) / span, 0, 1)
        return 1 - x**2 * (3 - 2 * x), -6 * x * (1 - x) / span

    def _gas(self, pressure: Pressure) -> Q[Float[Array, "*grid"], "1"]:
        """Volume of all air, were it free, over the liquid's at atmospheric pressure."""
        # Without air the pressure may fall below zero, where no power is defined.
        has_air = self.air_fraction > 0
        held = jnp.where(has_air, pressure, self.atmospheric_pressure)
        logarithm = jnp.log(held / self.atmospheric_pressure)
        return self.air_ratio * jnp.exp(-logarithm / self.polytropic_index)

    def _volume(
        self, pressure: Pressure
    ) -> tuple[Q[Float[Array, "*grid"], "1"], Q[Float[Array, "*grid"], "1/Pa"]]:
        """Volume over that of the liquid at atmospheric pressure, and minus its derivative."""
        strain = (pressure - self.atmospheric_pressure) / self.bulk_modulus
        stiffening = self.modulus_gain * strain
        liquid = jnp.exp(-strain * logarithmic_mean(stiffening))
        share, share_slope = self.undissolved(pressure)
        gas = self._gas(pressure)
        held = jnp.where(self.air_fraction > 0, pressure, self.atmospheric_pressure)
        shrinking = share / (self.polytropic_index * held) - share_slope
        return (
            gas * share + liquid,
            gas * shrinking + liquid / (self.bulk_modulus * (1 + stiffening)),
        )

    def density_at(self, pressure: Pressure) -> Q[Float[Array, "*grid"], "kg/m3"]:
        return self.mass / self._volume(pressure)[0]

    def bulk_modulus_at(self, pressure: Pressure) -> Pressure:
        volume, shrinking = self._volume(pressure)
        return volume / shrinking

    def content(self, pressure: Pressure) -> Float[Array, "*grid"]:
        return self.density_at(pressure)

    def at(self, pressure: Pressure) -> OilAt:
        volume, shrinking = self._volume(pressure)
        density = self.mass / volume
        return OilAt(density, density, density * shrinking / volume)

    def potential(self, pressure: Pressure) -> Float[Array, "*grid"]:
        """`h(P)`, the integral of dP/rho from atmospheric pressure, J/kg.

        A closed form, smooth through every value of gain and polytropic index.
        """
        # notation: p0 atmospheric pressure; u = ln(P/p0)
        p0, gain = self.atmospheric_pressure, self.modulus_gain
        strain = (pressure - p0) / self.bulk_modulus
        log_strain = strain * logarithmic_mean(gain * strain)
        liquid = self.bulk_modulus * log_strain * exponential_mean((gain - 1) * log_strain)

        power = 1 - 1 / self.polytropic_index
        held = jnp.where(self.air_fraction > 0, pressure, p0)
        u = jnp.log(smaller(held, p0) / p0)
        below = p0 * u * exponential_mean(power * u)

        # Between p0 and pc the free share is a cubic in q = P/p0.
        top = jnp.log(bounded(held, p0, self.dissolution_pressure) / p0)
        span = self.dissolution_pressure / p0 - 1
        square, cube = 3 / span**2, 2 / span**3
        coefficients = (2 * square + 3 * cube, -square - 3 * cube, cube)
        dissolving = (1 - square - cube) * top * exponential_mean(power * top)
        for order, coefficient in enumerate(coefficients, start=1):
            exponent = power + order
            dissolving = dissolving + coefficient * jnp.expm1(exponent * top) / exponent
        dissolving = p0 * dissolving
        return (liquid + self.air_ratio * (below + dissolving)) / self.mass

    def compression_power(
        self,
        pressure: Pressure,
        return_pressure: Pressure,
        volume: Q[Float[Array, "*grid"], "m3"],
        pressure_rate: Q[Float[Array, "*grid"], "Pa/s"],
    ) -> Q[Float[Array, "*grid"], "W"]:
        return jnp.zeros_like(pressure)

    def kinks(self) -> tuple[Q[Float[Array, ""], "Pa"], ...]:
        return self.atmospheric_pressure, self.dissolution_pressure

    def state(self, pressure: Pressure) -> Float[Array, "*grid"]:
        has_air = self.air_fraction > 0
        held = jnp.where(has_air, pressure, self.atmospheric_pressure)
        free = jnp.where(has_air, self.air_ratio * self.atmospheric_pressure / held, 0)
        return pressure / self.bulk_modulus - free

    def state_slope(self, pressure: Pressure) -> Float[Array, "*grid"]:
        has_air = self.air_fraction > 0
        held = jnp.where(has_air, pressure, self.atmospheric_pressure)
        return 1 / self.bulk_modulus + self.air_ratio * self.atmospheric_pressure / held**2

    def pressure(self, state: Float[Array, "*grid"]) -> Pressure:
        # The positive root of P^2/beta - state P - a p0 = 0, without cancellation.
        air = 4 * self.air_ratio * self.atmospheric_pressure / self.bulk_modulus
        has_air = self.air_fraction > 0
        root = jnp.sqrt(state**2 + jnp.where(has_air, air, 1))
        pulled = smaller(state, 0)
        positive = jnp.where(state > 0, (state + root) / 2, air / (2 * (root - 2 * pulled + state)))
        return self.bulk_modulus * jnp.where(has_air, positive, state)

"""Oil with air in it, its mass conserved.

`rho(P) = (density + a rg) / (a th(P) (p0/P)^(1/n) + l(P))`, docs/theory.md section 13:
liquid and air together in a unit volume of liquid. The air is free below
atmospheric pressure `p0`, goes into solution up to the dissolution pressure
`pc`, and shrinks as a polytropic gas where it is free. The shape is that of
the usual homogeneous-mixture models (Merritt 1967, section 2-3; Yu, Chen and
Lu 1994; Gholizadeh, Burton and Schoenau 2011).
"""

from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from camring.numerics.quantity import Q, real, real_if_given
from camring.numerics.selection import bounded, smaller
from camring.numerics.smooth import (
    along,
    exponential_mean,
    inverse,
    logarithmic_mean,
    power,
    stiffening_decay,
)
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
    polytropic_index: Q[Float[Array, ""] | None, "1"] = eqx.field(
        converter=real_if_given, default=None
    )
    """None where free air stays as warm as the oil: an index of 1, in a form that is quick."""
    dissolution_pressure: Q[Float[Array, ""], "Pa"] = eqx.field(converter=real, default=3e6)
    """Above it all air is in solution."""
    modulus_gain: Q[Float[Array, ""] | None, "1"] = eqx.field(converter=real_if_given, default=None)
    """Rise of the liquid's bulk modulus for each unit of pressure; None where it does not."""

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

    def _gas(
        self, pressure: Pressure
    ) -> tuple[Q[Float[Array, "*grid"], "1"], Q[Float[Array, "*grid"], "1/Pa"]]:
        """Volume of all air, were it free, over the liquid's at atmospheric pressure, and its
        compressibility."""
        over = inverse(self._held(pressure))
        relative = self.atmospheric_pressure * over
        if self.polytropic_index is None:
            return self.air_ratio * relative, over
        each = 1 / self.polytropic_index
        return self.air_ratio * power(relative, each), each * over

    def _liquid(
        self, pressure: Pressure
    ) -> tuple[Q[Float[Array, "*grid"], "1"], Q[Float[Array, "*#grid"], "1/Pa"]]:
        """Volume of the liquid over that at atmospheric pressure, and its compressibility."""
        strain = (pressure - self.atmospheric_pressure) / self.bulk_modulus
        if self.modulus_gain is None:
            return jnp.exp(-strain), 1 / self.bulk_modulus
        stiffer = inverse(1 + self.modulus_gain * strain)
        return stiffening_decay(strain, self.modulus_gain), stiffer / self.bulk_modulus

    def _held(self, pressure: Pressure) -> Pressure:
        """The pressure; without air it may fall below zero, where no power is defined."""
        return jnp.where(self.air_fraction > 0, pressure, self.atmospheric_pressure)

    def _volume(
        self, pressure: Pressure
    ) -> tuple[Q[Float[Array, "*grid"], "1"], Q[Float[Array, "*grid"], "1/Pa"]]:
        """Volume over that of the liquid at atmospheric pressure, and minus its derivative."""
        gas, of_gas = self._gas(pressure)
        liquid, of_liquid = self._liquid(pressure)
        share, share_slope = self.undissolved(pressure)
        volume = gas * share + liquid
        return volume, gas * (share * of_gas - share_slope) + liquid * of_liquid

    def density_at(self, pressure: Pressure) -> Q[Float[Array, "*grid"], "kg/m3"]:
        return self.mass / self._volume(pressure)[0]

    def bulk_modulus_at(self, pressure: Pressure) -> Pressure:
        volume, shrinking = self._volume(pressure)
        return volume / shrinking

    def content(self, pressure: Pressure) -> Float[Array, "*grid"]:
        return self.density_at(pressure)

    def at(self, pressure: Pressure) -> OilAt:
        volume, shrinking = self._volume(pressure)
        share = inverse(volume)
        density = self.mass * share
        return OilAt(density, density, density * shrinking * share)

    def potential(self, pressure: Pressure) -> Float[Array, "*grid"]:
        """`h(P)`, the integral of dP/rho from atmospheric pressure, J/kg.

        A closed form, smooth through every value of gain and polytropic index.
        """
        # notation: p0 atmospheric pressure
        p0, held = self.atmospheric_pressure, self._held(pressure)
        # Between p0 and pc the free share is a cubic in q = P/p0.
        span = self.dissolution_pressure / p0 - 1
        square, cube = 3 / span**2, 2 / span**3
        cubic = 1 - square - cube, 2 * square + 3 * cube, -square - 3 * cube, cube
        expanded, compressed = smaller(held, p0), bounded(held, p0, self.dissolution_pressure)
        air = self._moments(expanded / p0, 1)[0]
        for coefficient, moment in zip(cubic, self._moments(compressed / p0, 4), strict=True):
            air = air + coefficient * moment
        return (self._liquid_work(pressure) + self.air_ratio * p0 * air) / self.mass

    def _moments(
        self, ratio: Q[Float[Array, "*grid"], "1"], count: int
    ) -> list[Q[Float[Array, "*grid"], "1"]]:
        """Integrals of `q^(k - 1/n)` from 1 to a ratio of pressures, for k from 0."""
        log = jnp.log(ratio)
        if self.polytropic_index is None:
            return [log, *((ratio**k - 1) / k for k in range(1, count))]
        flat = 1 - 1 / self.polytropic_index
        of_powers = (jnp.expm1((flat + k) * log) / (flat + k) for k in range(1, count))
        return [log * exponential_mean(flat * log), *of_powers]

    def _liquid_work(self, pressure: Pressure) -> Pressure:
        """Integral of the liquid's volume from atmospheric pressure."""
        strain, gain = (pressure - self.atmospheric_pressure) / self.bulk_modulus, self.modulus_gain
        if gain is None:
            return -self.bulk_modulus * jnp.expm1(-strain)
        log_strain = strain * logarithmic_mean(gain * strain)
        return self.bulk_modulus * log_strain * exponential_mean((gain - 1) * log_strain)

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
        return pressure / self.bulk_modulus - self._free * inverse(self._held(pressure))

    def state_slope(self, pressure: Pressure) -> Float[Array, "*grid"]:
        each = inverse(self._held(pressure))
        return 1 / self.bulk_modulus + self._free * each * each

    def pressure(self, state: Float[Array, "*grid"]) -> Pressure:
        return _pressure_of(state, self.bulk_modulus, self._free, self.air_fraction > 0)

    @property
    def _free(self) -> Pressure:
        """`a p0`: what free air holds at any pressure times that pressure."""
        return self.air_ratio * self.atmospheric_pressure


@jax.custom_jvp
def _pressure_of(
    state: Float[Array, "*grid"],
    bulk_modulus: Q[Float[Array, ""], "Pa"],
    free: Q[Float[Array, ""], "Pa"],
    has_air: Bool[Array, ""],
) -> Pressure:
    """The positive root of `P^2/beta - state P - free = 0`, without cancellation."""
    return _pressure_and_root(state, bulk_modulus, free, has_air)[0]


def _pressure_and_root(
    state: Array, bulk_modulus: Array, free: Array, has_air: Array
) -> tuple[Array, Array]:
    air = 4 * free / bulk_modulus
    root = jnp.sqrt(state**2 + jnp.where(has_air, air, 1))
    further = root + jnp.abs(state)
    positive = jnp.where(state > 0, further, air * inverse(further)) / 2
    return bulk_modulus * jnp.where(has_air, positive, state), root


def _pressure_slope(primals: tuple[Any, ...], tangents: tuple[Any, ...]) -> tuple[Array, Array]:
    """Of the equation itself: `root dP = P dstate + (P/beta)^2 dbeta + dfree`."""
    found, root = _pressure_and_root(*primals)
    _, bulk_modulus, _, has_air = primals
    over, share = inverse(root), found / bulk_modulus
    return found, along(
        found,
        tangents[:3],
        lambda: jnp.where(has_air, found * over, bulk_modulus),
        lambda: jnp.where(has_air, share * share * over, share),
        lambda: jnp.where(has_air, over, 0),
    )


_pressure_of.defjvp(_pressure_slope, symbolic_zeros=True)

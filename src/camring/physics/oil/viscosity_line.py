"""How the viscosity of an oil falls as it warms: Walther's line."""

from math import log

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.numerics.quantity import Q, real
from camring.physics.oil.presets import line_numbers

_ADDED = 0.7  # mm2/s, ASTM D341


class ViscosityLine(eqx.Module):
    """Walther's equation, ASTM D341: `log log (nu + 0.7) = height - fall log T`, nu in mm2/s.

    It serves for ratios: the viscosity of the oil at its own temperature stays what the oil
    says it is. Above the 2 mm2/s for which the standard states this form; smooth beyond.

    Examples
    --------
    >>> line = camring.ViscosityLine.of_oil("ISO VG 46", temperature=313.15)  # K
    >>> f"{46 * float(line.ratio(60.0)):.2f} mm2/s at 100 degC"
    '6.80 mm2/s at 100 degC'
    """

    temperature: Q[Float[Array, ""], "K"] = eqx.field(converter=real)
    """Of the oil as it comes in, at which it has the viscosity that it says."""
    height: Q[Float[Array, ""], "1"] = eqx.field(converter=real)
    fall: Q[Float[Array, ""], "1"] = eqx.field(converter=real)

    @classmethod
    def of_oil(cls, name: str, temperature: float) -> "ViscosityLine":
        """Of an oil by its name, such as `ISO VG 46`, that comes in at a temperature in K.

        Raises
        ------
        KeyError
            For a name that is not in `physics.oil.presets.OILS`.
        """
        return cls(real(temperature), *map(real, line_numbers(name)))

    def ratio(self, rise: Q[Float[Array, "*batch"], "K"]) -> Q[Float[Array, "*batch"], "1"]:
        """Viscosity so much warmer than the oil that comes in, over the viscosity of that."""
        return self._viscosity(self.temperature + rise) / self._viscosity(self.temperature)

    def _viscosity(self, temperature: Q[Float[Array, "*batch"], "K"]) -> Float[Array, "*batch"]:
        """In mm2/s."""
        ten = log(10)
        inner = jnp.exp(ten * self.height - self.fall * jnp.log(temperature))
        return jnp.exp(ten * inner) - _ADDED

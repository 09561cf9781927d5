"""What is asked of the motor: speed and pressures."""

import equinox as eqx
from jaxtyping import Array, Float

from camring.numerics.quantity import Q, real


class OperatingPoint(eqx.Module):
    """One steady duty; all pressures absolute."""

    shaft_speed: Q[Float[Array, ""], "rad/s"] = eqx.field(converter=real)
    supply_pressure: Q[Float[Array, ""], "Pa"] = eqx.field(converter=real)
    return_pressure: Q[Float[Array, ""], "Pa"] = eqx.field(converter=real)
    case_pressure: Q[Float[Array, ""], "Pa"] = eqx.field(converter=real)
    weight: Q[Float[Array, ""], "1"] = eqx.field(converter=real, default=1.0)

    @property
    def pressure_drop(self) -> Q[Float[Array, ""], "Pa"]:
        return self.supply_pressure - self.return_pressure

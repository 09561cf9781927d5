"""What is asked of the motor: speed and pressures."""

import equinox as eqx
from jaxtyping import Array, Float

from camring.numerics.quantity import Q, real


class OperatingPoint(eqx.Module):
    """One steady duty; all pressures absolute, the speed positive either way round."""

    shaft_speed: Q[Float[Array, ""], "rad/s"] = eqx.field(converter=real)
    supply_pressure: Q[Float[Array, ""], "Pa"] = eqx.field(converter=real)
    return_pressure: Q[Float[Array, ""], "Pa"] = eqx.field(converter=real)
    case_pressure: Q[Float[Array, ""], "Pa"] = eqx.field(converter=real)
    weight: Q[Float[Array, ""], "1"] = eqx.field(converter=real, default=1.0)
    reverse: bool = eqx.field(static=True, default=False)
    """Whether it turns backwards, because a valve exchanges the ports of supply and return."""

    @property
    def pressure_drop(self) -> Q[Float[Array, ""], "Pa"]:
        return self.supply_pressure - self.return_pressure

"""What is asked of the motor: speed and pressures."""

import equinox as eqx
from jaxtyping import Array, Float

from camring.numerics.quantity import Q, real
from camring.numerics.readable import readable
from camring.numerics.selection import larger, smaller


class OperatingPoint(eqx.Module):
    """One steady operating point; pressures absolute, the speed positive either way round.

    Examples
    --------
    >>> from math import pi
    >>> point = camring.OperatingPoint(100 * pi / 30, 250e5, 10e5, 10e5)  # 100 rpm
    >>> float(point.pressure_drop) / 1e5  # bar
    240.0
    """

    shaft_speed: Q[Float[Array, ""], "rad/s"] = eqx.field(converter=real)
    supply_pressure: Q[Float[Array, ""], "Pa"] = eqx.field(converter=real)
    return_pressure: Q[Float[Array, ""], "Pa"] = eqx.field(converter=real)
    case_pressure: Q[Float[Array, ""], "Pa"] = eqx.field(converter=real)
    weight: Q[Float[Array, ""], "1"] = eqx.field(converter=real, default=1.0)
    reverse: bool = eqx.field(static=True, default=False)
    """Whether it turns backwards, because a valve exchanges the ports of supply and return."""
    idle_lobes: tuple[int, ...] = eqx.field(static=True, default=())
    """Lobes that a valve leads to the return, counted from 0; see `geometry.idle_lobes`."""
    mode: str = eqx.field(static=True, default="")
    """What the motor file calls them."""

    @property
    def pressure_drop(self) -> Q[Float[Array, ""], "Pa"]:
        """Negative where the machine brakes: it takes oil at the lower of its two pressures."""
        return self.supply_pressure - self.return_pressure

    @property
    def higher_pressure(self) -> Q[Float[Array, ""], "Pa"]:
        """The supply's, or the return's where the machine brakes."""
        return larger(self.supply_pressure, self.return_pressure)

    @property
    def lower_pressure(self) -> Q[Float[Array, ""], "Pa"]:
        """The return's, or the supply's where the machine brakes."""
        return smaller(self.supply_pressure, self.return_pressure)

    __repr__ = readable

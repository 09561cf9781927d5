"""What keeps a motor cool: the oil that leaves its case, and its surface."""

import equinox as eqx
from jaxtyping import Array, Float

from camring.numerics.quantity import Q, real
from camring.physics.oil.fluid import AbstractFluid


class Thermal(eqx.Module):
    """Heat transfer of a motor in steady service, case and films at one temperature.

    The oil comes in at the temperature of the operating point's fluid. What is lost in films,
    contacts and leakage stays in the motor (`camring.physics.heat.balance`); it warms the oil
    that drains from the case, and leaves through the surface. docs/theory.md section 14.

    Examples
    --------
    >>> cooling = camring.Thermal(ambient_temperature=293.15, heat_transfer=12.0)  # K, W/K
    >>> float(cooling.specific_heat), float(cooling.rise)
    (1900.0, 0.0)
    """

    ambient_temperature: Q[Float[Array, ""], "K"] = eqx.field(converter=real)
    heat_transfer: Q[Float[Array, ""], "W/K"] = eqx.field(converter=real)
    """Of the whole surface: its area times the coefficient of the air around it."""
    specific_heat: Q[Float[Array, ""], "J/(kg.K)"] = eqx.field(converter=real, default=1900.0)
    """Of the oil."""
    rise: Q[Float[Array, ""], "K"] = eqx.field(converter=real, default=0.0)
    """Of case and films above the oil that comes in. A simulation finds it and keeps it here,
    in the motor of its cycle; what is given is where it begins."""

    def film_oil(self, fluid: AbstractFluid) -> AbstractFluid:
        """The oil as it is in films and leakage paths.

        Raises
        ------
        ValueError
            For an oil that does not say how its viscosity follows the temperature.
        """
        if fluid.line is None:
            raise ValueError(
                "A motor with a heat balance needs an oil whose viscosity follows its temperature: "
                "give the fluid a line, such as ViscosityLine.of_oil('ISO VG 46', 323.15)."
            )
        warmed = fluid.viscosity * fluid.line.ratio(self.rise)
        return eqx.tree_at(lambda each: each.viscosity, fluid, warmed)

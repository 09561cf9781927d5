"""The ring gap around a piston: what leaks along it and what its film holds back."""

from math import pi

import equinox as eqx
from jaxtyping import Array, Float

from camring.geometry.piston import Piston
from camring.numerics.quantity import Q, real
from camring.physics.fluid import AbstractFluid


class PistonGap(eqx.Module):
    """A thin gap between piston and bore, filled with oil of one viscosity.

    Laminar flow between nearly parallel walls: clearance small against bore,
    the eccentricity that of parallel axes. Both effects come on top of the
    motor's coefficients. model.md section 13; Merritt (1967), section 2-4;
    Ivantysyn and Ivantysynova (2001), section 4.2.
    """

    clearance: Q[Float[Array, ""], "m"] = eqx.field(converter=real)
    """Radial: half the difference of the diameters."""
    length: Q[Float[Array, ""], "m"] = eqx.field(converter=real)
    eccentricity: Q[Float[Array, ""], "1"] = eqx.field(converter=real, default=0.0)
    """Displacement of the axes over the clearance, in [0, 1]."""

    def leakage_conductance(
        self, piston: Piston, fluid: AbstractFluid
    ) -> Q[Float[Array, ""], "m3/(s.Pa)"]:
        """`pi d c^3 (1 + 1.5 e^2) / (12 mu L)`: volume flow along the gap for each pascal."""
        height = self.clearance**3 * (1 + 1.5 * self.eccentricity**2)
        return pi * piston.bore * height / (12 * _dynamic_viscosity(fluid) * self.length)

    def film_damping(self, piston: Piston, fluid: AbstractFluid) -> Q[Float[Array, ""], "N.s/m"]:
        """`mu pi d L / c`: shear force of the film for each metre a second, axes in line."""
        return _dynamic_viscosity(fluid) * pi * piston.bore * self.length / self.clearance


def _dynamic_viscosity(fluid: AbstractFluid) -> Q[Float[Array, ""], "Pa.s"]:
    return fluid.density * fluid.viscosity

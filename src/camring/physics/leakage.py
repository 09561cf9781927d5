"""Oil that leaves a chamber past the piston into the case."""

from abc import abstractmethod
from typing import NamedTuple

import equinox as eqx
from jaxtyping import Array, Float

from camring.geometry.piston import Piston
from camring.numerics.quantity import Q, real
from camring.physics.oil.fluid import AbstractFluid


class LeakageEnds(NamedTuple):
    """What stands at the two ends of a leakage path."""

    chamber_pressure: Q[Float[Array, "*grid"], "Pa"]
    case_pressure: Q[Float[Array, ""], "Pa"]

    @property
    def drop(self) -> Q[Float[Array, "*grid"], "Pa"]:
        """Pressure difference that drives the flow, positive out of the chamber."""
        return self.chamber_pressure - self.case_pressure


class AbstractLeakage(eqx.Module):
    """A leakage path from each chamber into the case."""

    @abstractmethod
    def flow(
        self, ends: LeakageEnds, piston: Piston, fluid: AbstractFluid
    ) -> Q[Float[Array, "*grid"], "m3/s"]:
        """Volume flow out of one chamber, with the sign of the pressure difference.

        Parameters
        ----------
        ends
            Pressures of chamber and case.
        piston
            Whose circumference leaks.
        fluid
            Its `density`, its kinematic `viscosity` and what else it knows at a pressure.

        Notes
        -----
        It should rise with the chamber's pressure: a path that lets less through at a
        higher pressure can make the periodic pressure ambiguous.
        """


class ConstantLeakage(AbstractLeakage):
    """A leakage coefficient: `Q = Cl (P - P_case)`. docs/theory.md section 3.

    Laminar, of one viscosity; `PistonGap` has the geometry in it.

    Examples
    --------
    >>> from camring.physics.leakage import LeakageEnds
    >>> oil = camring.ConstantFluid(density=870.0, bulk_modulus=1.4e9, vapour_pressure=3e3)
    >>> leakage, piston = camring.ConstantLeakage(2e-13), camring.Piston(0.036, 0.5)
    >>> flow = leakage.flow(LeakageEnds(250e5, 10e5), piston, oil)  # m3/s
    >>> round(float(flow) * 6e4, 3)  # L/min
    0.288
    """

    coefficient: Q[Float[Array, ""], "m3/(s.Pa)"] = eqx.field(converter=real)

    def flow(
        self, ends: LeakageEnds, piston: Piston, fluid: AbstractFluid
    ) -> Q[Float[Array, "*grid"], "m3/s"]:
        return self.coefficient * ends.drop


class ViscousLeakage(AbstractLeakage):
    """A leakage coefficient of a laminar path: `Q = Cl (nu_ref / nu) (P - P_case)`.

    The coefficient is that at the reference viscosity; thinner oil leaks more. docs/theory.md
    section 14. Both viscosities are kinematic, the density being that of one oil: its change
    with temperature, some per cent, is left out.

    Examples
    --------
    >>> oil = camring.ConstantFluid(870.0, 1.4e9, 3e3, viscosity=23e-6)
    >>> leakage = camring.ViscousLeakage(coefficient=2e-13, reference_viscosity=46e-6)
    >>> float(leakage.reference_viscosity / oil.viscosity)  # so many times that of the coefficient
    2.0
    """

    coefficient: Q[Float[Array, ""], "m3/(s.Pa)"] = eqx.field(converter=real)
    reference_viscosity: Q[Float[Array, ""], "m2/s"] = eqx.field(converter=real)
    """Kinematic, of the oil with which the coefficient was measured."""

    def flow(
        self, ends: LeakageEnds, piston: Piston, fluid: AbstractFluid
    ) -> Q[Float[Array, "*grid"], "m3/s"]:
        return self.coefficient * (self.reference_viscosity / fluid.viscosity) * ends.drop

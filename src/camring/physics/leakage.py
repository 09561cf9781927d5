"""Oil that leaves a chamber past the piston into the case."""

from abc import abstractmethod

import equinox as eqx
from jaxtyping import Array, Float

from camring.geometry.piston import Piston
from camring.numerics.quantity import Q, real
from camring.physics.fluid import AbstractFluid


class AbstractLeakage(eqx.Module):
    """A leakage path with laminar flow: volume flow = conductance times pressure drop."""

    @abstractmethod
    def conductance(self, piston: Piston, fluid: AbstractFluid) -> Q[Float[Array, ""], "m3/(s.Pa)"]:
        """Volume flow for each pascal between chamber and case."""


class ConstantLeakage(AbstractLeakage):
    """A leakage coefficient: `Q = Cl (P - P_case)`. model.md section 3."""

    coefficient: Q[Float[Array, ""], "m3/(s.Pa)"] = eqx.field(converter=real)

    def conductance(self, piston: Piston, fluid: AbstractFluid) -> Q[Float[Array, ""], "m3/(s.Pa)"]:
        return self.coefficient

"""What rubs: a force against the piston's motion, and torque lost in the contact."""

from abc import abstractmethod

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.geometry.piston import Piston, Roller
from camring.numerics.quantity import Q, real
from camring.numerics.spline import Jet
from camring.physics.fluid import AbstractFluid


class AbstractFriction(eqx.Module):
    """A friction law of one piston."""

    @abstractmethod
    def viscous_damping(self, piston: Piston, fluid: AbstractFluid) -> Q[Float[Array, ""], "N.s/m"]:
        """Force against the piston's motion for each metre a second."""

    @abstractmethod
    def loss_torque(
        self,
        radius: Jet,
        force: Q[Float[Array, "*grid"], "N"],
        normal_force: Q[Float[Array, "*grid"], "N"],
        roller: Roller,
    ) -> Q[Float[Array, "*grid"], "N.m"]:
        """Torque one piston loses in its contacts, taken off `F ds/dtheta`."""


class ViscousFriction(AbstractFriction):
    """A damping coefficient alone: force `cm w s'` against the motion. model.md section 4."""

    damping: Q[Float[Array, ""], "N.s/m"] = eqx.field(converter=real)

    def viscous_damping(self, piston: Piston, fluid: AbstractFluid) -> Q[Float[Array, ""], "N.s/m"]:
        return self.damping

    def loss_torque(
        self,
        radius: Jet,
        force: Q[Float[Array, "*grid"], "N"],
        normal_force: Q[Float[Array, "*grid"], "N"],
        roller: Roller,
    ) -> Q[Float[Array, "*grid"], "N.m"]:
        return jnp.zeros_like(force)

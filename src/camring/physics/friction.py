"""What rubs: a force against the piston's motion, and torque lost in the contact."""

from abc import abstractmethod

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.geometry.contour import undercut_factor
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
    """Damping of the piston's film, and rolling and sliding friction of its loaded contacts.

    The film pushes with `cm w s'` against the motion (model.md section 4). The
    contacts take off a torque proportional to their load, the greater part of
    a real motor's loss (section 13): rolling resistance of the roller on the
    ring, `mu_r max(F_n, 0) (1 + kappa Rf) sqrt(r^2 + r'^2)`, the last two
    factors being the ring's length for each radian, and the piston's side
    load on its bore, `mu_s |F tan(phi)| |s'|`. Both are zero unless given.
    """

    damping: Q[Float[Array, ""], "N.s/m"] = eqx.field(converter=real)
    roller: Q[Float[Array, ""], "1"] = eqx.field(converter=real, default=0.0)
    """Friction force over normal force where the roller meets the ring; about 0.013."""
    side: Q[Float[Array, ""], "1"] = eqx.field(converter=real, default=0.0)
    """Friction force over side force where the piston meets its bore."""

    def viscous_damping(self, piston: Piston, fluid: AbstractFluid) -> Q[Float[Array, ""], "N.s/m"]:
        return self.damping

    def loss_torque(
        self,
        radius: Jet,
        force: Q[Float[Array, "*grid"], "N"],
        normal_force: Q[Float[Array, "*grid"], "N"],
        roller: Roller,
    ) -> Q[Float[Array, "*grid"], "N.m"]:
        arc = undercut_factor(radius, roller.radius) * jnp.hypot(radius.value, radius.first)
        sideways = jnp.abs(force * radius.first / radius.value)
        rolling = self.roller * jnp.maximum(normal_force, 0) * arc
        return rolling + self.side * sideways * jnp.abs(radius.first)

"""What rubs: a force against the piston's motion, and torque lost in the contact."""

from abc import abstractmethod
from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.geometry.contour import undercut_factor
from camring.geometry.piston import Piston, Roller
from camring.numerics.quantity import Q, real
from camring.numerics.selection import larger
from camring.numerics.spline import Jet
from camring.physics.oil.fluid import AbstractFluid


class SlidingContacts(NamedTuple):
    """The loaded contacts of one piston, roller and side, and how fast they slide."""

    radius: Jet
    """Of the pitch curve where the piston stands."""
    force: Q[Float[Array, "*grid"], "N"]
    """Radial, on the cam; negative means lift-off."""
    normal_force: Q[Float[Array, "*grid"], "N"]
    """Of the roller on the ring."""
    roller: Roller
    shaft_speed: Q[Float[Array, ""], "rad/s"]

    @property
    def ring_length(self) -> Q[Float[Array, "*grid"], "m/rad"]:
        """`(1 + kappa Rf) sqrt(r^2 + r'^2)`: ring that passes the roller for each radian."""
        stretched = undercut_factor(self.radius, self.roller.radius)
        return stretched * jnp.hypot(self.radius.value, self.radius.first)

    @property
    def side_force(self) -> Q[Float[Array, "*grid"], "N"]:
        """`|F tan(phi)|`: of the piston on its bore."""
        return jnp.abs(self.force * self.radius.first / self.radius.value)

    @property
    def roller_speed(self) -> Q[Float[Array, "*grid"], "m/s"]:
        """Of the roller's surface in its seat; it rolls on the ring. docs/theory.md section 14."""
        return self.shaft_speed * self.ring_length

    @property
    def piston_speed(self) -> Q[Float[Array, "*grid"], "m/s"]:
        """Of the piston along its bore, without sign: `|w s'|`."""
        return jnp.abs(self.shaft_speed * self.radius.first)


class AbstractFriction(eqx.Module):
    """A friction law of one piston."""

    @abstractmethod
    def viscous_damping(self, piston: Piston, fluid: AbstractFluid) -> Q[Float[Array, ""], "N.s/m"]:
        """Force against the piston's motion for each metre a second."""

    @abstractmethod
    def loss_torque(
        self, contacts: SlidingContacts, piston: Piston, fluid: AbstractFluid
    ) -> Q[Float[Array, "*grid"], "N.m"]:
        """Torque one piston loses in its contacts, taken off `F ds/dtheta`; not negative.

        Parameters
        ----------
        contacts
            Forces, roller and sliding speeds. Work a radian is force times `ring_length`
            for the roller and times `|s'|` for the piston's side, so that a law needs no
            division by a speed and holds at standstill.
        piston, fluid
            For laws of a film: bore, and the oil's density and viscosity.
        """


class ViscousFriction(AbstractFriction):
    """Damping of the piston's film, and rolling and sliding friction of its loaded contacts.

    The film pushes with `cm w s'` against the motion (docs/theory.md section 4). The
    contacts take off a torque proportional to their load, the greater part of
    a real motor's loss (section 13): rolling resistance of the roller on the
    ring, `mu_r max(F_n, 0) (1 + kappa Rf) sqrt(r^2 + r'^2)`, the last two
    factors being the ring's length for each radian, and the piston's side
    load on its bore, `mu_s |F tan(phi)| |s'|`. Both are zero unless given.

    Examples
    --------
    >>> friction = camring.ViscousFriction(damping=80.0, roller=0.013)  # N s/m, 1
    >>> float(friction.roller), float(friction.side)
    (0.013, 0.0)
    """

    damping: Q[Float[Array, ""], "N.s/m"] = eqx.field(converter=real)
    roller: Q[Float[Array, ""], "1"] = eqx.field(converter=real, default=0.0)
    """Friction force over normal force where the roller meets the ring; about 0.013."""
    side: Q[Float[Array, ""], "1"] = eqx.field(converter=real, default=0.0)
    """Friction force over side force where the piston meets its bore."""

    def viscous_damping(self, piston: Piston, fluid: AbstractFluid) -> Q[Float[Array, ""], "N.s/m"]:
        return self.damping

    def loss_torque(
        self, contacts: SlidingContacts, piston: Piston, fluid: AbstractFluid
    ) -> Q[Float[Array, "*grid"], "N.m"]:
        rolling = self.roller * larger(contacts.normal_force, 0) * contacts.ring_length
        return rolling + self.side * contacts.side_force * jnp.abs(contacts.radius.first)

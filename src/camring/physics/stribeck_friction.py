"""Friction that is greater at rest than in motion: Stribeck's curve without its rise."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.geometry.piston import Piston
from camring.numerics.quantity import Q, real
from camring.numerics.selection import larger
from camring.physics.friction import AbstractFriction, SlidingContacts
from camring.physics.oil.fluid import AbstractFluid


class StribeckFriction(AbstractFriction):
    """Film damping, and contacts whose coefficient falls with speed from its value at rest.

    `mu(v) = mu + (mu_static - mu) exp(-v / v_stribeck)` in place of each coefficient of
    `ViscousFriction`: `v` is the speed of the roller's surface in its seat,
    `w (1 + kappa Rf) sqrt(r^2 + r'^2)`, and of the piston along its bore, `|w s'|`. The rise
    at high speed is the film's own, `damping` or the gap's. docs/theory.md section 14; Stribeck,
    *Zeitschrift des VDI* 46 (1902); the exponential is Bo and Pavelescu's (1982).

    Examples
    --------
    >>> friction = camring.StribeckFriction(
    ...     damping=0.0, roller=0.006, roller_static=0.03, roller_stribeck=0.05,
    ...     side=0.03, side_static=0.12, side_stribeck=0.05,
    ... )  # N s/m, 1, 1, m/s
    >>> float(friction.side_static)
    0.12
    """

    damping: Q[Float[Array, ""], "N.s/m"] = eqx.field(converter=real)
    roller: Q[Float[Array, ""], "1"] = eqx.field(converter=real)
    """Friction force over normal force of a fast roller."""
    roller_static: Q[Float[Array, ""], "1"] = eqx.field(converter=real)
    """The same at rest."""
    roller_stribeck: Q[Float[Array, ""], "m/s"] = eqx.field(converter=real)
    """Speed at which the difference has fallen to 1/e."""
    side: Q[Float[Array, ""], "1"] = eqx.field(converter=real)
    side_static: Q[Float[Array, ""], "1"] = eqx.field(converter=real)
    side_stribeck: Q[Float[Array, ""], "m/s"] = eqx.field(converter=real)

    def viscous_damping(self, piston: Piston, fluid: AbstractFluid) -> Q[Float[Array, ""], "N.s/m"]:
        return self.damping

    def loss_torque(
        self, contacts: SlidingContacts, piston: Piston, fluid: AbstractFluid
    ) -> Q[Float[Array, "*grid"], "N.m"]:
        roller = _at_speed(
            self.roller, self.roller_static, jnp.abs(contacts.roller_speed) / self.roller_stribeck
        )
        side = _at_speed(self.side, self.side_static, contacts.piston_speed / self.side_stribeck)
        rolling = roller * larger(contacts.normal_force, 0) * contacts.ring_length
        return rolling + side * contacts.side_force * jnp.abs(contacts.radius.first)


def _at_speed(
    fast: Float[Array, ""], static: Float[Array, ""], ratio: Float[Array, "*grid"]
) -> Float[Array, "*grid"]:
    return fast + (static - fast) * jnp.exp(-ratio)

"""A relief notch: a groove that lets oil through before the port itself opens."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.geometry.window import AbstractWindow
from camring.numerics.quantity import Q, real
from camring.numerics.selection import bounded, smaller


class ReliefNotch(eqx.Module):
    """A groove of triangular section at the opening edge of every port.

    Its area grows with the square of the angle from the notch's tip to the
    port's edge, and stays: `alpha + f clip((d + D/2 + g)/g, 0, 1)^2`, at most
    1, on the opening side `d < 0`. Whatever the window's shape. docs/theory.md
    section 13; Edge and Darling (1986) for what it does to commutation.

    Examples
    --------
    >>> notch, window = camring.ReliefNotch(angle=0.05, area=0.1), camring.LinearWindow(0.5)
    >>> round(float(notch.opening(window, -0.225, 0.4)), 3)  # before the window's own edge
    0.025
    """

    angle: Q[Float[Array, ""], "rad"] = eqx.field(converter=real)
    """From tip to port edge."""
    area: Q[Float[Array, ""], "1"] = eqx.field(converter=real)
    """Full opening of the groove over the port area."""

    def opening(
        self,
        window: AbstractWindow,
        distance: Q[Float[Array, "*grid"], "rad"],
        width: Q[Float[Array, ""], "rad"],
    ) -> Q[Float[Array, "*grid"], "1"]:
        """Open share of port and groove together, in [0, 1]."""
        along = bounded((distance + width / 2 + self.angle) / self.angle, 0, 1)
        groove = jnp.where(distance < 0, self.area * along**2, 0.0)
        return smaller(window.opening(distance, width) + groove, 1.0)

    def edges(
        self, window: AbstractWindow, width: Q[Float[Array, ""], "rad"]
    ) -> Q[Float[Array, " edge"], "rad"]:
        """The window's edges, the notch's tip, where both together are full, and the centre.

        In no order: in a batch, a sort along the last axis would mix motors.
        """
        tip = -width / 2 - self.angle
        full = window.opens_to(1 - self.area, width)
        own = jnp.stack([tip, full, jnp.zeros_like(tip)])
        return jnp.concatenate([window.edges(width), own])

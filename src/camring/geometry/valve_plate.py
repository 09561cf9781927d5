"""The valve plate: where and how far each chamber is open to supply and return.

The plate places one supply and one return window in every lobe pitch, both of
one shape and with the same relief notch, if any (model.md sections 3 and 13).
"""

from math import pi

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.geometry.angles import signed_distance
from camring.geometry.notch import ReliefNotch
from camring.geometry.window import AbstractWindow, LinearWindow
from camring.numerics.quantity import Q, real

__all__ = ["AbstractWindow", "LinearWindow", "Port", "ValvePlate"]


class Port(eqx.Module):
    """One kind of port, repeated once a lobe pitch."""

    width: Q[Float[Array, ""], "rad"] = eqx.field(converter=real)
    centre: Q[Float[Array, ""], "rad"] = eqx.field(converter=real)


class ValvePlate(eqx.Module):
    """Supply and return ports, one of each in every lobe pitch.

    `shift` turns both kinds together against the cam: the valve timing.
    """

    port_area: Q[Float[Array, ""], "m2"] = eqx.field(converter=real)
    supply: Port
    return_: Port
    window: AbstractWindow
    shift: Q[Float[Array, ""], "rad"] = eqx.field(converter=real, default=0.0)
    notch: ReliefNotch | None = None
    lobes: int = eqx.field(static=True, kw_only=True)

    @property
    def pitch(self) -> float:
        """Angle from one supply port to the next, rad."""
        return 2 * pi / self.lobes

    @property
    def edge_count(self) -> int:
        """Window edges in one lobe pitch, both kinds of port."""
        return sum(self._edges(port).shape[-1] for port in (self.supply, self.return_))

    def opening(
        self, port: Port, angle: Q[Float[Array, "*grid"], "rad"]
    ) -> Q[Float[Array, "*grid"], "1"]:
        """Open share of the port area that a chamber at `angle` sees of one kind of port."""
        distance = signed_distance(angle, port.centre + self.shift, self.pitch)
        if self.notch is None:
            return self.window.opening(distance, port.width)
        return self.notch.opening(self.window, distance, port.width)

    def _edges(self, port: Port) -> Q[Float[Array, " edge"], "rad"]:
        """Distances from a port's centre where its opening is not smooth."""
        if self.notch is None:
            return self.window.edges(port.width)
        return self.notch.edges(self.window, port.width)

    def breakpoints(self) -> Q[Float[Array, " edge"], "rad"]:
        """Window edges of both kinds within one lobe pitch, in [0, pitch], unsorted."""
        around = [
            port.centre + self.shift + self._edges(port) for port in (self.supply, self.return_)
        ]
        return jnp.concatenate(around) % self.pitch

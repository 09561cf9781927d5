"""The valve plate: where and how far each chamber is open to supply and return.

A window answers with its opening, a number in [0, 1], at a signed angular
distance from its centre. The shapes are exchangeable; the plate places one
supply and one return window in every lobe pitch (model.md section 3).
"""

from abc import abstractmethod
from math import pi

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.geometry.angles import signed_distance
from camring.numerics.quantity import Q, real


class AbstractWindow(eqx.Module):
    """Opening of one port window against the distance from its centre."""

    @abstractmethod
    def opening(
        self, distance: Q[Float[Array, "*grid"], "rad"], width: Q[Float[Array, ""], "rad"]
    ) -> Q[Float[Array, "*grid"], "1"]:
        """Open share of the port area, in [0, 1]; zero outside the window."""

    @abstractmethod
    def edges(self, width: Q[Float[Array, ""], "rad"]) -> Q[Float[Array, " edge"], "rad"]:
        """Distances from the centre where the opening is not smooth, ascending."""


class LinearWindow(AbstractWindow):
    """A trapezoid of opening: linear ramps, flat between them.

    `alpha = clip((D/2 - |d|) / (ramp D/2), 0, 1)`; `ramp = 1` is the
    derivation's triangle. model.md section 3.
    """

    ramp: Q[Float[Array, ""], "1"] = eqx.field(converter=real)

    def opening(
        self, distance: Q[Float[Array, "*grid"], "rad"], width: Q[Float[Array, ""], "rad"]
    ) -> Q[Float[Array, "*grid"], "1"]:
        half = width / 2
        return jnp.clip((half - jnp.abs(distance)) / (self.ramp * half), 0, 1)

    def edges(self, width: Q[Float[Array, ""], "rad"]) -> Q[Float[Array, " edge"], "rad"]:
        half = width / 2
        shoulder = half * (1 - self.ramp)
        return jnp.stack([-half, -shoulder, shoulder, half])


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
    lobes: int = eqx.field(static=True, kw_only=True)

    @property
    def pitch(self) -> float:
        """Angle from one supply port to the next, rad."""
        return 2 * pi / self.lobes

    @property
    def edge_count(self) -> int:
        """Window edges in one lobe pitch, both kinds of port."""
        return sum(self.window.edges(port.width).shape[-1] for port in (self.supply, self.return_))

    def opening(
        self, port: Port, angle: Q[Float[Array, "*grid"], "rad"]
    ) -> Q[Float[Array, "*grid"], "1"]:
        """Open share of the port area that a chamber at `angle` sees of one kind of port."""
        distance = signed_distance(angle, port.centre + self.shift, self.pitch)
        return self.window.opening(distance, port.width)

    def breakpoints(self) -> Q[Float[Array, " edge"], "rad"]:
        """Window edges of both kinds within one lobe pitch, in [0, pitch], unsorted."""
        around = [
            port.centre + self.shift + self.window.edges(port.width)
            for port in (self.supply, self.return_)
        ]
        return jnp.concatenate(around) % self.pitch

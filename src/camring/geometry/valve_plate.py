"""The valve plate: where and how far each chamber is open to supply and return.

The plate places one supply and one return window in every lobe pitch, both of
one shape and with the same relief notch, if any (docs/theory.md sections 3 and 13); a kind
may have area, ramp, notch and discharge coefficient of its own (section 14).
"""

from math import pi
from operator import attrgetter

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.geometry.angles import REVOLUTION, signed_distance
from camring.geometry.notch import ReliefNotch
from camring.geometry.window import AbstractWindow, LinearWindow
from camring.numerics.quantity import ArrayLike, Q, real

__all__ = ["AbstractWindow", "LinearWindow", "Port", "ValvePlate"]


def _if_given(value: ArrayLike | None) -> Float[Array, "..."] | None:
    return None if value is None else real(value)


class Port(eqx.Module):
    """One kind of port, repeated once a lobe pitch.

    `width` is the whole angle in which it is open at all, `centre` counts from a lobe's inner
    dead centre, before the plate's `shift`. What else a kind may have of its own is None where
    it is that of both kinds: area, notch and window of the plate, the orifice of the motor.
    """

    width: Q[Float[Array, ""], "rad"] = eqx.field(converter=real)
    centre: Q[Float[Array, ""], "rad"] = eqx.field(converter=real)
    area: Q[Float[Array, ""] | None, "m2"] = eqx.field(converter=_if_given, default=None)
    """Of one fully open port."""
    discharge_coefficient: Q[Float[Array, ""] | None, "1"] = eqx.field(
        converter=_if_given, default=None
    )
    ramp: Q[Float[Array, ""] | None, "1"] = eqx.field(converter=_if_given, default=None)
    """Share of half the window in which it opens; for windows that have a ramp."""
    notch: ReliefNotch | None = None
    """Its area counts over that of this kind of port."""


class ValvePlate(eqx.Module):
    """Supply and return ports, one of each in every lobe pitch.

    `shift` turns both kinds together against the cam: the valve timing. docs/theory.md
    section 3.

    Examples
    --------
    >>> from math import pi, radians
    >>> pitch = 2 * pi / 6
    >>> plate = camring.ValvePlate(
    ...     port_area=60e-6,
    ...     supply=camring.Port(width=radians(28), centre=pitch / 4),
    ...     return_=camring.Port(width=radians(28), centre=3 * pitch / 4),
    ...     window=camring.LinearWindow(ramp=0.5),
    ...     lobes=6,
    ... )
    >>> [round(float(plate.opening(plate.supply, radians(angle))), 3) for angle in (0, 3, 15)]
    [0.0, 0.286, 1.0]
    """

    port_area: Q[Float[Array, ""], "m2"] = eqx.field(converter=real)
    supply: Port
    return_: Port
    window: AbstractWindow
    shift: Q[Float[Array, ""], "rad"] = eqx.field(converter=real, default=0.0)
    notch: ReliefNotch | None = None
    lobes: int = eqx.field(static=True, kw_only=True)
    idle_lobes: tuple[int, ...] = eqx.field(static=True, default=(), kw_only=True)
    """Those whose supply window leads to the return, counted from 0; see `geometry.idle_lobes`."""

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
        window, notch = self.window_of(port), self.notch_of(port)
        if notch is None:
            return window.opening(distance, port.width)
        return notch.opening(window, distance, port.width)

    def area_of(self, port: Port) -> Q[Float[Array, ""], "m2"]:
        """Of one fully open port of a kind."""
        return self.port_area if port.area is None else port.area

    def window_of(self, port: Port) -> AbstractWindow:
        """The window of a kind of port, with the ramp of its own if it has one."""
        if port.ramp is None:
            return self.window
        return eqx.tree_at(attrgetter("ramp"), self.window, port.ramp)

    def notch_of(self, port: Port) -> ReliefNotch | None:
        """The relief notch of a kind of port; None without one."""
        return self.notch if port.notch is None else port.notch

    @property
    def notched(self) -> bool:
        """Whether any port has a relief notch."""
        return any(self.notch_of(port) is not None for port in (self.supply, self.return_))

    def idle_share(
        self, port: Port, angle: Q[Float[Array, "*grid"], "rad"]
    ) -> Q[Float[Array, "*grid"], "1"]:
        """One where the nearest window of a kind is an idle lobe's, else zero."""
        found = jnp.zeros_like(angle)
        for lobe in self.idle_lobes:
            centre = port.centre + self.shift + lobe * self.pitch
            away = jnp.abs(signed_distance(angle, centre, REVOLUTION))
            found = jnp.where(away < self.pitch / 2, 1.0, found)
        return found

    def _edges(self, port: Port) -> Q[Float[Array, " edge"], "rad"]:
        """Distances from a port's centre where its opening is not smooth."""
        window, notch = self.window_of(port), self.notch_of(port)
        return window.edges(port.width) if notch is None else notch.edges(window, port.width)

    def breakpoints(self) -> Q[Float[Array, " edge"], "rad"]:
        """Window edges of both kinds within one lobe pitch, in [0, pitch], unsorted."""
        around = [
            port.centre + self.shift + self._edges(port) for port in (self.supply, self.return_)
        ]
        return jnp.concatenate(around) % self.pitch

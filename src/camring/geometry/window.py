"""How far one port window is open, against the distance from its centre.

The shapes are exchangeable: each answers with the open share of the port area,
with the places where that share is not smooth, and with the place on its
opening side where it comes to a given share. docs/theory.md sections 3 and 13.
"""

from abc import abstractmethod
from math import pi
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.numerics.quantity import Q, real
from camring.numerics.selection import bounded, smaller, smallest

Angle = Q[Float[Array, "*grid"], "rad"]
Width = Q[Float[Array, ""], "rad"]


class AbstractWindow(eqx.Module):
    """Opening of one port window against the distance from its centre."""

    @abstractmethod
    def opening(self, distance: Angle, width: Width) -> Q[Float[Array, "*grid"], "1"]:
        """Open share of the port area, in [0, 1]; zero outside the window."""

    @abstractmethod
    def edges(self, width: Width) -> Q[Float[Array, " edge"], "rad"]:
        """Distances from the centre where the opening is not smooth, ascending."""

    @abstractmethod
    def opens_to(self, share: Q[Float[Array, ""], "1"], width: Width) -> Q[Float[Array, ""], "rad"]:
        """Distance from the centre, not positive, at which the opening first reaches a share."""


class LinearWindow(AbstractWindow):
    """A trapezoid of opening: linear ramps, flat between them.

    `alpha = clip((D/2 - |d|) / (ramp D/2), 0, 1)`; `ramp = 1` is the
    derivation's triangle. docs/theory.md section 3.

    Examples
    --------
    >>> window = camring.LinearWindow(ramp=0.5)
    >>> [round(float(window.opening(distance, 0.4)), 3) for distance in (-0.2, -0.15, 0.0)]  # rad
    [0.0, 0.5, 1.0]
    """

    ramp: Q[Float[Array, ""], "1"] = eqx.field(converter=real)

    def opening(self, distance: Angle, width: Width) -> Q[Float[Array, "*grid"], "1"]:
        return _uncovered(distance, width, self.ramp)

    def edges(self, width: Width) -> Q[Float[Array, " edge"], "rad"]:
        return _shoulders(width, self.ramp)

    def opens_to(self, share: Q[Float[Array, ""], "1"], width: Width) -> Q[Float[Array, ""], "rad"]:
        return (share * self.ramp - 1) * width / 2


class RoundWindow(AbstractWindow):
    """A round port that slides over a slot with ends of the same radius: exact lens area.

    `alpha = 2/pi (acos(1-u) - (1-u) sqrt(1-(1-u)^2))` with `u` the overlapping
    length over the port's diameter, `u = clip((D/2 - |d|) / (ramp D/2), 0, 1)`:
    the ramp is the port's diameter over half the window's width. docs/theory.md
    section 13; two equal circles whose centres stand `1 - u` diameters apart.

    Examples
    --------
    >>> window = camring.RoundWindow(ramp=0.5)
    >>> [round(float(window.opening(distance, 0.4)), 3) for distance in (-0.2, -0.15, 0.0)]
    [0.0, 0.391, 1.0]
    """

    ramp: Q[Float[Array, ""], "1"] = eqx.field(converter=real)

    def opening(self, distance: Angle, width: Width) -> Q[Float[Array, "*grid"], "1"]:
        return lens_share(_uncovered(distance, width, self.ramp))

    def edges(self, width: Width) -> Q[Float[Array, " edge"], "rad"]:
        return _shoulders(width, self.ramp)

    def opens_to(self, share: Q[Float[Array, ""], "1"], width: Width) -> Q[Float[Array, ""], "rad"]:
        return (lens_overlap(share) * self.ramp - 1) * width / 2


class TabulatedWindow(AbstractWindow):
    """An opening read off a drawing: straight lines between given points.

    Positions are distances from the centre over half the window's width,
    ascending from -1 to 1, so the same table serves both ports and the width
    stays a design variable; the opening is zero outside them.

    Examples
    --------
    >>> window = camring.TabulatedWindow([-1.0, -0.5, 0.5, 1.0], [0.0, 1.0, 1.0, 0.0])
    >>> [round(float(window.opening(distance, 0.4)), 3) for distance in (-0.2, -0.15, 0.0)]
    [0.0, 0.5, 1.0]
    """

    position: Q[Float[Array, " knot"], "1"] = eqx.field(converter=real)
    opening_share: Q[Float[Array, " knot"], "1"] = eqx.field(converter=real)

    def opening(self, distance: Angle, width: Width) -> Q[Float[Array, "*grid"], "1"]:
        place = distance / (width / 2)
        return jnp.interp(place, self.position, self.opening_share, left=0.0, right=0.0)

    def edges(self, width: Width) -> Q[Float[Array, " edge"], "rad"]:
        return self.position * width / 2

    def opens_to(self, share: Q[Float[Array, ""], "1"], width: Width) -> Q[Float[Array, ""], "rad"]:
        before, after = self.opening_share[:-1], self.opening_share[1:]
        rise = after - before
        part = jnp.where(rise > 0, (share - before) / jnp.where(rise > 0, rise, 1.0), 0.0)
        crossing = self.position[:-1] + part * jnp.diff(self.position)
        reached = (before <= share) & (share <= after) & (rise > 0) & (crossing <= 0)
        return smallest(jnp.where(reached, crossing, 0.0)) * width / 2


def _uncovered(distance: Angle, width: Width, ramp: Array) -> Q[Float[Array, "*grid"], "1"]:
    """Share of a ramp that the port has come past the window's nearer edge, in [0, 1]."""
    half = width / 2
    return bounded((half - jnp.abs(distance)) / (ramp * half), 0, 1)


def _shoulders(width: Width, ramp: Array) -> Q[Float[Array, " edge"], "rad"]:
    half = width / 2
    shoulder = half * (1 - ramp)
    return jnp.stack([-half, -shoulder, shoulder, half])


@jax.custom_jvp
def lens_share(overlap: Q[Float[Array, "*grid"], "1"]) -> Q[Float[Array, "*grid"], "1"]:
    """Area common to two equal circles over that of one; `overlap` over a diameter, in [0, 1]."""
    half_angle = 2 * jnp.arcsin(jnp.sqrt(overlap / 2))
    return smaller((2 * half_angle - jnp.sin(2 * half_angle)) / pi, 1.0)


@lens_share.defjvp
def _lens_share_slope(primals: tuple[Any, ...], tangents: tuple[Any, ...]) -> tuple[Array, Array]:
    # The formula's own derivative is 0 times infinity where the circles touch.
    (overlap,), (rate,) = primals, tangents
    return lens_share(overlap), 4 / pi * jnp.sqrt(overlap * (2 - overlap)) * rate


def lens_overlap(share: Q[Float[Array, ""], "1"]) -> Q[Float[Array, ""], "1"]:
    """The overlap at which a lens has this share of a circle: inverse of `lens_share`.

    Newton on the central angle, whose equation `t - sin t = pi share` is
    Kepler's with eccentricity one; `share` within [0, 1].
    """
    mean = pi * bounded(share, 0.0, 1.0)
    angle = smaller(jnp.cbrt(6 * mean), pi)
    for _ in range(12):
        slope = 1 - jnp.cos(angle)
        safe = jnp.where(slope > 0, slope, 1.0)
        angle = bounded(angle - (angle - jnp.sin(angle) - mean) / safe, 0.0, pi)
    return 1 - jnp.cos(angle / 2)

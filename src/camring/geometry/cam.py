"""The pitch curve: the path of the roller centre round the shaft.

A cam answers one question, the pitch radius at a shaft angle with its exact
derivatives, and says where its polynomial pieces meet. Two final classes: a
spline for the radius itself and a planar spline curve whose radius is found
at a polar angle (docs/theory.md section 2).
"""

from abc import abstractmethod
from math import pi

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from camring.numerics.compilation import one_program
from camring.numerics.quantity import Q, real
from camring.numerics.selection import smallest
from camring.numerics.spline import (
    Jet,
    evaluate_periodic,
    evaluate_span,
    floor_past_rounding,
    knots,
)


class AbstractCam(eqx.Module):
    """A closed pitch curve that repeats a whole number of times a revolution."""

    repeats: eqx.AbstractVar[int]
    degree: eqx.AbstractVar[int]

    @property
    def period(self) -> float:
        """Angle after which the curve repeats, rad."""
        return 2 * pi / self.repeats

    @property
    @abstractmethod
    def control_count(self) -> int:
        """Number of control values in one period."""

    @abstractmethod
    def breakpoints(self) -> Q[Float[Array, " control"], "rad"]:
        """Angles in [0, period] where the polynomial pieces meet, ascending."""

    @abstractmethod
    def mean_radius(self) -> Q[Float[Array, ""], "m"]:
        """Mean of the pitch radius over angle."""

    @abstractmethod
    def pitch_radius(self, angle: Q[Float[Array, "*grid"], "rad"]) -> Jet:
        """Pitch radius and its derivatives, m, m/rad, m/rad2, m/rad3."""

    @abstractmethod
    def pitch_radius_between(
        self,
        start: Q[Float[Array, " element"], "rad"],
        width: Q[Float[Array, " element"], "rad"],
        fraction: Float[Array, " point"],
    ) -> Jet:
        """The same on elements no breakpoint divides, shape (point, element).

        At an element's end the derivatives are those from inside it, so a jump
        of jerk at a knot is seen from both sides.
        """


class RadialCam(AbstractCam):
    """A periodic B-spline for the radius: `r = sum_j c_j B((angle - j h)/h)`.

    Control value `j` of `n` acts at the angle `j` times `h`, the period over `n`; it is no
    radius of the curve itself. Degree 3, 4 or 5. docs/theory.md section 2.

    Examples
    --------
    >>> from math import pi
    >>> cam = camring.RadialCam([0.18, 0.19, 0.20, 0.19], repeats=6)  # m, one of 6 lobes
    >>> radius = cam.pitch_radius(pi / 24)
    >>> round(float(radius.value), 6), round(float(radius.first), 6)  # m, m/rad
    (0.185417, 0.028648)
    """

    control_radii: Q[Float[Array, " control"], "m"] = eqx.field(converter=real)
    repeats: int = eqx.field(static=True, kw_only=True)
    degree: int = eqx.field(static=True, default=3, kw_only=True)

    @property
    def control_count(self) -> int:
        return self.control_radii.shape[-1]

    @one_program
    def breakpoints(self) -> Q[Float[Array, " control"], "rad"]:
        return jnp.asarray(knots(self.control_count, self.period, self.degree))

    @one_program
    def mean_radius(self) -> Q[Float[Array, ""], "m"]:
        # Every basis function has the same integral.
        return jnp.mean(self.control_radii)

    @one_program
    def pitch_radius(self, angle: Q[Float[Array, "*grid"], "rad"]) -> Jet:
        return evaluate_periodic(self.control_radii, angle, self.period, self.degree)

    @one_program
    def pitch_radius_between(
        self,
        start: Q[Float[Array, " element"], "rad"],
        width: Q[Float[Array, " element"], "rad"],
        fraction: Float[Array, " point"],
    ) -> Jet:
        spacing = self.period / self.control_count
        offset = (self.degree + 1) / 2
        span = floor_past_rounding((start + width / 2) / spacing + offset)
        within = start / spacing + offset - span + fraction[:, None] * (width / spacing)
        return evaluate_span(
            self.control_radii, span.astype(jnp.int32), within, spacing, self.degree
        )


class PlanarCam(AbstractCam):
    """A planar B-spline curve; the radius is read at a polar angle.

    The control points of one period are given, the others follow by rotation.
    Holds while the curve is star-shaped about the shaft (`x y' - y x' > 0`),
    which `least_turning` measures. docs/theory.md section 2.

    Examples
    --------
    Points on a circle, 4 for each of 6 lobes, are nearly a circle:

    >>> import numpy as np
    >>> turned = np.arange(4) * 2 * np.pi / 24
    >>> points = 0.2 * np.stack([np.cos(turned), np.sin(turned)], axis=1)  # m, shape (4, 2)
    >>> cam = camring.PlanarCam(points, repeats=6)
    >>> round(float(cam.pitch_radius(0.1).value), 4), float(cam.least_turning()) > 0
    (0.1977, True)
    """

    control_points: Q[Float[Array, "control 2"], "m"] = eqx.field(converter=real)
    repeats: int = eqx.field(static=True, kw_only=True)
    degree: int = eqx.field(static=True, default=3, kw_only=True)

    @property
    def control_count(self) -> int:
        return self.control_points.shape[-2]

    def _curve(self, parameter: Float[Array, "*grid"]) -> Jet:
        """The curve as a complex number, against a parameter that turns with it."""
        points = self.control_points[..., 0] + 1j * self.control_points[..., 1]
        turns = jnp.exp(1j * self.period * jnp.arange(self.repeats))
        ring = (turns[:, None] * points).reshape(-1)
        return evaluate_periodic(ring, parameter, 2 * pi, self.degree)

    def _polar_angle(self, parameter: Float[Array, "*grid"], point: Array) -> Array:
        """Polar angle of a curve point, on the branch that follows the parameter."""
        return parameter + jnp.angle(point * jnp.exp(-1j * parameter))

    @one_program
    def least_turning(self) -> Q[Float[Array, ""], "1"]:
        """Smallest rate of polar angle against the curve parameter; negative: not star-shaped."""
        parameter = self.period * jnp.arange(16 * self.control_count) / (16 * self.control_count)
        curve = self._curve(parameter)
        return smallest(jnp.imag(curve.first / curve.value))

    @one_program
    def breakpoints(self) -> Q[Float[Array, " control"], "rad"]:
        parameter = jnp.asarray(knots(self.control_count, self.period, self.degree))
        polar = self._polar_angle(parameter, self._curve(parameter).value)
        return jnp.sort(polar % self.period)

    @one_program
    def mean_radius(self) -> Q[Float[Array, ""], "m"]:
        # Gauss-Legendre between the breakpoints, where the radius is analytic.
        corners = self.breakpoints()
        width = jnp.diff(corners, append=corners[:1] + self.period)
        points, weights = np.polynomial.legendre.leggauss(12)
        radius = self.pitch_radius(corners[:, None] + width[:, None] * (points + 1) / 2)
        return jnp.sum(width[:, None] * weights / 2 * radius.value) / self.period

    def _parameter_at(self, angle: Float[Array, "*grid"]) -> Float[Array, "*grid"]:
        """Solve polar angle = angle by Newton, from a table of one period."""
        count = 8 * self.control_count
        table = self.period * (jnp.arange(count + 1) / count)
        polar = self._polar_angle(table, self._curve(table).value)
        turns = floor_past_rounding((angle - polar[0]) / self.period) * self.period
        parameter = jnp.interp(angle - turns, polar, table) + turns

        def newton(guess: Array, _: None) -> tuple[Array, None]:
            curve = self._curve(guess)
            lag = self._polar_angle(guess, curve.value) - angle
            return guess - lag / jnp.imag(curve.first / curve.value), None

        parameter, _ = jax.lax.scan(newton, jax.lax.stop_gradient(parameter), None, length=5)
        # One more step from a constant carries the implicit derivative exactly.
        return newton(jax.lax.stop_gradient(parameter), None)[0]

    @one_program
    def pitch_radius(self, angle: Q[Float[Array, "*grid"], "rad"]) -> Jet:
        return self._radius_at(self._parameter_at(angle))

    def _radius_at(self, parameter: Float[Array, "*grid"]) -> Jet:
        """Chain rule from curve parameter to polar angle.

        # notation: log of the curve is log r + i psi; a + i b its derivatives
        """
        curve = self._curve(parameter)
        rate = curve.first / curve.value
        bend = curve.second / curve.value - rate**2
        twist = curve.third / curve.value - curve.second / curve.value * rate - 2 * rate * bend
        a, b = rate.real, rate.imag
        numerator = bend.real * b - a * bend.imag
        first = a / b
        second = numerator / b**3
        third = (twist.real * b - a * twist.imag) / b**4 - 3 * numerator * bend.imag / b**5
        radius = jnp.abs(curve.value)
        return Jet(
            radius,
            radius * first,
            radius * (second + first**2),
            radius * (third + 3 * first * second + first**3),
        )

    @one_program
    def pitch_radius_between(
        self,
        start: Q[Float[Array, " element"], "rad"],
        width: Q[Float[Array, " element"], "rad"],
        fraction: Float[Array, " point"],
    ) -> Jet:
        # A hair inside the element, so that a knot's derivatives come from this side.
        inside = 1e-9 + (1 - 2e-9) * fraction
        return self.pitch_radius(start + inside[:, None] * width)

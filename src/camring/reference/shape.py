"""The pitch curve in the second solver: SciPy splines, read at a polar angle."""

from dataclasses import dataclass
from itertools import pairwise
from math import ceil, pi

import numpy as np
from numpy.polynomial import chebyshev
from numpy.polynomial.polynomial import polyroots
from scipy.interpolate import BSpline, PPoly

from camring.reference.machine import Machine

Jet = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


class NotStarShapedError(ValueError):
    """The planar pitch curve turns back as seen from the shaft."""


@dataclass(frozen=True)
class Piece:
    """The radius as a polynomial of `(angle - origin) * scale` between two kinks."""

    start: float
    end: float
    origin: float
    scale: float
    coefficients: tuple[float, ...]  # lowest power first


def _spans(control: np.ndarray, spacing: float, degree: int) -> PPoly:
    """One turn of a uniform periodic B-spline as polynomials, control value j acting at j h.

    Degrees 3 and 5 have their knots at the control values' angles, degree 4
    between them; the first span starts at 0 or at h/2.
    """
    count = len(control)
    padded = np.arange(-degree, count + degree + 1)
    first = padded[0] - (degree + 1) / 2
    knots = spacing * (first + np.arange(len(padded) + degree + 1))
    whole = PPoly.from_spline(BSpline(knots, control[padded % count].real, degree))
    powers = whole.c
    if np.iscomplexobj(control):
        imaginary = PPoly.from_spline(BSpline(knots, control[padded % count].imag, degree))
        powers = powers + 1j * imaginary.c
    offset = 0.0 if degree % 2 else spacing / 2
    start = round((offset - whole.x[0]) / spacing)
    return PPoly(
        powers[:, start : start + count], offset + spacing * np.arange(count + 1), extrapolate=True
    )


class PitchCurve:
    """Radius of the roller centre's path with derivatives; exact to rounding."""

    def __init__(self, machine: Machine) -> None:
        self.period = machine.period
        self.degree = machine.degree
        self.planar = np.iscomplexobj(machine.control)
        if self.planar:
            turns = np.exp(1j * self.period * np.arange(machine.repeats))
            ring = (turns[:, None] * machine.control).reshape(-1)
            self._spline = _spans(ring, 2 * pi / len(ring), self.degree)
            self._span_count = len(machine.control)
        else:
            self._spline = _spans(
                np.asarray(machine.control, float), self.period / len(machine.control), self.degree
            )
            self._span_count = len(machine.control)
        self._derivatives = [self._spline.derivative(k) if k else self._spline for k in range(4)]
        breaks = self._spline.x
        if self.planar:
            self._require_star_shape()
            value = self._spline(breaks)
            polar = np.unwrap(np.angle(value))
            self._polar = polar + 2 * pi * np.round((breaks[0] - polar[0]) / (2 * pi))
            kinks = self._polar[: self._span_count + 1]
            self._table_parameter = np.linspace(
                breaks[0], breaks[self._span_count], 64 * self._span_count + 1
            )
            table = np.unwrap(np.angle(self._spline(self._table_parameter)))
            self._table_polar = table + self._polar[0] - table[0]
        else:
            kinks = breaks
        self._first, self._kinks = float(kinks[0]), np.asarray(kinks, float)
        self.knots = self._kinks[:-1]

    def _require_star_shape(self) -> None:
        at = self._spline.x[:-1, None] + np.diff(self._spline.x)[:, None] * np.linspace(0, 1, 33)
        point, slope = self._derivatives[0](at), self._derivatives[1](at)
        if np.min((np.conj(point) * slope).imag) <= 0:
            raise NotStarShapedError("the planar pitch curve is not star-shaped about the shaft")

    def _reduced(self, angle: np.ndarray) -> np.ndarray:
        return self._first + np.mod(np.asarray(angle, float) - self._first, self.period)

    def _parameter(self, angle: np.ndarray, span: np.ndarray) -> np.ndarray:
        """Curve parameter at a polar angle within a numbered knot span: a table, then Newton."""
        parameter = np.interp(angle, self._table_polar, self._table_parameter)
        for _ in range(4):
            value, slope = self._at(parameter, span, 0), self._at(parameter, span, 1)
            behind = np.angle(value * np.exp(-1j * angle))
            parameter = parameter - behind / (slope / value).imag
        return parameter

    def _at(self, parameter: np.ndarray, span: np.ndarray, order: int) -> np.ndarray:
        """Derivative of the spline from the polynomial of one numbered span."""
        piece = self._derivatives[order]
        within = parameter - self._spline.x[span]
        total = np.zeros(np.shape(parameter), dtype=piece.c.dtype)
        for row in piece.c:
            total = total * within + row[span]
        return total

    def jet(self, angle: np.ndarray, inside: np.ndarray | None = None) -> Jet:
        """Radius and three derivatives.

        `inside` names the side of a knot: an angle of the span to read from.
        """
        angle = np.asarray(angle, float)
        home = self._reduced(angle if inside is None else inside)
        reduced = angle - self.period * np.round((angle - home) / self.period)
        span = np.clip(
            np.searchsorted(self._kinks, home, side="right") - 1, 0, self._span_count - 1
        )
        if not self.planar:
            return tuple(self._at(reduced, span, order) for order in range(4))  # type: ignore[return-value]
        parameter = self._parameter(reduced, span)
        x, y = ([self._at(parameter, span, k) for k in range(4)] for _ in range(2))
        return _polar_jet([z.real for z in x], [z.imag for z in y])

    def pieces(self) -> list[Piece]:
        """Polynomials covering one period, none crossing a knot; planar ones fitted to rounding."""
        found = []
        for start, end in pairwise(self._kinks):
            parts = ceil((end - start) / (self.period / self._span_count) * 3) if self.planar else 1
            edges = np.linspace(start, end, parts + 1)
            for a, b in pairwise(edges):
                found.append(self._piece(float(a), float(b)))
        return found

    def _piece(self, start: float, end: float) -> Piece:
        middle, half = (start + end) / 2, (end - start) / 2
        if not self.planar:
            index = int(np.searchsorted(self._kinks, middle, side="right")) - 1
            powers = self._spline.c[::-1, index]
            return Piece(start, end, float(self._kinks[index]), 1.0, tuple(map(float, powers)))
        nodes = np.cos(pi * (np.arange(17) + 0.5) / 17)
        radius = self.jet(middle + half * nodes)[0]
        fit = chebyshev.chebfit(nodes, radius, 16)
        powers = chebyshev.cheb2poly(np.where(np.abs(fit) < 1e-17 * abs(fit[0]), 0.0, fit))
        return Piece(start, end, middle, 1 / half, tuple(map(float, np.trim_zeros(powers, "b"))))

    def turning_points(self) -> np.ndarray:
        """Angles in one period where the radius turns, ascending; none for a round cam."""
        found: list[float] = []
        for piece in self.pieces():
            slope = np.polynomial.polynomial.polyder(np.asarray(piece.coefficients))
            slope = np.trim_zeros(slope, "b")
            if len(slope) < 2:
                continue
            roots = polyroots(slope)
            real = roots.real[np.abs(roots.imag) < 1e-7] / piece.scale + piece.origin
            slack = 1e-9 * (piece.end - piece.start)
            found += [float(x) for x in real if piece.start - slack <= x <= piece.end + slack]
        return np.unique(np.round(found, 15))


def _polar_jet(x: list[np.ndarray], y: list[np.ndarray]) -> Jet:
    """Radius against polar angle from a curve's Cartesian derivatives.

    # notation: u = r^2 and m = x y' - y x' (so psi' = m/u); dots along the curve
    """
    u = x[0] ** 2 + y[0] ** 2
    u1 = 2 * (x[0] * x[1] + y[0] * y[1])
    u2 = 2 * (x[1] ** 2 + y[1] ** 2 + x[0] * x[2] + y[0] * y[2])
    u3 = 2 * (3 * (x[1] * x[2] + y[1] * y[2]) + x[0] * x[3] + y[0] * y[3])
    m = x[0] * y[1] - y[0] * x[1]
    m1 = x[0] * y[2] - y[0] * x[2]
    m2 = x[1] * y[2] - y[1] * x[2] + x[0] * y[3] - y[0] * x[3]
    r = np.sqrt(u)
    r1 = u1 / (2 * r)
    r2 = (u2 / 2 - r1**2) / r
    r3 = (u3 / 2 - 3 * r1 * r2) / r
    p1 = m / u
    p2 = (m1 - p1 * u1) / u
    p3 = (m2 - 2 * p2 * u1 - p1 * u2) / u
    first = r1 / p1
    second = (r2 - first * p2) / p1**2
    third = (r3 - first * p3 - 3 * second * p1 * p2) / p1**3
    return r, first, second, third

"""The pitch curve and its parallels as plane curves, for those who cut metal by them.

Points of the plane are complex numbers in metres, x to the right and y up; the
curve runs anticlockwise round the shaft. Computed with the spline's own
polynomials in NumPy: nothing here is differentiated by, or waits for, a
compiler. docs/theory.md section 2.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import factorial, pi
from typing import NamedTuple

import numpy as np

from camring.geometry.cam import AbstractCam, PlanarCam, RadialCam
from camring.geometry.sampling import full_ring
from camring.numerics.closed_spline import ClosedSpline, fit_closed
from camring.numerics.spline import basis_matrix, knots

__all__ = ["Outline", "Places", "Undercut", "outline_of"]

_NEWTON_STEPS = 8
_PER_SPAN = 64


class Places(NamedTuple):
    """Places on a curve."""

    point: np.ndarray  # complex, m
    normal: np.ndarray  # complex of size one, away from the shaft
    curvature: np.ndarray  # 1/m, positive where the curve bends round the shaft
    speed: np.ndarray  # m for each rad of the curve's parameter


class Undercut(NamedTuple):
    """Where a parallel curve comes nearest to a cusp."""

    factor: float  # 1 + curvature * distance, smallest round the ring
    angle: float  # polar angle of that place on the pitch curve, rad in [0, 2 pi)


@dataclass(frozen=True, eq=False)
class Outline:
    """A closed pitch curve with exact derivatives.

    Attributes
    ----------
    control
        Radii of one period (m), or points of the whole ring (complex, m).
    repeats
        Periods of the radii in a revolution.
    """

    control: np.ndarray
    repeats: int
    degree: int

    @property
    def is_radial(self) -> bool:
        return not np.iscomplexobj(self.control)

    @property
    def _period(self) -> float:
        return 2 * pi / self.repeats if self.is_radial else 2 * pi

    @cached_property
    def _powers(self) -> np.ndarray:
        """Polynomial coefficients of every span, lowest power first."""
        shifted = np.stack([np.roll(self.control, k) for k in range(self.degree + 1)], axis=1)
        return shifted @ basis_matrix(self.degree)

    def _spline(self, parameter: np.ndarray) -> list[np.ndarray]:
        """The spline and two derivatives."""
        spacing = self._period / len(self.control)
        position = parameter / spacing + (self.degree + 1) / 2
        span = np.floor(position + 1e-9)
        within = position - span
        powers = self._powers[span.astype(int) % len(self.control)]
        found = []
        for order in range(3):
            total = np.zeros(np.shape(parameter), self.control.dtype)
            for power in range(self.degree, order - 1, -1):
                falling = factorial(power) // factorial(power - order)
                total = total * within + falling * powers[..., power]
            found.append(total / spacing**order)
        return found

    def _curve(self, parameter: np.ndarray) -> list[np.ndarray]:
        """The curve as complex numbers, and two derivatives by its parameter."""
        value, first, second = self._spline(parameter)
        if not self.is_radial:
            return [value, first, second]
        turn = np.exp(1j * parameter)
        return [
            value * turn,
            (first + 1j * value) * turn,
            (second + 2j * first - value) * turn,
        ]

    def corners(self) -> np.ndarray:
        """Parameters of one turn where polynomial pieces meet, from 0 to 2 pi with both."""
        count = len(self.control)
        once = knots(count, self._period, self.degree)
        turns = self._period * np.arange(round(2 * pi / self._period))
        around = (turns[:, None] + once).reshape(-1)
        inner = around[(around > 1e-9) & (around < 2 * pi - 1e-9)]
        return np.concatenate([[0.0], inner, [2 * pi]])

    def places(self, parameter: np.ndarray, distance: float = 0.0) -> Places:
        """Places on the curve that runs `distance` (m) outside the pitch curve.

        Exact: the parallel curve shares its normals, and its curvature is
        `curvature / (1 + curvature * distance)`.
        """
        point, first, second = self._curve(np.asarray(parameter, float))
        speed = np.abs(first)
        normal = -1j * first / speed
        curvature = np.imag(np.conj(first) * second) / speed**3
        factor = 1 + curvature * distance
        return Places(point + distance * normal, normal, curvature / factor, speed * factor)

    def parameter_at(self, angle: np.ndarray) -> np.ndarray:
        """Parameters of the pitch curve at polar angles, rad."""
        angle = np.asarray(angle, float)
        if self.is_radial:
            return angle
        table = np.linspace(0, 2 * pi, 16 * len(self.control) + 1)
        point = self._curve(table)[0]
        polar = table + np.angle(point * np.exp(-1j * table))
        turns = np.floor((angle - polar[0]) / (2 * pi)) * 2 * pi
        parameter = np.interp(angle - turns, polar, table) + turns
        for _ in range(_NEWTON_STEPS):
            value, first, _ = self._curve(parameter)
            lag = np.angle(value * np.exp(-1j * angle))
            parameter = parameter - lag / np.imag(first / value)
        return parameter

    def foot(self, point: np.ndarray, near: np.ndarray) -> np.ndarray:
        """Parameters of the pitch curve whose normals pass through points.

        Found by Newton from the parameters `near`; unique where no undercut is.
        """
        parameter = np.array(near, float)
        for _ in range(_NEWTON_STEPS):
            foot, first, second = self._curve(parameter)
            away = foot - point
            slope = np.abs(first) ** 2 + np.real(np.conj(second) * away)
            parameter = parameter - np.real(np.conj(first) * away) / slope
        return parameter

    def stray(self, point: np.ndarray, near: np.ndarray, distance: float = 0.0) -> np.ndarray:
        """How far points lie outside the curve at `distance`, m, along the exact normal."""
        foot, first, _ = self._curve(self.foot(point, near))
        return np.real(np.conj(-1j * first) * (point - foot)) / np.abs(first) - distance

    def undercut(self, distance: float) -> Undercut:
        """The smallest undercut factor of the curve at `distance` (m), and where it is."""
        parameter, factor = self._least(lambda at: self._undercut_factor(at, distance))
        return Undercut(factor, self._polar(parameter))

    def extreme_radius(self, sign: int) -> tuple[float, float]:
        """Smallest (`sign = -1`) or largest (1) pitch radius, m, and its polar angle, rad.

        The parallel curves have theirs at the same angles, longer by their distance.
        """
        parameter, radius = self._least(lambda at: -sign * np.abs(self._curve(at)[0]))
        return abs(radius), self._polar(parameter)

    def sharpest(self, distance: float) -> tuple[float, float]:
        """Least and greatest curvature of the curve at `distance` (m), 1/m.

        The first is negative where the curve bulges towards the shaft; a wheel
        that grinds it from inside must be smaller than one over the second.
        """
        low = self._least(lambda at: self.places(at, distance).curvature)[1]
        high = self._least(lambda at: -self.places(at, distance).curvature)[1]
        return low, -high

    def _undercut_factor(self, parameter: np.ndarray, distance: float) -> np.ndarray:
        _, first, second = self._curve(parameter)
        return 1 + distance * np.imag(np.conj(first) * second) / np.abs(first) ** 3

    def _polar(self, parameter: float) -> float:
        angle = float(np.angle(self._curve(np.asarray(parameter))[0]))
        # A hair below zero is zero, not a whole turn.
        return 0.0 if abs(angle) < 1e-9 else angle % (2 * pi)

    def _least(self, function: Callable[[np.ndarray], np.ndarray]) -> tuple[float, float]:
        """Parameter and value of the smallest value round the ring."""
        from scipy.optimize import minimize_scalar  # see `closed_spline`

        corners = self.corners()
        step = np.diff(corners)[:, None] / _PER_SPAN
        grid = np.append((corners[:-1, None] + step * np.arange(_PER_SPAN)).reshape(-1), 2 * pi)
        sampled = function(grid)
        # The first of equals, whatever rounding says, so that the first lobe is named.
        at = int(np.argmax(sampled <= sampled.min() + 1e-9 * np.abs(sampled).max()))
        span = (grid[max(at - 1, 0)], grid[min(at + 1, len(grid) - 1)])
        settled = minimize_scalar(
            lambda place: float(function(np.asarray(place))),
            bounds=span,
            method="bounded",
            options={"xatol": 1e-12},
        )
        if settled.fun < sampled[at]:
            return float(settled.x), float(settled.fun)
        return float(grid[at]), float(sampled[at])

    def cuts_into_itself(self, distance: float) -> float:
        """How deep the circle of radius `distance` round a place cuts the parallel elsewhere, m.

        Zero where the parallel curve is clear all round; an undercut factor
        above zero says so only of each place's neighbours.
        """
        from scipy.spatial import cKDTree

        step = np.arange(16) / 16
        corners = self.corners()
        fine = (corners[:-1, None] + np.diff(corners)[:, None] * step).reshape(-1)
        pitch = self.places(fine).point
        parallel = self.places(fine, distance).point
        tree = cKDTree(np.stack([pitch.real, pitch.imag], axis=1))
        nearest, _ = tree.query(np.stack([parallel.real, parallel.imag], axis=1))
        depth = distance - float(nearest.min())
        return depth if depth > 1e-9 * distance else 0.0

    def fit(self, distance: float, tolerance: float) -> ClosedSpline:
        """One closed cubic spline within `tolerance` (m) of the curve at `distance` (m).

        Raises
        ------
        FitError
            When the curve is too sharp for it; see `undercut`.
        """

        def follow(parameter: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            found = self.places(parameter, distance)
            return found.point, found.speed

        def stray(point: np.ndarray, near: np.ndarray) -> np.ndarray:
            return self.stray(point, near, distance)

        return fit_closed(follow, stray, self.corners(), tolerance)


def outline_of(cam: AbstractCam) -> Outline:
    """The pitch curve of a cam as a plane curve."""
    if isinstance(cam, RadialCam):
        return Outline(np.asarray(cam.control_radii), cam.repeats, cam.degree)
    if isinstance(cam, PlanarCam):
        return Outline(full_ring(np.asarray(cam.control_points), cam.repeats), 1, cam.degree)
    raise TypeError(f"no outline is known of a {type(cam).__name__}")

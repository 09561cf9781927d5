"""One closed cubic spline through a smooth closed plane curve, as near as is asked.

Points of the plane are complex numbers. Drawing programs and CAD kernels know
cubic splines; what they are to draw rarely is one. The spline passes through
places of the curve with two continuous derivatives all round, its parameter is
the curve's own arc length, and places are added where it strays.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:  # SciPy takes half a second, which whoever only simulates need not wait
    from scipy.interpolate import BSpline, CubicSpline

__all__ = ["ClosedSpline", "FitError", "fit_closed"]

_GAUSS = np.polynomial.legendre.leggauss(12)
_CHECKED_AT = (np.arange(8) + 0.5) / 8  # where a piece is looked at, as fractions of its length
_MOST_ROUNDS = 12
_MOST_PIECES = 20_000


class FitError(ValueError):
    """A curve that no spline of a sensible number of pieces follows as near as asked."""


@dataclass(frozen=True, eq=False)
class ClosedSpline:
    """A closed cubic spline and how far it strays.

    Attributes
    ----------
    arc
        Arc length at the places it passes through, ascending from 0; the last is the whole length.
    point
        Those places, complex, the last equal to the first.
    error
        Largest distance from the curve it stands for, looked at along that curve's normal.
    """

    arc: np.ndarray
    point: np.ndarray
    error: float

    @property
    def length(self) -> float:
        """Length of the curve it stands for."""
        return float(self.arc[-1])

    @property
    def pieces(self) -> int:
        return len(self.arc) - 1

    @cached_property
    def _cubic(self) -> "CubicSpline":
        from scipy.interpolate import CubicSpline

        flat = np.stack([self.point.real, self.point.imag], axis=1)
        flat[-1] = flat[0]
        return CubicSpline(self.arc, flat, bc_type="periodic")

    def at(self, arc: np.ndarray) -> np.ndarray:
        """Points at arc lengths, complex."""
        flat = self._cubic(arc)
        return flat[..., 0] + 1j * flat[..., 1]

    def clamped(self) -> "BSpline":
        """The same spline with the knots of a curve that begins and ends at its first point.

        That is the form which every reader of drawings understands.
        """
        from scipy.interpolate import make_interp_spline

        flat = np.stack([self.point.real, self.point.imag], axis=1)
        flat[-1] = flat[0]
        slope = [(1, self._cubic(0.0, 1))]
        return make_interp_spline(self.arc, flat, k=3, bc_type=(slope, slope))

    def bezier(self) -> np.ndarray:
        """Its pieces as Bezier curves, complex, shape (pieces, 4): exactly the same curve."""
        slope = self._cubic(self.arc, 1)
        third = (slope[:, 0] + 1j * slope[:, 1]) / 3
        step = np.diff(self.arc)
        start, end = self.point[:-1], np.append(self.point[1:-1], self.point[0])
        return np.stack([start, start + third[:-1] * step, end - third[1:] * step, end], axis=1)


def fit_closed(
    follow: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]],
    stray: Callable[[np.ndarray, np.ndarray], np.ndarray],
    corners: np.ndarray,
    tolerance: float,
) -> ClosedSpline:
    """The closed cubic spline that stays within a tolerance of a curve.

    Parameters
    ----------
    follow
        Point (complex) and speed of the curve at parameters.
    stray
        Signed distance of points from the curve along its normal, given parameters near by.
    corners
        Parameters where the curve is not smooth, ascending; the last is one turn after the first.

    Raises
    ------
    FitError
        When the curve is too sharp somewhere: 20,000 pieces did not suffice.
    """
    places = corners
    for _ in range(_MOST_ROUNDS):
        found, errors = _through(follow, stray, places)
        worst = errors.max(axis=1)
        poor = worst > tolerance
        if not poor.any():
            return found
        middles = (places[:-1] + places[1:])[poor] / 2
        places = np.sort(np.concatenate([places, middles]))
        if len(places) > _MOST_PIECES:
            break
    raise FitError(f"strays {worst.max():.3g} with {len(places) - 1} pieces")


def _through(
    follow: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]],
    stray: Callable[[np.ndarray, np.ndarray], np.ndarray],
    places: np.ndarray,
) -> tuple[ClosedSpline, np.ndarray]:
    """The spline through these places, and its distances from the curve between them."""
    width = np.diff(places)
    inside = places[:-1, None] + width[:, None] * (_GAUSS[0] + 1) / 2
    lengths = width * (follow(inside)[1] @ _GAUSS[1]) / 2
    arc = np.concatenate([[0.0], np.cumsum(lengths)])
    point = follow(places)[0]
    point[-1] = point[0]
    bare = ClosedSpline(arc, point, 0.0)
    looked = bare.at(arc[:-1, None] + lengths[:, None] * _CHECKED_AT)
    errors = np.abs(stray(looked, places[:-1, None] + width[:, None] * _CHECKED_AT))
    return ClosedSpline(arc, point, float(errors.max())), errors

"""Control radii whose spline passes as near as it can to given points of a ring.

Points lie on the pitch curve, or on a curve a given distance outside it such as
the working surface. Their distances from the spline are measured along its
exact normal and made least by Gauss and Newton: a radius that changes by `d`
moves the parallel curve there by `d` times the cosine of the pressure angle
(Ahn, *Least Squares Orthogonal Distance Fitting*, 2004). NumPy only; nothing
is differentiated by a compiler.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import Any

import numpy as np
from jaxtyping import Complex, Float

from camring.geometry.outline import Outline
from camring.numerics.spline import basis_matrix

__all__ = ["RadiiFit", "fit_radii", "fit_radii_to_noise"]

_STEPS = 12
_SETTLED = 1e-11  # m
SUFFICIENT = 1e-7  # m; no machine grinds or measures below it
_NO_WORSE = 1.1  # of the least cross-validated variance

Points = Complex[np.ndarray, " point"]


@dataclass(frozen=True, eq=False)
class RadiiFit:
    """Control radii and how far the points lie from their spline.

    Attributes
    ----------
    control_radii
        Of one period, m.
    residuals
        Distance of each point outside the fitted curve along its normal, m.
    angles
        Polar angle of the foot of each normal on the pitch curve, rad.
    distance
        The points' curve lies this far outside the pitch curve, m.
    """

    control_radii: Float[np.ndarray, " control"]
    residuals: Float[np.ndarray, " point"]
    angles: Float[np.ndarray, " point"]
    repeats: int
    degree: int
    distance: float

    @property
    def largest(self) -> float:
        """Largest distance of a point from the curve, m."""
        return float(np.max(np.abs(self.residuals)))

    @property
    def rms(self) -> float:
        """Root mean square of the distances, m."""
        return float(np.sqrt(np.mean(self.residuals**2)))

    @property
    def outline(self) -> Outline:
        return Outline(self.control_radii, self.repeats, self.degree)

    @property
    def _variance(self) -> float:
        """Of what is left, cross-validated in general (Craven and Wahba 1979), m^2."""
        points, free = len(self.residuals), len(self.control_radii)
        return float(np.mean(self.residuals**2) / (1 - free / points) ** 2)


def fit_radii(
    points: Points, count: int, repeats: int, degree: int = 3, distance: float = 0.0
) -> RadiiFit:
    """The control radii whose curve has the least squares of distances from the points.

    Parameters
    ----------
    points
        Complex, m, anywhere round the shaft; those of different periods are laid on one.
    count
        Control radii of one period; more points than these are needed in every stretch.
    distance
        How far outside the pitch curve the points lie, m.

    Raises
    ------
    LinAlgError
        When the points leave a control radius undetermined.
    """
    angle = np.angle(points)
    control = _solve(_basis(angle, count, repeats, degree), np.abs(points) - distance)
    for _ in range(_STEPS):
        outline = Outline(control, repeats, degree)
        residual, foot, slant = _distances(outline, points, angle, distance)
        change = _solve(_basis(foot, count, repeats, degree), residual, slant)
        control = control + change
        if np.max(np.abs(change)) < _SETTLED:
            break
    residual, foot, _ = _distances(Outline(control, repeats, degree), points, angle, distance)
    return RadiiFit(control, residual, foot % (2 * pi), repeats, degree, distance)


def fit_radii_to_noise(
    points: Points,
    counts: Sequence[int],
    repeats: int,
    degree: int = 3,
    distance: float = 0.0,
) -> RadiiFit:
    """The fit with as few control radii as the points ask for.

    The smallest of the ascending `counts` within 0.1 um of every point; where there is none,
    as in measured points, the smallest whose cross-validated variance is within a tenth of
    the least: more radii would follow the noise.
    """
    fits = []
    for count in counts:
        fit = fit_radii(points, count, repeats, degree, distance)
        if fit.largest <= SUFFICIENT:
            return fit
        fits.append(fit)
    least = min(fit._variance for fit in fits)
    return next(fit for fit in fits if fit._variance <= _NO_WORSE * least)


def _distances(
    outline: Outline, points: Points, near: Float[np.ndarray, " point"], distance: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Distances outside the curve, parameters of the feet, cosines of the pressure angle."""
    foot = outline.foot(points, near)
    place = outline.places(foot)
    residual = np.real(np.conj(place.normal) * (points - place.point)) - distance
    return residual, foot, np.real(np.conj(place.normal) * np.exp(1j * foot))


def _basis(angle: np.ndarray, count: int, repeats: int, degree: int) -> tuple[Any, ...]:
    """Columns and weights of the control radii at angles, shapes (point, degree + 1)."""
    spacing = 2 * pi / repeats / count
    position = angle / spacing + (degree + 1) / 2
    span = np.floor(position)
    powers = (position - span)[:, None] ** np.arange(degree + 1)
    columns = (span.astype(int)[:, None] - np.arange(degree + 1)) % count
    return columns, powers @ basis_matrix(degree).T, count


def _solve(
    basis: tuple[Any, ...], wanted: np.ndarray, scale: np.ndarray | float = 1.0
) -> np.ndarray:
    """Least squares by normal equations; cardinal splines keep them well conditioned."""
    columns, weights, count = basis
    weights = weights * np.asarray(scale)[..., None]
    normal = np.zeros((count, count))
    right = np.zeros(count)
    for one in range(weights.shape[1]):
        right += np.bincount(columns[:, one], weights[:, one] * wanted, count)
        for other in range(weights.shape[1]):
            place = columns[:, one] * count + columns[:, other]
            product = weights[:, one] * weights[:, other]
            normal += np.bincount(place, product, count * count).reshape(count, count)
    if np.min(np.diag(normal)) < 1e-6 * np.max(np.diag(normal)):
        raise np.linalg.LinAlgError("points leave a control radius undetermined")
    return np.linalg.solve(normal, right)

"""Numbers of a model fitted to measured values by weighted least squares on a box.

The model gives its values with their slopes. Where the standard deviations of what was
measured are not known, each group of values gets that of its own residuals, the same for
all its values or a share of each, whichever makes the residuals likelier; the fit is done
again with these weights until they settle. So torques of kilonewtonmetres and efficiencies
below one count by how well the model meets them.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.optimize import least_squares

from camring.search.confidence import Confidence, confidence

Point = Float[np.ndarray, " number"]
Values = Float[np.ndarray, " value"]
Model = Callable[[Point], tuple[Values, Float[np.ndarray, "value number"]]]
"""Values, not finite where the model has none, and their slopes."""

EXPECTED = 0.005
"""Standard deviation to begin with, of a group's own size."""
UNEVEN = 20.0
"""No group counts as so many times more exact than all together: a few values that can be
met exactly would take over."""
LEAST = 1e-7
"""Standard deviation of a group at least, of its size."""
NEAR_ZERO = 0.01
"""Of a group's size: with values below it, no deviation is a share of them."""
UNDECIDED = 4
"""Rounds in which a group may change from the one kind of deviation to the other."""
SETTLED = 0.01
ROUNDS = 12
AT_BOUND = 1e-3


@dataclass(frozen=True, eq=False)
class SquaresFit:
    """A fit.

    Attributes
    ----------
    point
        The numbers found.
    values
        The model there.
    deviation
        Standard deviation of each measured value: given or estimated.
    shares
        Groups whose deviations were found to be a share of each value.
    free
        Numbers that end inside the box; the others stand at a bound and have no interval.
    confidence
        Of the free numbers, in their order.
    settled
        Whether numbers and weights came to rest.
    evaluations
        Of the model.
    slopes
        Of the model's values there, by every number.
    """

    point: Point
    values: Values
    deviation: Values
    shares: frozenset[int]
    free: Bool[np.ndarray, " number"]
    confidence: Confidence
    settled: bool
    evaluations: int
    slopes: Float[np.ndarray, "value number"]


class _Remembered:
    """The model, asked once at each point."""

    def __init__(self, model: Model) -> None:
        self.model, self.count = model, 0
        self._here: tuple[bytes, tuple[Any, ...]] | None = None

    def __call__(self, point: Point) -> tuple[Any, ...]:
        if self._here is None or self._here[0] != point.tobytes():
            self._here = point.tobytes(), self.model(point)
            self.count += 1
        return self._here[1]


def fit_squares(
    model: Model,
    measured: Values,
    start: Point,
    lower: Point,
    upper: Point,
    *,
    group: Int[np.ndarray, " value"] | None = None,
    deviation: Values | None = None,
) -> SquaresFit:
    """Fit numbers to measured values; every coordinate of order one.

    Parameters
    ----------
    start
        Strictly inside the box.
    group
        Which values share a standard deviation where it is not known; all, unless given.
    deviation
        Known standard deviations; NaN where unknown.

    Raises
    ------
    ValueError
        Where values are not more than numbers, or the model has none at the start.
    """
    asked = _Remembered(model)
    group = np.zeros(len(measured), int) if group is None else group
    given = np.full(len(measured), np.nan) if deviation is None else deviation
    unknown = np.isnan(given)
    size = _sizes(measured, group)
    used = np.where(unknown, EXPECTED * size, given)
    point, free = np.array(start, dtype=float), np.ones(len(start), dtype=bool)
    settled, shares = False, frozenset[int]()
    for round_ in range(ROUNDS):
        point, rests = _solved(asked, measured, used, point, free, lower, upper)
        stuck = free & ((point - lower < AT_BOUND) | (upper - point < AT_BOUND))
        if np.any(stuck):
            point = np.where(stuck & (point - lower < AT_BOUND), lower, point)
            point = np.where(stuck & (upper - point < AT_BOUND), upper, point)
            free = free & ~stuck
            continue
        if not np.any(unknown):
            settled = rests
            break
        values, slopes = asked(point)
        rows = _Rows(measured, values - measured, slopes[:, free], group, unknown, size)
        if round_ < UNDECIDED:
            shares = rows.shares(used)
        renewed = rows.deviation(used, shares)
        change = np.max(np.abs(np.log(renewed / used)), initial=0.0)
        used = renewed
        if change < SETTLED:
            settled = rests
            break
    values, slopes = asked(point)
    sureness = confidence(
        (values - measured) / used,
        slopes[:, free] / used[:, None],
        known=~unknown,
    )
    return SquaresFit(point, values, used, shares, free, sureness, settled, asked.count, slopes)


def _sizes(measured: Values, group: Int[np.ndarray, " value"]) -> Values:
    found = np.ones(len(measured))
    for name in np.unique(group):
        here = group == name
        found[here] = np.sqrt(np.mean(measured[here] ** 2)) or 1.0
    return found


def _solved(
    model: _Remembered,
    measured: Values,
    deviation: Values,
    start: Point,
    free: Bool[np.ndarray, " number"],
    lower: Point,
    upper: Point,
) -> tuple[Point, bool]:
    """The best point, and whether the search came to rest there."""
    if not np.any(free):
        return start, True

    def whole(some: Point) -> Point:
        point = start.copy()
        point[free] = some
        return point

    found = least_squares(
        lambda some: (model(whole(some))[0] - measured) / deviation,
        start[free],
        jac=lambda some: model(whole(some))[1][:, free] / deviation[:, None],
        bounds=(lower[free], upper[free]),
        method="trf",
        xtol=1e-10,
        ftol=1e-12,
        gtol=1e-12,
        max_nfev=60,
    )
    return whole(found.x), found.status > 0


class _Rows(NamedTuple):
    """Measured values with what is left of them at a fit."""

    measured: Values
    residuals: Values
    slopes: Float[np.ndarray, "value number"]
    group: Int[np.ndarray, " value"]
    unknown: Bool[np.ndarray, " value"]
    size: Values

    def freedom(self, used: Values) -> Values:
        """What each residual keeps beside the numbers fitted; in all, values less numbers."""
        left, values, _ = np.linalg.svd(self.slopes / used[:, None], full_matrices=False)
        kept = values > 1e-9 * np.max(values, initial=0.0)
        return 1 - np.sum(left[:, kept] ** 2, axis=1)

    def shares(self, used: Values) -> frozenset[int]:
        """Groups whose residuals are likelier to be a share of each value than alike."""
        return frozenset(
            int(name)
            for name in np.unique(self.group[self.unknown])
            if self._is_share(self.unknown & (self.group == name), self.freedom(used))
        )

    def _is_share(self, here: Bool[np.ndarray, " value"], freedom: Values) -> bool:
        sizes = np.abs(self.measured[here])
        if np.min(sizes) < NEAR_ZERO * self.size[here][0] or np.sum(freedom[here]) < 1:
            return False
        left = self.residuals[here]
        if not np.any(left):
            return False
        # Logarithms of the mean squares, and of what the shares are taken of.
        alike = np.log(np.mean(left**2))
        share = np.log(np.mean((left / sizes) ** 2)) + 2 * np.mean(np.log(sizes))
        return bool(share < alike)

    def deviation(self, used: Values, shares: frozenset[int]) -> Values:
        """Each group's standard deviation from its residuals and the freedom they keep."""
        freedom = self.freedom(used)
        together = np.sqrt(np.sum((self.residuals / self.size) ** 2) / max(np.sum(freedom), 1.0))
        found = used.copy()
        for name in np.unique(self.group[self.unknown]):
            here = self.unknown & (self.group == name)
            of = np.abs(self.measured[here]) if name in shares else self.size[here]
            own = float(np.sum(freedom[here]))
            part = float(together)
            if own >= 1:
                part = float(np.sqrt(np.sum((self.residuals[here] / of) ** 2) / own))
            found[here] = max(part, together / UNEVEN, LEAST) * of
        return found

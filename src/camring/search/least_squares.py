"""Numbers of a model fitted to measured values by weighted least squares on a box.

The model gives its values with their slopes. Where the standard deviations of what was
measured are not known, each group of values gets that of its own residuals, and the fit
is done again with these weights until they settle: torques of kilonewtonmetres and
efficiencies below one then count by how well the model meets them.
"""

from collections.abc import Callable
from dataclasses import dataclass

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
    free
        Numbers that end inside the box; the others stand at a bound and have no interval.
    confidence
        Of the free numbers, in their order.
    settled
        Whether numbers and weights came to rest.
    evaluations
        Of the model.
    """

    point: Point
    values: Values
    deviation: Values
    free: Bool[np.ndarray, " number"]
    confidence: Confidence
    settled: bool
    evaluations: int


class _Remembered:
    """The model, asked once at each point."""

    def __init__(self, model: Model) -> None:
        self.model, self.count = model, 0
        self._here: tuple[bytes, tuple] | None = None

    def __call__(self, point: Point) -> tuple:
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
    settled = False
    for _ in range(ROUNDS):
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
        renewed = _estimated(values - measured, slopes[:, free], used, group, unknown, size)
        change = np.max(np.abs(np.log(renewed / used)), initial=0.0)
        used = renewed
        if change < SETTLED:
            settled = rests
            break
    values, slopes = asked(point)
    told = confidence(
        (values - measured) / used,
        slopes[:, free] / used[:, None],
        known=not np.any(unknown),
    )
    return SquaresFit(point, values, used, free, told, settled, asked.count)


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


def _estimated(
    residuals: Values,
    slopes: Float[np.ndarray, "value number"],
    used: Values,
    group: Int[np.ndarray, " value"],
    unknown: Bool[np.ndarray, " value"],
    size: Values,
) -> Values:
    """Each group's standard deviation from its residuals and the freedom they keep."""
    left, values, _ = np.linalg.svd(slopes / used[:, None], full_matrices=False)
    kept = values > 1e-9 * np.max(values, initial=0.0)
    leverage = np.sum(left[:, kept] ** 2, axis=1)
    freedom = max(len(residuals) - int(np.sum(kept)), 1)
    together = float(np.sqrt(np.sum((residuals / size) ** 2) / freedom))
    found = used.copy()
    for name in np.unique(group[unknown]):
        here = unknown & (group == name)
        own = float(np.sum(1 - leverage[here]))
        least = max(together / UNEVEN, LEAST)
        share = together
        if own >= 1:
            share = float(np.sqrt(np.sum((residuals[here] / size[here]) ** 2) / own))
        found[here] = max(share, least) * size[here]
    return found

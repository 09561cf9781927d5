"""Where to look next: the lowest confidence bound that the constraints allow.

``minimise mean - kappa deviation`` of the objective subject to ``mean + caution
deviation <= 0`` of every restriction. With Phi the normal distribution, a
caution z is a demand that each constraint hold with probability Phi(z):
negative is optimistic and explores, zero believes the mean, positive is safe.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.optimize import minimize

from camring.search.sampling import sobol
from camring.search.surrogate.surrogate import Surrogate

CANDIDATES = 256
CAUTION_ABOUT_FAILURE = 0.5
ELASTIC_WEIGHT = 100.0  # price of violating the worst constraint by one spread


@dataclass(frozen=True, eq=False)
class Region:
    """A box inside the unit box."""

    lower: Float[np.ndarray, " dimension"]
    upper: Float[np.ndarray, " dimension"]

    @staticmethod
    def everything(dimension: int) -> "Region":
        """The unit box."""
        return Region(np.zeros(dimension), np.ones(dimension))

    def around(self, point: Float[np.ndarray, " dimension"]) -> Float[np.ndarray, " dimension"]:
        """The nearest point inside."""
        return np.clip(point, self.lower, self.upper)


@dataclass(frozen=True)
class Criterion:
    """What is minimised, and how sure the constraints must be.

    Attributes
    ----------
    kappa
        Deviations taken off the objective's mean: larger explores more.
    caution
        Deviations added to each constraint's mean: larger is safer.
    """

    kappa: float
    caution: float

    def multipliers(self, surrogate: Surrogate) -> Float[np.ndarray, " outputs"]:
        """Of the deviation, for the objective and each restriction.

        A failure teaches nothing but where it was, so no criterion is optimistic
        about failing.
        """
        multipliers = np.full(surrogate.outputs, self.caution)
        multipliers[0] = -self.kappa
        if surrogate.failures:
            multipliers[-1] = max(self.caution, CAUTION_ABOUT_FAILURE)
        return multipliers


@dataclass(frozen=True, eq=False)
class Suggestion:
    """A point, its merit (lower is better), and what the surrogate expects there."""

    point: Float[np.ndarray, " dimension"]
    merit: float


def spread_candidates(
    region: Region,
    incumbent: Float[np.ndarray, " dimension"],
    random: np.random.Generator,
    count: int = CANDIDATES,
) -> Float[np.ndarray, "count dimension"]:
    """Half spread evenly over the region, half the incumbent with some coordinates moved."""
    dimension = len(incumbent)
    width = region.upper - region.lower
    even = region.lower + width * sobol(count // 2, dimension, random)
    near = count - count // 2
    # Moving all of many coordinates at once only leads away; Regis and Shoemaker (2013).
    moved = random.random((near, dimension)) < min(1.0, 5.0 / dimension)
    moved[np.arange(near), random.integers(0, dimension, near)] = True
    step = random.normal(size=(near, dimension)) * random.choice([0.02, 0.1, 0.3], (near, 1))
    return np.vstack([even, region.around(incumbent + moved * step * width)])


def suggest(
    surrogate: Surrogate,
    region: Region,
    criterion: Criterion,
    incumbent: Float[np.ndarray, " dimension"],
    random: np.random.Generator,
    starts: int = 2,
    iterations: int = 25,
) -> list[Suggestion]:
    """Points worth evaluating, best first: polished ones, then the plain candidates.

    Candidates are ranked all at once; the incumbent and the best `starts` are
    polished with gradients.
    """
    points = spread_candidates(region, incumbent, random)
    points[0] = region.around(incumbent)
    means, deviations = surrogate.predict(points)
    values = means + criterion.multipliers(surrogate) * deviations
    values[~np.isfinite(values)] = 1e30
    scale = _scales(means)
    merits = _merit(values / scale)
    order = np.argsort(merits, kind="stable")
    polished = [
        _polish(surrogate, region, criterion, points[start], scale, iterations)
        for start in dict.fromkeys([0, *order[:starts].tolist()])
    ]
    polished.sort(key=lambda suggestion: suggestion.merit)
    return polished + [Suggestion(points[row], float(merits[row])) for row in order]


def _scales(means: Float[np.ndarray, "points outputs"]) -> Float[np.ndarray, " outputs"]:
    """How much each output varies over the region: makes the polish well conditioned."""
    finite = np.where(np.isfinite(means), means, 0.0)
    return np.maximum(np.std(finite, axis=0), 1e-12 * np.max(np.abs(finite), axis=0) + 1e-300)


def _merit(scaled: Float[np.ndarray, "*points outputs"]) -> Float[np.ndarray, "*points"]:
    worst = np.max(np.maximum(scaled[..., 1:], 0.0), axis=-1, initial=0.0)
    return np.asarray(scaled[..., 0] + ELASTIC_WEIGHT * worst)


def _polish(
    surrogate: Surrogate,
    region: Region,
    criterion: Criterion,
    start: Float[np.ndarray, " dimension"],
    scale: Float[np.ndarray, " outputs"],
    iterations: int,
) -> Suggestion:
    """The criterion minimised from one start by sequential quadratic programming.

    One slack variable carries the worst violation at a price, so that there is
    always an answer, even where the constraints' surrogates contradict each
    other: then it is the least violation.
    """
    multipliers = criterion.multipliers(surrogate)
    width = np.maximum(region.upper - region.lower, 1e-12)
    known: dict[bytes, tuple[np.ndarray, np.ndarray]] = {}

    def outputs(unknowns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        key = unknowns[:-1].tobytes()
        if key not in known:
            point = region.around(region.lower + width * unknowns[:-1])
            values, slopes = surrogate.bounds(point, multipliers)
            values = np.where(np.isfinite(values), values / scale, 1e30)
            slopes = np.where(np.isfinite(slopes), slopes * width / scale[:, None], 0.0)
            known[key] = values, slopes
        return known[key]

    def cost(unknowns: np.ndarray) -> float:
        return float(outputs(unknowns)[0][0] + ELASTIC_WEIGHT * unknowns[-1])

    def cost_slope(unknowns: np.ndarray) -> np.ndarray:
        return np.append(outputs(unknowns)[1][0], ELASTIC_WEIGHT)

    def allowance(unknowns: np.ndarray) -> np.ndarray:
        return unknowns[-1] - outputs(unknowns)[0][1:]

    def allowance_slope(unknowns: np.ndarray) -> np.ndarray:
        slopes = outputs(unknowns)[1][1:]
        return np.column_stack([-slopes, np.ones(len(slopes))])

    first = np.clip((start - region.lower) / width, 0.0, 1.0)
    slack = float(np.max(outputs(np.append(first, 0.0))[0][1:], initial=0.0))
    constraints = (
        [{"type": "ineq", "fun": allowance, "jac": allowance_slope}]
        if surrogate.outputs > 1
        else []
    )
    minimize(
        cost,
        np.append(first, max(slack, 0.0)),
        jac=cost_slope,
        method="SLSQP",
        bounds=[(0.0, 1.0)] * len(first) + [(0.0, None)],
        constraints=constraints,
        options={"maxiter": iterations, "ftol": 1e-9},
    )
    # The best point that it visited, which need not be its last.
    best = min(known, key=lambda key: float(_merit(known[key][0])))
    unknowns = np.frombuffer(best)
    return Suggestion(region.around(region.lower + width * unknowns), float(_merit(known[best][0])))


def apart(
    point: Float[np.ndarray, " dimension"],
    others: Float[np.ndarray, "others dimension"],
    separation: float,
) -> bool:
    """True when no other point is within `separation` (Euclidean, in box widths)."""
    if len(others) == 0:
        return True
    return bool(np.min(np.sum((others - point) ** 2, axis=1)) > separation**2)

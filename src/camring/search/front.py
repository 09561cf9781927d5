"""A front of compromises, traced by descents with exact slopes.

Each compromise is a descent of its own (Pascoletti and Serafini 1984): from a point
between two neighbours of the front, straight towards better in all objectives at once,
as far as the constraints allow. With two objectives the widest gap comes next, so the
front fills evenly whatever its shape; with three the aims are a lattice between the
best designs of each objective. A descent starts from the neighbours, so it is short.
"""

import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import TypeAlias

import numpy as np
from jaxtyping import Float
from scipy.optimize import minimize

from camring.search.pareto import box_of, non_dominated
from camring.search.threads import one_linear_algebra_thread

Point: TypeAlias = Float[np.ndarray, " dimension"]
Pair: TypeAlias = tuple[Float[np.ndarray, "..."], Float[np.ndarray, "..."]]

INSIDE = 1e-5  # what a descent keeps of every limit
STEPS = 25  # of one descent
ACCURACY = 1e-5  # of an objective in widths of the front
SMALLEST_GAP = 1e-3  # likewise; nearer neighbours are one compromise
STARTS_EACH = 2  # descents towards the best of one objective
SPARE = 1.3  # compromises sought for each one wanted, to choose evenly from
TRIES = 3  # descents at most for each one sought


@dataclass(frozen=True)
class FrontProblem:
    """Several objectives to make small on the unit box.

    Attributes
    ----------
    values
        Objectives, and constraints that hold where at most 0; NaN where a point failed.
    slopes
        Their gradients, (objective, dimension) and (constraint, dimension).
    """

    values: Callable[[Point], Pair]
    slopes: Callable[[Point], Pair]


@dataclass
class Front:
    """Where descents have ended.

    Attributes
    ----------
    points, objectives
        Of feasible ends of descents, in the order in which they were found.
    evaluations
        Points evaluated, feasible or not.
    """

    points: list[Point] = field(default_factory=list)
    objectives: list[Float[np.ndarray, " objective"]] = field(default_factory=list)
    evaluations: int = 0

    def best(self) -> list[int]:
        """Places of ends that none beats, each compromise once."""
        if not self.points:
            return []
        values = np.array(self.objectives)
        kept: list[int] = []
        _, width = box_of(values)
        for place in np.flatnonzero(non_dominated(values)):
            apart = [np.max(np.abs(values[place] - values[each]) / width) for each in kept]
            if not apart or min(apart) > SMALLEST_GAP / 10:
                kept.append(int(place))
        return kept


def trace_front(
    problem: FrontProblem,
    starts: Sequence[Point],
    count: int,
    said: Callable[[int], None] = lambda found: None,
) -> Front:
    """Compromises from one end of the front to the other.

    Parameters
    ----------
    starts
        Points to begin from; sound ones, not necessarily feasible.
    count
        How many compromises are wanted; about a third more are sought.
    said
        Told how many have been found so far.

    Returns
    -------
    A front without points when no descent has come to a feasible one.
    """
    tracer = _Tracer(problem, starts)
    with one_linear_algebra_thread(), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that a step was clipped to the box
        tracer.ends()
        if not tracer.front.points:
            return tracer.front
        wanted = round(SPARE * count)
        aims = tracer.gaps() if tracer.objectives == 2 else tracer.lattice(wanted)
        for _, (aim, towards, nearby) in zip(range(TRIES * wanted), aims, strict=False):
            tracer.compromise(aim, towards, nearby)
            found = len(tracer.front.best())
            said(found)
            if found >= wanted:
                break
    return tracer.front


Aim: TypeAlias = tuple[
    Float[np.ndarray, " objective"], Float[np.ndarray, " objective"], list[Point]
]


class _Tracer:
    def __init__(self, problem: FrontProblem, starts: Sequence[Point]) -> None:
        self.problem, self.front = problem, Front()
        self._values: dict[bytes, Pair] = {}
        self._slopes: dict[bytes, Pair] = {}
        self._path: list[Point] = []
        begun = [(np.asarray(start), *self._at(np.asarray(start))) for start in starts]
        self.starts = [each for each in begun if np.all(np.isfinite(each[1]))]
        self.objectives = len(begun[0][1])
        sound = np.array([each[1] for each in self.starts] or [np.zeros(self.objectives)])
        self.lowest, self.width = box_of(sound)

    def _at(self, point: Point) -> Pair:
        key = point.tobytes()
        if key not in self._values:
            objectives, limits = self.problem.values(point)
            self._values[key] = objectives, limits
            self.front.evaluations += 1
            if np.all(np.isfinite(objectives)) and np.all(limits <= 0):
                self._path.append(point)
        return self._values[key]

    def _rated(self, point: Point) -> Pair:
        """Objectives in widths, and constraints; a failed point is bad in all."""
        objectives, limits = self._at(np.clip(point, 0, 1))
        if not (np.all(np.isfinite(objectives)) and np.all(np.isfinite(limits))):
            return np.full(len(objectives), 1e2), np.ones(len(limits))
        return (objectives - self.lowest) / self.width, limits + INSIDE

    def _sloped(self, point: Point) -> Pair:
        point = np.clip(point, 0, 1)
        objectives, limits = self._at(point)
        if not (np.all(np.isfinite(objectives)) and np.all(np.isfinite(limits))):
            shape = len(point)
            return np.zeros((len(objectives), shape)), np.zeros((len(limits), shape))
        key = point.tobytes()
        if key not in self._slopes:
            self._slopes[key] = self.problem.slopes(point)
        of_objectives, of_limits = self._slopes[key]
        return of_objectives / self.width[:, None], of_limits

    def ends(self) -> None:
        """The best of each objective alone, then as good as can be in the others."""
        for one in range(self.objectives):
            order = sorted(self.starts, key=lambda each: _rank(each[1][one], each[2]))
            for start, *_ in order[:STARTS_EACH]:
                self._descend(start, np.eye(self.objectives)[one])
        if not self.front.points:
            return
        self._settle()
        for one in range(self.objectives):
            values = np.array(self.front.objectives)
            best = int(np.argmin(values[:, one]))
            others = np.full(self.objectives, 1.0)
            others[one] = 0.0
            limit = np.full(self.objectives, np.inf)
            limit[one] = (values[best, one] - self.lowest[one]) / self.width[one] + 10 * ACCURACY
            self._descend(self.front.points[best], others, limit)
        self._settle()

    def _settle(self) -> None:
        self.lowest, self.width = box_of(np.array(self.front.objectives)[self.front.best()])

    def gaps(self) -> Iterator[Aim]:
        """The middle of the widest gap that has not been tried, for ever."""
        tried: set[tuple[int, int]] = set()
        while True:
            kept = sorted(self.front.best(), key=lambda place: self.front.objectives[place][0])
            rated = (np.array(self.front.objectives)[kept] - self.lowest) / self.width
            length = np.linalg.norm(np.diff(rated, axis=0), axis=1)
            open_ = [k for k in range(len(kept) - 1) if (kept[k], kept[k + 1]) not in tried]
            if not open_ or length[widest := max(open_, key=lambda k: length[k])] < SMALLEST_GAP:
                return
            pair = kept[widest], kept[widest + 1]
            tried.add(pair)
            across = rated[widest + 1] - rated[widest]
            normal = np.abs(across[::-1]) / np.max(np.abs(across))
            points = [self.front.points[place] for place in pair]
            middle = (rated[widest] + rated[widest + 1]) / 2
            yield middle, np.maximum(normal, 1e-3), [np.mean(points, axis=0), *points]

    def lattice(self, count: int) -> Iterator[Aim]:
        """Shares of the best designs of each objective, as many as are wanted or more."""
        values = np.array(self.front.objectives)
        corners = (values[np.argmin(values, axis=0)] - self.lowest) / self.width
        steps = 1
        while (steps + 1) * (steps + 2) // 2 < count:
            steps += 1
        shares = [each for each in product(range(steps + 1), repeat=3) if sum(each) == steps]
        for share in shares:
            middle = np.array(share) @ corners / steps
            rated = (np.array(self.front.objectives) - self.lowest) / self.width
            offset = rated - middle
            sideways = offset - offset.mean(axis=1, keepdims=True)
            nearest = np.argsort(np.linalg.norm(sideways, axis=1))[:2]
            yield middle, np.ones(3), [self.front.points[place] for place in nearest]

    def compromise(
        self,
        aim: Float[np.ndarray, " objective"],
        towards: Float[np.ndarray, " objective"],
        nearby: Sequence[Point],
    ) -> None:
        """Descend from the first start that leads to a feasible end."""
        for start in nearby:
            if self._descend_along(start, aim, towards):
                return

    def _descend(
        self,
        start: Point,
        weights: Float[np.ndarray, " objective"],
        limit: Float[np.ndarray, " objective"] | None = None,
    ) -> None:
        """Down a weighted sum; `limit` on objectives where finite."""
        held = np.isfinite(limit) if limit is not None else np.zeros(self.objectives, bool)
        bound = limit[held] if limit is not None else np.zeros(0)

        def room(point: Point) -> Float[np.ndarray, " limit"]:
            rated, limits = self._rated(point)
            return -np.concatenate([rated[held] - bound, limits])

        def room_slopes(point: Point) -> Float[np.ndarray, "limit dimension"]:
            rated, limits = self._sloped(point)
            return -np.concatenate([rated[held], limits])

        self._path = [start]

        def merit(point: Point) -> float:
            rated, _ = self._rated(point)
            return float(weights @ rated) + 1e3 * float(np.sum(np.maximum(rated[held] - bound, 0)))

        found = minimize(
            lambda point: float(weights @ self._rated(point)[0]),
            start,
            jac=lambda point: weights @ self._sloped(point)[0],
            bounds=[(0.0, 1.0)] * len(start),
            constraints={"type": "ineq", "fun": room, "jac": room_slopes},
            method="SLSQP",
            options={"maxiter": STEPS, "ftol": ACCURACY},
        )
        self._keep(found.x, merit)

    def _descend_along(
        self,
        start: Point,
        aim: Float[np.ndarray, " objective"],
        towards: Float[np.ndarray, " objective"],
    ) -> bool:
        """As far below the aim as the worst of all objectives can come."""

        def behind(point: Point) -> float:
            return float(np.max((self._rated(point)[0] - aim) / towards))

        self._path = [start]

        def room(both: Point) -> Float[np.ndarray, " limit"]:
            rated, limits = self._rated(both[:-1])
            return np.concatenate([aim + both[-1] * towards - rated, -limits])

        def room_slopes(both: Point) -> Float[np.ndarray, "limit dimension"]:
            rated, limits = self._sloped(both[:-1])
            return np.block([[-rated, towards[:, None]], [-limits, np.zeros((len(limits), 1))]])

        last = np.eye(len(start) + 1)[-1]
        found = minimize(
            lambda both: float(both[-1]),
            np.append(start, behind(start)),
            jac=lambda both: last,
            bounds=[(0.0, 1.0)] * len(start) + [(None, None)],
            constraints={"type": "ineq", "fun": room, "jac": room_slopes},
            method="SLSQP",
            options={"maxiter": STEPS, "ftol": ACCURACY},
        )
        return self._keep(found.x[:-1], behind)

    def _keep(self, end: Point, merit: Callable[[Point], float]) -> bool:
        """The best feasible point that the descent has passed, if any; often its end."""
        feasible = [each for each in (np.clip(end, 0, 1), *self._path) if self._feasible(each)]
        if not feasible:
            return False
        best = min(feasible, key=merit)
        self.front.points.append(best)
        self.front.objectives.append(self._at(best)[0])
        return True

    def _feasible(self, point: Point) -> bool:
        objectives, limits = self._at(point)
        return bool(np.all(np.isfinite(objectives)) and np.all(limits <= 0))


def _rank(objective: float, limits: Float[np.ndarray, " constraint"]) -> tuple[float, float]:
    broken = float(np.sum(np.maximum(limits, 0)))
    return broken, objective

"""A front of compromises, traced by descents with exact slopes, many abreast.

Each compromise is a descent of its own (`scalarised.py`). The first aims lie evenly
between the best designs of each objective, the next ones in the widest gaps between
those found, so the front fills evenly whatever its shape. A descent starts from the
compromises next to its aim, so it is short.
"""

import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
from jaxtyping import Float

from camring.search.parallel_searches import Ask, Point, Points, Search, walk_abreast
from camring.search.pareto.dominance import box_of, non_dominated
from camring.search.pareto.gaps import between_ends, neighbours, sideways, spacing
from camring.search.pareto.scalarised import (
    ACCURACY,
    End,
    Objectives,
    Scale,
    descend,
    descend_along,
)
from camring.search.threads import one_linear_algebra_thread

Pair: TypeAlias = tuple[Float[np.ndarray, "..."], Float[np.ndarray, "..."]]

SEATS = 64  # descents abreast
SMALLEST_GAP = 1e-3  # of the front's width; nearer neighbours are one compromise
STARTS_EACH = 4  # descents towards the best of one objective
FURTHER = 4  # times at most that the best of them goes on; each has patience for some steps only
GAINED = 0.01  # of the front's width, by which it must have come down to go on once more
EVEN = 0.8  # widest gap left, in shares of what equal ones would be
PLENTY = 2  # compromises for each one wanted, at which gaps are left as they are
TRIES = 4  # descents into gaps at most, for each compromise wanted
ATTEMPTS = 3  # at one gap, from different starts
FIRST = 0.25  # compromises aimed at evenly before gaps are, for each one wanted
DIVIDE = 6.0  # times the median change of design with objectives: two valleys meet here
CROSSED = 0.5  # divides at most, for each compromise wanted


@dataclass(frozen=True)
class FrontProblem:
    """Several objectives to make small on the unit box, at many points at a time.

    Attributes
    ----------
    values
        Of points (point, dimension): objectives (point, objective), and constraints
        (point, constraint) that hold where at most 0; NaN where a point failed.
    slopes
        Their gradients, (point, objective, dimension) and (point, constraint, dimension).
    """

    values: Callable[[Points], Pair]
    slopes: Callable[[Points], Pair]

    @staticmethod
    def one_by_one(
        values: Callable[[Point], Pair], slopes: Callable[[Point], Pair]
    ) -> "FrontProblem":
        """Of functions that take one point and give arrays without the leading axis."""

        def each(function: Callable[[Point], Pair]) -> Callable[[Points], Pair]:
            def batch(points: Points) -> Pair:
                first, second = zip(*map(function, points), strict=True)
                return np.stack(first), np.stack(second)

            return batch

        return FrontProblem(each(values), each(slopes))


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
    objectives: list[Objectives] = field(default_factory=list)
    evaluations: int = 0
    sloped: int = 0
    descents: int = 0

    def best(self) -> list[int]:
        """Places of ends that none beats, each compromise once."""
        if not self.points:
            return []
        values = np.array(self.objectives)
        unbeaten = np.flatnonzero(non_dominated(values))
        ends = np.argmin(values[unbeaten], axis=0).tolist()
        rated = values[unbeaten] / box_of(values[unbeaten])[1]
        apart = np.max(np.abs(rated[:, None] - rated), axis=-1)
        kept: list[int] = []
        for place in dict.fromkeys([*ends, *range(len(unbeaten))]):
            if np.all(apart[place, kept] > SMALLEST_GAP):
                kept.append(place)
        return unbeaten[kept].tolist()


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
        Called with how many have been found so far.

    Returns
    -------
    A front without points when no descent has come to a feasible one.
    """
    tracer = _Tracer(problem, np.array(starts, dtype=float))
    with one_linear_algebra_thread(), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that a step was clipped to the box
        tracer.ends()
        if tracer.front.points:
            tracer.fill(count, said)
    return tracer.front


@dataclass(frozen=True, eq=False)
class _Aim:
    place: Objectives


class _Tracer:
    def __init__(self, problem: FrontProblem, starts: Points) -> None:
        self.problem, self.front = problem, Front()
        objectives, limits = self._values(starts)
        sound = np.all(np.isfinite(objectives), axis=1)
        self.starts, self.begun = starts[sound], objectives[sound]
        self.broken = np.sum(np.maximum(limits[sound], 0), axis=1)
        self.objectives = objectives.shape[1]
        self.scale = Scale(*box_of(self.begun if len(self.begun) else np.zeros((1, 2))))
        self.pending: list[_Aim] = []
        self.tried: dict[tuple[int, int], int] = {}
        self.crossed: set[tuple[int, int]] = set()

    def _values(self, points: Points) -> Pair:
        self.front.evaluations += len(points)
        return self.problem.values(points)

    def _slopes(self, points: Points) -> Pair:
        self.front.sloped += len(points)
        return self.problem.slopes(points)

    def _walk(self, searches: Iterator[Search | None]) -> None:
        """Until the iterator is at its end; None from it means that there may be more."""
        walk_abreast(lambda: next(searches, None), self._values, self._slopes, SEATS)

    def _keep(self, end: End | None) -> bool:
        self.front.descents += 1
        if end is None:
            return False
        self.front.points.append(end.point)
        self.front.objectives.append(end.objectives)
        return True

    def ends(self) -> None:
        """The best of each objective alone, then as good as can be in the others."""
        self._walk(self._alone())
        if self.front.points:
            self._settle()
            self._go_on()
            self._walk(self._others())
            self._settle()

    def _alone(self) -> Iterator[Search]:
        for one in range(self.objectives):
            weights = np.eye(self.objectives)[one]
            for place in np.lexsort((self.begun[:, one], self.broken))[:STARTS_EACH]:
                yield self._descent(self.starts[place], weights)

    def _go_on(self) -> None:
        """The best of each objective once more, for as long as that brings it down."""
        improving = list(range(self.objectives))
        for _ in range(FURTHER):
            before = np.min(self.front.objectives, axis=0)
            best = np.argmin(self.front.objectives, axis=0)
            starts = [self.front.points[best[one]] for one in improving]
            weights = np.eye(self.objectives)[improving]
            self._walk(map(self._descent, starts, weights))
            gained = (before - np.min(self.front.objectives, axis=0)) / self.scale.width
            self._settle()
            improving = [one for one in improving if gained[one] > GAINED]
            if not improving:
                return

    def _others(self) -> Iterator[Search]:
        values = np.array(self.front.objectives)
        for one in range(self.objectives):
            best = int(np.argmin(values[:, one]))
            others = np.where(np.arange(self.objectives) == one, 0.0, 1.0)
            bound = np.full(self.objectives, np.inf)
            bound[one] = self.scale.rated(values[best])[one] + 10 * ACCURACY
            yield self._descent(self.front.points[best], others, bound)

    def _descent(
        self, start: Point, weights: Objectives, bound: Objectives | None = None
    ) -> Search:
        scale = self.scale

        def search(ask: Ask) -> None:
            self._keep(descend(ask, start, scale, weights, bound))

        return search

    def _settle(self) -> None:
        self.scale = Scale(*box_of(np.array(self.front.objectives)[self.front.best()]))

    def fill(self, count: int, said: Callable[[int], None]) -> None:
        """Compromises between the ends."""
        self._walk(self._evenly_between(round(FIRST * count)))
        self._walk(self._between_neighbours(count, said))

    def _evenly_between(self, count: int) -> Iterator[Search]:
        """Each reached from the two designs known that are most nearly in its direction."""
        known = np.concatenate([np.array(self.front.objectives), self.begun[self.broken == 0]])
        points = [*self.front.points, *self.starts[self.broken == 0]]
        towards = np.ones(self.objectives)
        for place in between_ends(self._ends(), count):
            offset = sideways(self.scale.rated(known) - place)
            for nearest in np.argsort(np.linalg.norm(offset, axis=1))[:2]:
                yield self._towards(place, towards, points[nearest])

    def _between_neighbours(
        self, count: int, said: Callable[[int], None]
    ) -> Iterator[Search | None]:
        """Into the widest gap that nobody is on his way to; then across divides."""
        left = TRIES * count
        while left > 0:
            kept = self.front.best()
            said(len(kept))
            gap = self._widest_gap(kept, count) if len(kept) < PLENTY * count else None
            ready = gap is None and len(kept) >= count and len(self.crossed) < CROSSED * count
            divide = self._widest_divide(kept) if ready else None
            if gap is not None:
                yield self._middle(*gap)
            elif divide is not None:
                yield from self._across(*divide)
            elif self.pending:
                yield None
                continue
            else:
                return
            left -= 1

    def _across(self, one: int, other: int) -> Iterator[Search]:
        """Either valley followed beyond the divide, where it may still be the deeper one."""
        self.crossed.add((one, other))
        a, b = (self.scale.rated(self.front.objectives[place]) for place in (one, other))
        yield self._towards(a, _normal(a, b), self.front.points[other])
        yield self._towards(b, _normal(a, b), self.front.points[one])

    def _ends(self) -> Float[np.ndarray, "objective objective"]:
        values = np.array(self.front.objectives)
        return self.scale.rated(values[np.argmin(values, axis=0)])

    def _widest_divide(self, kept: Sequence[int]) -> tuple[int, int] | None:
        """Neighbours of which the designs differ far more than objectives let expect."""
        rated = self.scale.rated(np.array(self.front.objectives)[kept])
        points = np.array(self.front.points)[kept]
        one, other = np.array(neighbours(rated)).reshape(-1, 2).T
        change = np.linalg.norm(points[other] - points[one], axis=1)
        change /= np.linalg.norm(rated[other] - rated[one], axis=1)
        for place in np.argsort(-change):
            if change[place] < DIVIDE * np.median(change):
                break
            pair = kept[one[place]], kept[other[place]]
            if pair not in self.crossed:
                return pair
        return None

    def _widest_gap(self, kept: Sequence[int], count: int) -> tuple[int, int] | None:
        """Two neighbours with nobody on his way between them; None when all are near enough."""
        rated = self.scale.rated(np.array(self.front.objectives)[kept])
        aimed = np.array([each.place for each in self.pending]).reshape(-1, self.objectives)
        enough = max(SMALLEST_GAP, EVEN * spacing(rated, count))
        widest, found = enough, None
        for a, b in neighbours(np.concatenate([rated, aimed])):
            if max(a, b) >= len(kept) or self.tried.get((kept[a], kept[b]), 0) >= ATTEMPTS:
                continue
            width = float(np.linalg.norm(rated[b] - rated[a]))
            if width > widest:
                widest, found = width, (kept[a], kept[b])
        return found

    def _middle(self, one: int, other: int) -> Search:
        """Between two neighbours; from their mean at first, then from either of them."""
        attempt = self.tried.get((one, other), 0)
        self.tried[one, other] = attempt + 1
        points = [self.front.points[place] for place in (one, other)]
        a, b = (self.scale.rated(self.front.objectives[place]) for place in (one, other))
        start = [np.mean(points, axis=0), *points][attempt]
        return self._towards((a + b) / 2, _normal(a, b), start)

    def _towards(self, place: Objectives, towards: Objectives, start: Point) -> Search:
        scale, aim = self.scale, _Aim(place)
        self.pending.append(aim)

        def search(ask: Ask) -> None:
            self._keep(descend_along(ask, start, scale, place, towards))
            self.pending.remove(aim)

        return search


def _normal(a: Objectives, b: Objectives) -> Objectives:
    """Where to from between two neighbours: at right angles in a row, else alike in all."""
    if len(a) != 2:
        return np.ones(len(a))
    across = np.abs(b - a)[::-1]
    return np.maximum(across / np.max(across), 1e-3)


__all__ = ["Front", "FrontProblem", "trace_front"]

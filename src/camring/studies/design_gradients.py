"""Chosen results and all limits of many designs, and their slopes where they were just solved.

Side by side where the motor can be simulated in batches, else one by one; at final
resolution either way, for at coarser ones lowest pressures are wrong by some per cent.
"""

from collections import OrderedDict
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Protocol, TypeAlias

import jax
import numpy as np
from jaxtyping import Float

from camring.evaluation.assessed import outcome_of
from camring.evaluation.batch import assess_and_keep, cores, padded, slopes_in_batch
from camring.evaluation.evaluator import applied
from camring.objective.design_space import AbstractSpace
from camring.objective.objective import Goal
from camring.physics.batch_cycle import BatchResolution, fits
from camring.physics.system import System
from camring.programs.compiled import Solved, assess_solved, slopes_with_results, solve

Points: TypeAlias = Float[np.ndarray, "point dimension"]
Results: TypeAlias = Float[np.ndarray, "point operating result"]
ResultSlopes: TypeAlias = Float[np.ndarray, "point operating result dimension"]
Limits: TypeAlias = Float[np.ndarray, "point constraint"]
LimitSlopes: TypeAlias = Float[np.ndarray, "point constraint dimension"]

TOGETHER = (
    8  # designs in one call; with 24 a front takes a third longer: descents wait for each other
)
KEPT = 256  # designs whose cycles are kept for their slopes; some 0.2 MB each


class SlopedDesigns(Protocol):
    """Designs by their points of the unit box."""

    def values(self, points: Points) -> tuple[Results, Limits]:
        """Results, no numbers where a simulation failed, and constraints."""
        ...

    def slopes(self, points: Points) -> tuple[Results, ResultSlopes, LimitSlopes]:
        """The results again, and derivatives of both; what `values` solved is not solved again."""
        ...


def sloped_designs(
    system: System, goal: Goal, space: AbstractSpace, names: Sequence[str]
) -> SlopedDesigns:
    """The quickest way for this motor.

    Parameters
    ----------
    system
        The one that the space belongs to.
    names
        Of the results wanted, in the order in which they come back.
    """
    gradients = _InBatch if fits(system.motor) else _OneByOne
    return gradients(system, goal, space, tuple(names))


class _InBatch:
    def __init__(
        self, system: System, goal: Goal, space: AbstractSpace, names: tuple[str, ...]
    ) -> None:
        self._given, self._names = (space, system, goal), names
        self._limits = goal.constraints.names()
        self._pool = ThreadPoolExecutor(cores())
        self._compiled: set[Callable] = set()
        self._kept = OrderedDict[bytes, tuple[list[np.ndarray], Results]]()
        self._structure: Any = None  # of the cycles, and which leaves have a batch axis
        self._batched: list[bool] = []

    def values(self, points: Points) -> tuple[Results, Limits]:
        results, limits, cycles = zip(*self._by_chunks(self._assessed, points), strict=True)
        together = np.concatenate(results), np.concatenate(limits)
        self._keep(points, together[0], [member for chunk in cycles for member in chunk])
        return together

    def slopes(self, points: Points) -> tuple[Results, ResultSlopes, LimitSlopes]:
        missing = [point for point in points if point.tobytes() not in self._kept]
        if missing:
            self.values(np.stack(missing))
        results = np.stack([self._kept[point.tobytes()][1] for point in points])
        of_results, of_limits = zip(*self._by_chunks(self._sloped, points), strict=True)
        return results, np.concatenate(of_results), np.concatenate(of_limits)

    def _by_chunks(self, function: Callable[[Points], tuple], points: Points) -> list[tuple]:
        """Side by side, once the first call has compiled what all of them need."""
        chunks = [points[start : start + TOGETHER] for start in range(0, len(points), TOGETHER)]
        known = function in self._compiled
        first = [] if known else [function(chunks.pop(0))]
        self._compiled.add(function)
        return [*first, *self._pool.map(function, chunks)]

    def _assessed(self, points: Points) -> tuple[Results, Limits, list[list[np.ndarray]]]:
        solved = assess_and_keep(*self._given, padded(points, TOGETHER), BatchResolution())
        cycles, said = jax.device_get(solved)
        results = np.array([[getattr(each, n) for n in self._names] for each in said.metrics])
        sound = np.all(said.faults == 0, axis=0) & np.isfinite(said.objective)
        limits = np.array([said.constraints[name] for name in self._limits])
        leaves, self._structure = jax.tree.flatten(cycles)
        # A leaf without a batch axis, such as the number of Newton's steps, is the same for all.
        self._batched = [np.ndim(leaf) > 0 for leaf in leaves]
        parted = [
            np.ascontiguousarray(np.moveaxis(leaf, -1, 0)) if batched else [leaf] * TOGETHER
            for leaf, batched in zip(leaves, self._batched, strict=True)
        ]
        members = [[np.copy(leaf[member]) for leaf in parted] for member in range(len(points))]
        results = np.moveaxis(np.where(sound, results, np.nan), -1, 0)
        return results[: len(points)], limits.T[: len(points)], members

    def _keep(self, points: Points, results: Results, members: Sequence[list[np.ndarray]]) -> None:
        for point, result, member in zip(points, results, members, strict=True):
            self._kept[point.tobytes()] = member, result
            self._kept.move_to_end(point.tobytes())
        while len(self._kept) > KEPT:
            self._kept.popitem(last=False)

    def _sloped(self, points: Points) -> tuple[ResultSlopes, LimitSlopes]:
        filled = padded(points, TOGETHER)
        members = [self._kept[point.tobytes()][0] for point in filled]
        leaves = [
            np.stack(each, axis=-1) if batched else each[0]
            for each, batched in zip(zip(*members, strict=True), self._batched, strict=True)
        ]
        cycles = jax.tree.unflatten(self._structure, leaves)
        found = slopes_in_batch(
            *self._given, filled, cycles, BatchResolution(), results=self._names
        )
        of_results = np.array([[each[n] for n in self._names] for each in found.results])
        of_limits = np.array([found.constraints[name] for name in self._limits])
        # (operating, result, coordinate, batch) and (constraint, coordinate, batch)
        of_results, of_limits = (np.moveaxis(each, -1, 0) for each in (of_results, of_limits))
        return of_results[: len(points)], of_limits[: len(points)]


class _OneByOne:
    """For motors that do not go in a batch."""

    def __init__(
        self, system: System, goal: Goal, space: AbstractSpace, names: tuple[str, ...]
    ) -> None:
        self._system, self._goal, self._space, self._names = system, goal, space, names
        self._limits = goal.constraints.names()
        self._kept = OrderedDict[bytes, Solved]()

    def _solved(self, point: Float[np.ndarray, " dimension"]) -> Solved:
        key = point.tobytes()
        if key not in self._kept:
            self._kept[key] = solve(applied(self._space, self._system, point), self._goal)
            if len(self._kept) > KEPT:
                self._kept.popitem(last=False)
        return self._kept[key]

    def values(self, points: Points) -> tuple[Results, Limits]:
        found = [outcome_of(assess_solved(self._solved(each), self._goal)) for each in points]
        results = np.array(
            [[[at[n] for n in self._names] for at in each.results] for each in found]
        )
        failed = np.array([each.failure is not None for each in found])
        results[failed] = np.nan
        return results, np.array([[each.constraints[n] for n in self._limits] for each in found])

    def slopes(self, points: Points) -> tuple[Results, ResultSlopes, LimitSlopes]:
        parts = [self._sloped(each) for each in points]
        results, of_results, of_limits = (np.array(part) for part in zip(*parts, strict=True))
        return results, of_results, of_limits

    def _sloped(self, point: Float[np.ndarray, " dimension"]) -> tuple[list, list, list]:
        solved = self._solved(point)
        found, of_results = jax.device_get(
            slopes_with_results(self._space, self._system, point, solved, self._goal, self._names)
        )
        return (
            [[float(getattr(each, n)) for n in self._names] for each in solved.metrics],
            [[each[n] for n in self._names] for each in of_results],
            [found.constraints[name] for name in self._limits],
        )


__all__ = ["LimitSlopes", "Limits", "Points", "SlopedDesigns", "sloped_designs"]

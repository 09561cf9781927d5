"""Descents to one compromise: down a weighted sum, or along a direction.

The second is Pascoletti and Serafini's (1984): from an aim in the space of objectives
straight towards better in all of them at once, as far as the constraints allow. It
reaches designs that no weighted sum does, where a front is bent the wrong way.
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from jaxtyping import Float
from scipy.optimize import minimize

from camring.search.parallel_searches import Ask, Point

Objectives: TypeAlias = Float[np.ndarray, " objective"]
Pair: TypeAlias = tuple[Float[np.ndarray, "..."], Float[np.ndarray, "..."]]

INSIDE = 1e-5  # what a descent keeps of every limit
STEPS = 60
# Evaluations; rounding and kinks can keep a descent at its end for as long as it is let.
PATIENCE = 80
ACCURACY = 1e-5  # of an objective in widths of the front
FAILED = 1e2  # what a failed point has of each objective, in widths
PRICE = 1e3  # of what a held objective exceeds its bound by, where ends are compared


@dataclass(frozen=True)
class Scale:
    """What objectives are measured by: how far above their lowest, in widths."""

    lowest: Objectives
    width: Objectives

    def rated(self, objectives: Float[np.ndarray, "*design objective"]) -> np.ndarray:
        return (objectives - self.lowest) / self.width


@dataclass(frozen=True)
class End:
    """A feasible point where a descent ended, and its objectives unscaled."""

    point: Point
    objectives: Objectives


class _Enough(Exception):
    """A descent has had its evaluations."""


class _Path:
    """What one descent has seen, scaled for it."""

    def __init__(self, ask: Ask, scale: Scale) -> None:
        self._ask, self._scale = ask, scale
        self._values: dict[bytes, Pair] = {}
        self._slopes: dict[bytes, Pair] = {}
        self._feasible: list[End] = []

    def _at(self, point: Point) -> Pair:
        key = point.tobytes()
        if key not in self._values:
            if len(self._values) >= PATIENCE:
                raise _Enough
            objectives, limits = self._ask.values(point)
            self._values[key] = objectives, limits
            if np.all(np.isfinite(objectives)) and np.all(limits <= 0):
                self._feasible.append(End(point, objectives))
        return self._values[key]

    def rated(self, point: Point) -> Pair:
        """Objectives in widths, and constraints; a failed point is bad in all."""
        objectives, limits = self._at(np.clip(point, 0, 1))
        if not (np.all(np.isfinite(objectives)) and np.all(np.isfinite(limits))):
            return np.full(len(objectives), FAILED), np.ones(len(limits))
        return self._scale.rated(objectives), limits + INSIDE

    def sloped(self, point: Point) -> Pair:
        point = np.clip(point, 0, 1)
        objectives, limits = self._at(point)
        if not (np.all(np.isfinite(objectives)) and np.all(np.isfinite(limits))):
            return np.zeros((len(objectives), len(point))), np.zeros((len(limits), len(point)))
        key = point.tobytes()
        if key not in self._slopes:
            first, second = self._ask.slopes(point)
            self._slopes[key] = first, second
        of_objectives, of_limits = self._slopes[key]
        return of_objectives / self._scale.width[:, None], of_limits

    @staticmethod
    def walk(
        function: Callable[[Point], float],
        start: Point,
        **settings: Any,
    ) -> None:
        """Downhill, until it ends or patience does."""
        options = {"maxiter": STEPS, "ftol": ACCURACY}
        with suppress(_Enough):
            minimize(function, start, method="SLSQP", options=options, **settings)

    def best(self, merit: Callable[[Objectives], float]) -> End | None:
        """The best feasible point passed, often the last; None without any."""
        return min(
            self._feasible, key=lambda each: merit(self._scale.rated(each.objectives)), default=None
        )


def descend(
    ask: Ask,
    start: Point,
    scale: Scale,
    weights: Objectives,
    bound: Objectives | None = None,
) -> End | None:
    """Down a weighted sum of rated objectives, each below its bound where that is finite.

    Returns
    -------
    The best feasible point on the way; None when there was none.
    """
    path = _Path(ask, scale)
    bound = np.full(len(weights), np.inf) if bound is None else bound
    held = np.isfinite(bound)

    def slack(point: Point) -> Float[np.ndarray, " limit"]:
        rated, limits = path.rated(point)
        return -np.concatenate([rated[held] - bound[held], limits])

    def slack_slopes(point: Point) -> Float[np.ndarray, "limit dimension"]:
        rated, limits = path.sloped(point)
        return -np.concatenate([rated[held], limits])

    def merit(rated: Objectives) -> float:
        over = np.maximum(rated[held] - bound[held], 0)
        return float(weights @ rated) + PRICE * float(np.sum(over))

    path.walk(
        lambda point: float(weights @ path.rated(point)[0]),
        start,
        jac=lambda point: weights @ path.sloped(point)[0],
        bounds=[(0.0, 1.0)] * len(start),
        constraints={"type": "ineq", "fun": slack, "jac": slack_slopes},
    )
    return path.best(merit)


def descend_along(
    ask: Ask, start: Point, scale: Scale, aim: Objectives, towards: Objectives
) -> End | None:
    """As far below the aim as the worst of all rated objectives can come.

    Parameters
    ----------
    aim, towards
        Rated objectives, and how much of each counts as much as one of the others.

    Returns
    -------
    The best feasible point on the way; None when there was none.
    """
    path = _Path(ask, scale)

    def behind(rated: Objectives) -> float:
        return float(np.max((rated - aim) / towards))

    def slack(both: Point) -> Float[np.ndarray, " limit"]:
        rated, limits = path.rated(both[:-1])
        return np.concatenate([aim + both[-1] * towards - rated, -limits])

    def slack_slopes(both: Point) -> Float[np.ndarray, "limit dimension"]:
        rated, limits = path.sloped(both[:-1])
        return np.block([[-rated, towards[:, None]], [-limits, np.zeros((len(limits), 1))]])

    last = np.eye(len(start) + 1)[-1]
    path.walk(
        lambda both: float(both[-1]),
        np.append(start, behind(path.rated(start)[0])),
        jac=lambda both: last,
        bounds=[(0.0, 1.0)] * len(start) + [(None, None)],
        constraints={"type": "ineq", "fun": slack, "jac": slack_slopes},
    )
    return path.best(behind)


__all__ = ["ACCURACY", "INSIDE", "End", "Scale", "descend", "descend_along"]

"""Designs whose limits hold over an envelope as well as at their operating points."""

from collections import OrderedDict

import numpy as np
from jaxtyping import Float

from camring.evaluation.envelope_batch import SolvedAtPoints, solved_at_points
from camring.evaluation.envelope_outcome import EnvelopeGoal
from camring.evaluation.evaluator import applied
from camring.evaluation.outcome import envelope_safety
from camring.files.motor import MotorFile, missing_design_space
from camring.search.problem import Outputs, Problem
from camring.search.scatter.robust import RobustFunction
from camring.studies.design_gradients import (
    Limits,
    LimitSlopes,
    Points,
    Results,
    ResultSlopes,
    SlopedDesigns,
)

KEPT = 64  # designs kept at all points of their envelope, some 2 MB each

Point = Float[np.ndarray, " dimension"]


class DesignsInEnvelope:
    """Every limit of a design at every point of the file's envelope, as one row of numbers,
    and what its ripple there adds to the objective.

    Limits are drawn tighter by `envelope_safety`, as in every search, so that they hold
    between the points too.

    Raises
    ------
    InputError
        Without `[design_space]`.
    """

    def __init__(self, file: MotorFile) -> None:
        if file.design_space is None:
            raise missing_design_space(file.path)
        self._system, self._space = file.system, file.design_space
        self._goal = EnvelopeGoal(file)
        self._kept = OrderedDict[bytes, SolvedAtPoints]()

    @property
    def count(self) -> int:
        return len(self._goal.pointwise_names) * self._goal.grid.count

    def sound(self, point: Point) -> bool:
        """Whether there are results at every point."""
        return not np.any(self._at(point).found.faults)

    def values(self, point: Point) -> Float[np.ndarray, " limit"]:
        """Each kept when at most 0."""
        found = self._goal.limits(self._at(point).found)
        return np.concatenate(
            [found[name] + envelope_safety(name) for name in self._goal.pointwise_names]
        )

    def slopes(self, point: Point) -> Float[np.ndarray, "limit dimension"]:
        """Their derivatives; nothing is solved again where `values` was just asked."""
        found = self._goal.limit_slopes(self._at(point).slopes())
        return np.concatenate([found[name] for name in self._goal.pointwise_names])

    def ripple_term(self, point: Point) -> float:
        """What the ripple at all points adds to the objective."""
        return self._goal.ripple_term(self._at(point).found)

    def ripple_term_slopes(self, point: Point) -> Point:
        """Its derivatives."""
        solved = self._at(point)
        return self._goal.ripple_term_slopes(solved.found, solved.slopes())

    def _at(self, point: Point) -> SolvedAtPoints:
        key = point.tobytes()
        if key not in self._kept:
            goal = self._goal
            self._kept[key] = solved_at_points(
                self._space,
                self._system,
                goal.goal,
                goal.envelope,
                goal.grid,
                point,
                lambda: applied(self._space, self._system, point),
            )
            if len(self._kept) > KEPT:
                self._kept.popitem(last=False)
        return self._kept[key]


class EnvelopedDesigns:
    """What other designs say, with a limit more for each point of the file's envelope."""

    def __init__(self, designs: SlopedDesigns, file: MotorFile) -> None:
        self._designs, self._inside = designs, DesignsInEnvelope(file)

    def values(self, points: Points) -> tuple[Results, Limits]:
        results, limits = self._designs.values(points)
        sound = np.array([self._inside.sound(point) for point in points])
        inside = np.array([self._inside.values(point) for point in points])
        results = np.where(sound[:, None, None], results, np.nan)
        return results, np.concatenate([limits, inside], axis=1)

    def slopes(self, points: Points) -> tuple[Results, ResultSlopes, LimitSlopes]:
        results, of_results, of_limits = self._designs.slopes(points)
        inside = np.array([self._inside.slopes(point) for point in points])
        return results, of_results, np.concatenate([of_limits, inside], axis=1)


class EnvelopedFunction:
    """A function of a design, completed by the design's envelope as drawn.

    A limit more for each point, and the ripple there in the objective.

    Parameters
    ----------
    function
        Which does not know the envelope.
    """

    def __init__(self, function: RobustFunction, inside: DesignsInEnvelope) -> None:
        self._function, self._inside = function, inside

    def problem(self, dimension: int, constraint_count: int) -> Problem:
        """For a search; `constraint_count` are the limits of the function alone."""

        def evaluate(points: Points) -> list[Outputs]:
            return [self._outputs(point) for point in points]

        return Problem(dimension, constraint_count + self._inside.count, evaluate)

    def slopes(self, point: Point) -> tuple[Point, LimitSlopes]:
        """Gradients of the objective and of all limits, at a design that did not fail."""
        objective, limits = self._function.slopes(point)
        objective = objective + self._inside.ripple_term_slopes(point)
        return objective, np.concatenate([limits, self._inside.slopes(point)])

    def _outputs(self, point: Point) -> Outputs:
        objective, limits, approximation, failure = self._function.outputs(point)
        inside = np.full(self._inside.count, np.nan)
        if failure is None and self._inside.sound(point):
            inside = self._inside.values(point)
            objective += self._inside.ripple_term(point)
        elif failure is None:
            failure = "no results in the envelope"
        return objective, np.concatenate([limits, inside]), approximation, failure


__all__ = ["DesignsInEnvelope", "EnvelopedDesigns", "EnvelopedFunction"]

"""Slopes from differences of evaluations, with a step that the noise in them allows.

A model that iterates to a tolerance, or steps through time as it sees fit, answers two near
points with a noise of its own. Its size is seen in differences of high order, where what is
smooth has vanished (Hamming 1962; Moré and Wild 2011); a step must be so long that what the
model does over it is a hundred times that.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from camring.search.descent.path import Known, Point
from camring.search.problem import Evaluation

SHORTEST, LONGEST = 2.0**-20, 2.0**-8  # box widths: steps of differences
QUIET = 0.01  # noise in a slope over the slope
ROWS = 3  # evaluations in a row, beside the first, that noise is measured on
TRIES = 3  # steps at which it is
THIRD_ORDER = np.array([-1.0, 3.0, -3.0, 1.0]) / np.sqrt(20.0)
"""Of four values in a row: their third difference, over its deviation where they are noise of 1."""
LEAST_SHARE = 0.1  # of the steepest output: a slope that is flatter than that need not be exact
ROUNDING = 8 * np.finfo(float).eps  # of an output: no noise of the model's

Outputs = Float[np.ndarray, " output"]


class NoSlopes(Exception):
    """Differences say nothing, whatever the step."""


class Differences:
    """Forward differences, one evaluation a variable; into the box where that ends.

    Parameters
    ----------
    step
        In box widths.
    noise
        Of the objective, over its size.
    """

    def __init__(self, known: Known, step: float, noise: float) -> None:
        self._known, self.step, self.noise = known, step, noise
        self._found: dict[bytes, tuple[Point, Float[np.ndarray, "constraint dimension"]]] = {}

    @classmethod
    def measured(cls, known: Known, start: Evaluation, sizes: Outputs) -> "Differences":
        """With the shortest step that noise allows, measured at a point that did not fail.

        Parameters
        ----------
        sizes
            Of the objective and of each constraint, by which noise and slopes are compared.

        Raises
        ------
        NoSlopes
            When no step is long enough, or the objective is the same everywhere there.
        """
        step = SHORTEST
        for _ in range(TRIES):
            row = _row(known, start, step)
            if row is None:  # where every side fails noise cannot be measured
                return cls(known, step, 0.0)
            values = np.array([outputs_of(each) for each in row]) / sizes
            if np.all(values[:, 0] == values[0, 0]):
                raise NoSlopes(
                    f"The objective is the same {step:.1g} box widths apart: no descent can be had "
                    "from differences."
                )
            noise = np.abs(THIRD_ORDER @ values)
            noise[noise <= ROUNDING * np.abs(values).max(axis=0)] = 0.0
            slopes = np.abs(values[-1] - values[0]) / (ROWS * step)
            counted = np.maximum(slopes, LEAST_SHARE * slopes.max())
            needed = float(np.max(_ratio(noise, QUIET * counted)))
            if needed <= step:
                return cls(known, step, float(noise[0]))
            if needed > LONGEST:
                break
            step = 2.0 ** np.ceil(np.log2(needed))
        raise NoSlopes(
            f"Evaluations {step:.1g} box widths apart differ by noise as much as by the design: "
            "no descent can be had from their differences."
        )

    def __call__(self, point: Point) -> tuple[Point, Float[np.ndarray, "constraint dimension"]]:
        """Slopes of the objective and of each constraint; 0 along what fails both ways."""
        key = point.tobytes()
        if key not in self._found:
            here = self._known.at(point)
            moved = _moved(point, self.step)
            columns = []
            for axis, there in enumerate(moved):
                found = self._known.at(there, moved[axis + 1 :])
                if found.failed:
                    other = point.copy()
                    other[axis] -= there[axis] - point[axis]
                    if 0 <= other[axis] <= 1:
                        found = self._known.at(other, moved[axis + 1 :])
                columns.append(_slope(here, found, axis))
            matrix = np.array(columns).T
            self._found[key] = matrix[0], matrix[1:]
        return self._found[key]


def _moved(point: Point, step: float) -> list[Point]:
    """One step along each axis, back where the box ends."""
    moved = np.where(point + step <= 1, point + step, point - step)
    return [np.where(np.arange(len(point)) == axis, moved, point) for axis in range(len(point))]


def _slope(here: Evaluation, there: Evaluation, axis: int) -> Outputs:
    if there.failed:
        return np.zeros(1 + len(here.constraints))
    step = there.point[axis] - here.point[axis]
    return (outputs_of(there) - outputs_of(here)) / step


def outputs_of(evaluation: Evaluation) -> Outputs:
    """The objective, then each constraint."""
    return np.array([evaluation.objective, *evaluation.constraints])


def _row(known: Known, start: Evaluation, step: float) -> Sequence[Evaluation] | None:
    """Evaluations at even steps along a diagonal into the box; None where they fail."""
    inwards = np.where(start.point <= 0.5, 1.0, -1.0)
    for way in (inwards, -inwards):
        places = [start.point + step * (k + 1) * way for k in range(ROWS)]
        if np.all((places[-1] >= 0) & (places[-1] <= 1)):
            row = [start, *(known.at(each, places[k + 1 :]) for k, each in enumerate(places))]
            if not any(each.failed for each in row):
                return row
    return None


def _ratio(noise: Outputs, slope: Outputs) -> Outputs:
    """0 where there is no noise, however flat it is there."""
    return np.divide(noise, slope, out=np.where(noise > 0, np.inf, 0.0), where=slope > 0)

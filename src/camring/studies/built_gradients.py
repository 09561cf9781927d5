"""Designs of a motor file, each built with the same chances, with slopes: what a search sees."""

import jax
import numpy as np
from jaxtyping import Float

from camring.evaluation.batch import Points, assess_and_keep, slopes_in_batch
from camring.evaluation.built_motors import tolerances_of
from camring.evaluation.evaluator import applied
from camring.files.motor import MotorFile, missing_design_space
from camring.objective.design_space import DesignSpace
from camring.objective.tolerances import ToleratedSpace
from camring.physics.batch_cycle import BatchResolution, fits
from camring.programs.compiled import assess_solved, slopes, solve
from camring.search.scatter.robust import Scattered, ScatteredSlopes

KEPT = 2  # designs whose cycles are kept for their slopes


class BuiltDesigns:
    """Objective (without penalty) and limits of designs, each at the same deviates.

    Side by side where the motor can be simulated in batches, else one by one; at final
    resolution either way, for at coarser ones lowest pressures are wrong by some per cent.

    Raises
    ------
    InputError
        Without `[design_space]` or `[tolerances]`.
    """

    def __init__(self, file: MotorFile, deviates: Float[np.ndarray, "sample deviate"]) -> None:
        if file.design_space is None:
            raise missing_design_space(file.path)
        self.space: DesignSpace = file.design_space
        self._file, self._deviates = file, deviates
        self._about = tolerances_of(file).about(file.design_space)
        self._gradients = _InBatch if fits(file.system.motor) else _OneByOne
        self._solved: dict[bytes, _InBatch | _OneByOne] = {}

    def scattered(self, point: Float[np.ndarray, " dimension"]) -> Scattered:
        """One design with every deviate."""
        return self._at(point).scattered

    def slopes(self, point: Float[np.ndarray, " dimension"]) -> ScatteredSlopes:
        """Their slopes by the design's coordinates; nothing is solved again."""
        return self._at(point).slopes(self.space.dimension)

    def _at(self, point: Float[np.ndarray, " dimension"]) -> "_InBatch | _OneByOne":
        key = np.asarray(point, dtype=float).tobytes()
        if key not in self._solved:
            while len(self._solved) >= KEPT:
                self._solved.pop(next(iter(self._solved)))
            here = np.broadcast_to(point, (len(self._deviates), len(point)))
            points = np.concatenate([here, self._deviates], axis=1)
            self._solved[key] = self._gradients(self._file, self._about, points)
        return self._solved[key]


class _InBatch:
    """One design, all its samples side by side."""

    def __init__(self, file: MotorFile, about: ToleratedSpace, points: Points) -> None:
        self._given = about, file.system, file.goal, points
        self._names = file.goal.constraints.names()  # in their order; a dictionary's is another
        self._cycles, found = assess_and_keep(*self._given, BatchResolution())
        sound = np.all(np.asarray(found.faults) == 0, axis=0)
        self.scattered = Scattered(
            np.where(sound, found.physical_objective, np.nan),
            np.stack([np.asarray(found.constraints[name]) for name in self._names]),
        )

    def slopes(self, first: int) -> ScatteredSlopes:
        found = slopes_in_batch(*self._given, self._cycles, BatchResolution(), first)
        return ScatteredSlopes(
            np.asarray(found.objective), np.stack([found.constraints[n] for n in self._names])
        )


class _OneByOne:
    """The same for motors that do not go in a batch."""

    def __init__(self, file: MotorFile, about: ToleratedSpace, points: Points) -> None:
        self._about, self._file, self._points = about, file, points
        self._names = file.goal.constraints.names()
        self._solved = [solve(applied(about, file.system, each), file.goal) for each in points]
        assessed = [jax.device_get(assess_solved(each, file.goal)) for each in self._solved]
        sound = [not np.any(each.faults) for each in assessed]
        self.scattered = Scattered(
            np.where(sound, [each.physical_objective for each in assessed], np.nan),
            np.array([[each.constraints[n] for n in self._names] for each in assessed]).T,
        )

    def slopes(self, first: int) -> ScatteredSlopes:
        goal = self._file.goal
        found = [
            jax.device_get(slopes(self._about, self._file.system, point, solved, goal))
            for point, solved in zip(self._points, self._solved, strict=True)
        ]
        limits = [[each.constraints[name] for name in self._names] for each in found]
        return ScatteredSlopes(
            np.array([each.objective for each in found]).T[:first],
            np.transpose(limits, (1, 2, 0))[:, :first],
        )


__all__ = ["BuiltDesigns"]

"""Rows of a test bench simulated with one set of constants: values of results, and slopes.

Side by side where the motor can be simulated in batches. Rows whose results two
resolutions do not agree on at the constants that a fit begins with, and rows with a
fault, go to the solver for one motor.
"""

from collections.abc import Sequence
from functools import partial
from typing import NamedTuple, TypeVar

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float, Int

from camring.evaluation.simulations import (
    agreed,
    in_chunks,
    measured,
    on_all_cores,
    stacked,
)
from camring.objective.design_space import AbstractSpace
from camring.objective.measurable import measurable_of_rows, measurable_slopes, rows_with_slopes
from camring.objective.slopes import Operated
from camring.physics.batch_cycle import COARSER, BatchResolution, fits
from camring.physics.motor import Motor
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint
from camring.physics.system import System
from camring.programs.batch_program import BatchProgram
from camring.programs.compiled import simulate_compiled
from camring.programs.motor_program import motor_program

TOGETHER = 8
"""Directions in one call for one motor: the same program for any number of them up to it."""

RESOLUTION = BatchResolution.fine().second_solution(COARSER)

_rows_with_slopes = motor_program(rows_with_slopes)
_side_by_side = BatchProgram(measurable_of_rows)
_one_by_one = motor_program(measurable_slopes)

Tree = TypeVar("Tree")


class Simulated(NamedTuple):
    """What rows came to, in their order.

    Attributes
    ----------
    values
        Each result, (row,), SI.
    slopes
        By the coordinates, (coordinate, row).
    faults
        Sums of `Fault` bits; zero is sound.
    """

    values: dict[str, Float[np.ndarray, " row"]]
    slopes: dict[str, Float[np.ndarray, "coordinate row"]]
    faults: Int[np.ndarray, " row"]


class BenchRows:
    """Operating points with their oils, simulated as often as asked.

    Parameters
    ----------
    space
        Whose coordinates are moved, of a system with this motor and any of the oils.
    conditions
        Of each row.
    names
        Of the results that are wanted, of `objective.measurable.MEASURABLE`.
    """

    def __init__(
        self,
        space: AbstractSpace,
        motor: Motor,
        operating_points: Sequence[tuple[OperatingPoint, AbstractFluid]],
        names: Sequence[str],
        harmonics: int,
    ) -> None:
        self._space, self._motor, self._harmonics = space, motor, harmonics
        self._names = tuple(names)
        self._points = stacked([point for point, _ in operating_points])
        self._fluids = stacked([fluid for _, fluid in operating_points])
        self._singly: Bool[np.ndarray, " row"] | None = None

    def __call__(self, unit_point: Float[np.ndarray, " coordinate"]) -> Simulated:
        """Every row at a point of the unit box of the space."""
        at = jnp.asarray(unit_point)
        rows, along = jax.device_get(
            _rows_with_slopes(self._space, self._motor, self._fluids, self._points, at)
        )
        if self._singly is None:
            self._singly = self._doubtful(rows)
        alone, parts = np.flatnonzero(self._singly), []
        if not np.all(self._singly):
            places = np.flatnonzero(~self._singly)
            found = in_chunks(self._batch, _of((rows, along), places))
            sound = found.faults == 0
            alone = np.concatenate([alone, places[~sound]])
            parts.append((places[sound], _of(found, sound)))
        if len(alone):
            each = [_of((rows, along), int(place)) for place in alone]
            parts.append((alone, stacked(on_all_cores(self._alone, each))))
        order = np.argsort(np.concatenate([places for places, _ in parts]))
        return jax.tree.map(
            lambda *leaves: np.concatenate(leaves, axis=-1)[..., order],
            *(found for _, found in parts),
        )

    def _batch(self, some: tuple[System, System]) -> Simulated:
        found = _side_by_side(*some, self._names, self._harmonics, RESOLUTION)
        return Simulated(*jax.device_get(found))

    def _alone(self, row: tuple[System, System]) -> Simulated:
        here, along = row
        (point,) = here.operating_points
        cycle = simulate_compiled(here.motor, here.fluid, point)
        count = len(jax.tree.leaves(along)[0])
        size = -(-count // TOGETHER) * TOGETHER

        def padded(slope: np.ndarray | None, number: np.ndarray | None) -> np.ndarray | None:
            if number is None:  # a part that the motor does without
                return None
            whole = np.zeros((size, *np.shape(number)))
            if slope is not None:
                whole[:count] = slope
            return whole

        whole = jax.tree.map(padded, along, here, is_leaf=lambda leaf: leaf is None)
        moved = Operated(whole.motor, whole.fluid, whole.operating_points[0])
        values, slopes = jax.device_get(_one_by_one(cycle, moved, self._names, self._harmonics))
        cut = {name: each[:count] for name, each in slopes.items()}
        return Simulated(values, cut, np.asarray(cycle.verdict.code))

    def _doubtful(self, rows: System) -> Bool[np.ndarray, " row"]:
        """Rows that batches are not accurate enough for; all where the motor is not for them."""
        count = jax.tree.leaves(rows)[0].shape[-1]
        if not fits(self._motor):
            return np.ones(count, dtype=bool)
        fine, coarser = (
            in_chunks(partial(measured, harmonics=self._harmonics, filled=share), rows)
            for share in (1.0, COARSER)
        )
        return ~agreed(fine, coarser, self._names)


def _of(tree: Tree, which: np.ndarray | int) -> Tree:
    return jax.tree.map(lambda leaf: leaf[..., which], tree)

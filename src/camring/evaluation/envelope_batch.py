"""A design at every point of an envelope, and how what is found there changes with it.

Side by side where the motor can be simulated in batches, else point by point.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int

from camring.evaluation.batch import (
    assess_batch,
    batch_faults,
    batch_slopes,
    solve_batch,
)
from camring.metrics.summary import Metrics
from camring.objective.design_space import AbstractSpace
from camring.objective.envelope import (
    conditions_of,
    envelope_of_system,
    envelope_with_slopes,
    names_in_envelope,
)
from camring.objective.objective import Goal
from camring.physics.batch_cycle import BatchResolution, fits
from camring.physics.envelope import Envelope, EnvelopeGrid
from camring.physics.system import System
from camring.programs.compiled import (
    assess_solved,
    slopes_with_results,
    solve,
)
from camring.programs.motor_program import motor_program

SEARCHED = BatchResolution(elements=160, oversampling=8)
"""How finely a search sees a point: limits to 2e-3 of their scales, which it keeps as a margin
(`outcome.ENVELOPE_SAFETY`), ripple to 1e-4; gradients cost a quarter of those at final
resolution."""

SLOPED_RESULTS = ("torque_ripple", "efficiency")
"""Results whose derivatives the limits against the given motor and the objective use."""

prepared = motor_program(envelope_of_system)
prepared_with_slopes = motor_program(envelope_with_slopes)


@dataclass(frozen=True, eq=False)
class AtPoints:
    """A motor at every point of a grid.

    Attributes
    ----------
    limits
        Each limit of the file as a `g <= 0`, shape (point,).
    metrics
        Every result, leaves (point,), SI.
    faults
        Of each point its sum of `Fault` bits; zero is sound.
    """

    grid: EnvelopeGrid
    limits: Mapping[str, Float[np.ndarray, " point"]]
    metrics: Metrics
    faults: Int[np.ndarray, " point"]


@dataclass(frozen=True, eq=False)
class SlopesAtPoints:
    """Derivatives by the coordinates of the design space, each (point, coordinate)."""

    limits: Mapping[str, Float[np.ndarray, "point coordinate"]]
    results: Mapping[str, Float[np.ndarray, "point coordinate"]]


def at_points(
    system: System,
    goal: Goal,
    envelope: Envelope,
    grid: EnvelopeGrid,
    resolution: BatchResolution | None = None,
) -> AtPoints:
    """One motor at every point of a grid of its envelope, as finely as maps unless given."""
    if not fits(system.motor):
        return _OneByOne(system, goal, envelope, grid).found
    designs = prepared(system, conditions_of(envelope, grid))

    _, found = _assessed(goal, grid, resolution or BatchResolution.fine(), designs)
    return found


class SolvedAtPoints(Protocol):
    """A design of a space at every point, kept so that its slopes need no second solution."""

    found: AtPoints

    def slopes(self) -> SlopesAtPoints: ...


def solved_at_points(
    space: AbstractSpace,
    system: System,
    goal: Goal,
    envelope: Envelope,
    grid: EnvelopeGrid,
    point: Float[np.ndarray, " coordinate"],
    design: Callable[[], System],
) -> SolvedAtPoints:
    """The design at a point of the unit box, at every point of a grid.

    Parameters
    ----------
    system, design
        The one that the space belongs to, and what it becomes at the point.
    """
    if fits(system.motor):
        return _SideBySide(space, system, goal, envelope, grid, point)
    return _OneByOne(design(), goal, envelope, grid, (space, system, point))


class _SideBySide:
    def __init__(
        self,
        space: AbstractSpace,
        system: System,
        goal: Goal,
        envelope: Envelope,
        grid: EnvelopeGrid,
        point: Float[np.ndarray, " coordinate"],
    ) -> None:
        self._goal = goal
        conditions = conditions_of(envelope, grid)
        self._designs, self._along = prepared_with_slopes(
            space, system, jnp.asarray(point[None]), conditions
        )
        self._cycles, self.found = _assessed(goal, grid, SEARCHED, self._designs)

    def slopes(self) -> SlopesAtPoints:
        found = batch_slopes(
            self._designs, self._along, self._cycles, self._goal, SEARCHED, SLOPED_RESULTS
        )
        limits, results = jax.tree.map(
            lambda leaf: np.asarray(leaf).T, (found.constraints, found.results[0])
        )
        return SlopesAtPoints(_only_in_envelope(self._goal, limits), results)


class _OneByOne:
    """For motors that cannot be simulated side by side."""

    def __init__(
        self,
        design: System,
        goal: Goal,
        envelope: Envelope,
        grid: EnvelopeGrid,
        space: tuple[AbstractSpace, System, Float[np.ndarray, " coordinate"]] | None = None,
    ) -> None:
        self._goal, self._envelope, self._grid, self._space = goal, envelope, grid, space
        self._solved = [solve(self._at(design, place), goal) for place in range(grid.count)]
        assessed = [jax.device_get(assess_solved(each, goal)) for each in self._solved]
        limits, metrics = (
            jax.tree.map(lambda *each: np.array(each), *part)
            for part in (
                [each.constraints for each in assessed],
                [each.metrics[0] for each in assessed],
            )
        )
        faults = np.array([int(each.faults[0]) for each in assessed])
        self.found = AtPoints(grid, _only_in_envelope(goal, limits), metrics, faults)

    def _at(self, system: System, place: int) -> System:
        fluids = self._envelope.fluids
        fluid = fluids[self._grid.fluid[place]] if fluids else system.fluid
        return System(system.motor, fluid, (self._grid.operating_point(place),))

    def slopes(self) -> SlopesAtPoints:
        assert self._space is not None
        space, system, point = self._space
        limits, results = [], []
        for place, solved in enumerate(self._solved):
            of_limits, of_results = jax.device_get(
                slopes_with_results(
                    space, self._at(system, place), point, solved, self._goal, SLOPED_RESULTS
                )
            )
            limits.append(of_limits.constraints)
            results.append({name: of_results[0][name] for name in SLOPED_RESULTS})
        of_limits, of_results = (
            jax.tree.map(lambda *each: np.stack(each), *part) for part in (limits, results)
        )
        return SlopesAtPoints(_only_in_envelope(self._goal, of_limits), of_results)


def _only_in_envelope(goal: Goal, limits: Mapping[str, Any]) -> dict[str, Any]:
    return {name: limits[name] for name in names_in_envelope(goal.constraints)}


def _assessed(
    goal: Goal, grid: EnvelopeGrid, resolution: BatchResolution, designs: System
) -> tuple[Any, AtPoints]:
    """Cycles of all points side by side, and what is found of them."""
    cycles, metrics = solve_batch(designs, goal.harmonics, resolution)
    faults = batch_faults(cycles)
    limits = assess_batch(designs, metrics, faults, goal).constraints
    limits, results, faults = jax.tree.map(np.asarray, (limits, metrics[0], faults[0]))
    return cycles, AtPoints(grid, _only_in_envelope(goal, limits), results, faults)

"""A design at its operating points, and how objective and limits there change with it.

Side by side where the motor can be simulated in batches, else one by one, as where a batch finds
a fault: then the solver for one motor decides.
"""

from dataclasses import fields
from functools import cached_property
from typing import NamedTuple, Protocol, TypeAlias

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from camring.evaluation.batch import batch_faults, batch_slopes, solve_batch
from camring.metrics.summary import Metrics
from camring.numerics.quantity import real
from camring.objective.batch import say_of_designs
from camring.objective.design_space import DesignSpace
from camring.objective.envelope import Conditions, envelope_with_slopes
from camring.objective.objective import Assessment, Goal
from camring.objective.slopes import Slopes, assessed_slopes, directions, results_used
from camring.physics.batch_cycle import BatchResolution, fits
from camring.physics.operating_point import OperatingPoint
from camring.physics.system import System
from camring.programs.batch_program import row_width
from camring.programs.compiled import Solved, assess_solved, slopes, solve
from camring.programs.motor_program import motor_program

FINE = BatchResolution.fine()
"""Objective to 1e-6, limits to 1e-5, all results to 1e-4: what a study keeps of a design."""

RESULTS = tuple(each.name for each in fields(Metrics))

Point: TypeAlias = Float[np.ndarray, " coordinate"]


class SolvedDesign(Protocol):
    """A design at its operating points, kept so that its slopes need no second solution."""

    system: System

    @property
    def assessment(self) -> Assessment:
        """What the goal says of it, NumPy arrays."""
        ...

    def slopes(self) -> Slopes:
        """Derivatives of objective and limits by the coordinates, NumPy arrays."""
        ...


class OperatingPoints:
    """The designs of a space at the operating points of a system.

    Parameters
    ----------
    space
        Of the coordinates; it may move operating points too.
    system
        The one that the space belongs to.
    """

    def __init__(self, space: DesignSpace, system: System, goal: Goal) -> None:
        self._given = space, system, goal
        paths = [path for each in space.variables for some in each.leaves for path in some]
        moved = any(path.startswith("operating_points") for path in paths)
        # The lobes that idle belong to a batch's structure: modes go one by one.
        modes = any(each.idle_lobes for each in system.operating_points)
        self._side_by_side = fits(system.motor) and not moved and not modes

    def solved(self, point: Point, design: System) -> SolvedDesign:
        """The design at a point of the unit box, which becomes a system there."""
        if self._side_by_side:
            found = _SideBySide(*self._given, self._conditions, self._members, point, design)
            if found.sound:
                return found
        return _OneByOne(*self._given, point, design)

    @cached_property
    def _members(self) -> "_Members":
        """Those that turn backwards last, as a batch wants them."""
        points = self._given[1].operating_points
        copies = max(1, row_width() // len(points))
        every = [(copy, place) for copy in range(copies) for place in range(len(points))]
        every.sort(key=lambda member: points[member[1]].reverse)
        return _Members(*zip(*every, strict=True))

    @cached_property
    def _conditions(self) -> Conditions:
        given = self._given[1].operating_points
        points = [given[place] for place in self._members.places]

        def together(name: str) -> Array:
            return real(np.array([float(getattr(each, name)) for each in points]))

        point = OperatingPoint(
            shaft_speed=together("shaft_speed"),
            supply_pressure=together("supply_pressure"),
            return_pressure=together("return_pressure"),
            case_pressure=together("case_pressure"),
            weight=together("weight"),
        )
        return Conditions(point, None, sum(each.reverse for each in points))


class _Members(NamedTuple):
    """Who stands in a batch: each operating point as often as a row of machine code has numbers
    left, for each of its copies then takes a share of the coordinates."""

    copies: tuple[int, ...]
    places: tuple[int, ...]
    """Which operating point."""

    def of(self, copy: int) -> list[int]:
        """Members that are this copy of each operating point, in the points' order."""
        mine = [member for member, its in enumerate(self.copies) if its == copy]
        return sorted(mine, key=lambda member: self.places[member])


class _SideBySide:
    def __init__(
        self,
        space: DesignSpace,
        given: System,
        goal: Goal,
        conditions: Conditions,
        members: _Members,
        point: Point,
        system: System,
    ) -> None:
        self._space, self._given, self._goal = space, given, goal
        self._point, self.system = point, system
        self._designs, self._along = _prepared_in_shares(
            space, given, jnp.asarray(point[None]), conditions, members.copies
        )
        self._members, self._places = members, members.of(0)
        self._cycles, (results,) = solve_batch(self._designs, goal.harmonics, FINE)
        (faults,) = np.asarray(batch_faults(self._cycles))
        self._faults = faults[self._places]
        self._metrics = jax.tree.map(lambda leaf: np.asarray(leaf)[self._places], results)
        self._values = np.stack([getattr(self._metrics, name) for name in RESULTS])

    @property
    def sound(self) -> bool:
        return not np.any(self._faults)

    @cached_property
    def assessment(self) -> Assessment:
        found = jax.device_get(
            _assessed(self.system, self._goal, real(self._values), jnp.asarray(self._faults))
        )
        metrics = tuple(
            jax.tree.map(lambda leaf, at=at: leaf[at], self._metrics)
            for at in range(len(self._places))
        )
        return Assessment(**{**vars(found), "metrics": metrics, "faults": self._faults})

    def slopes(self) -> Slopes:
        used = results_used(self._goal)
        found = batch_slopes(self._designs, self._along, self._cycles, self._goal, FINE, used)
        by_share = np.stack([np.asarray(found.results[0][name]) for name in used])
        copies = range(max(self._members.copies) + 1)
        whole = np.concatenate([by_share[..., self._members.of(copy)] for copy in copies], axis=1)
        of_results = whole[:, : len(self._point)]
        return jax.device_get(
            _sloped(
                self._space,
                self._given,
                real(self._point),
                self.system,
                self._goal,
                real(self._values),
                real(of_results),
            )
        )


@motor_program
def _prepared_in_shares(
    space: DesignSpace,
    given: System,
    points: Float[Array, "design coordinate"],
    conditions: Conditions,
    copies: tuple[int, ...],
) -> tuple[System, System]:
    """Members, and their derivatives by those coordinates that each one's copy is to take."""
    designs, along = envelope_with_slopes(space, given, points, conditions)
    count = max(copies) + 1
    share = -(-points.shape[-1] // count)

    def shared_out(leaf: Float[Array, "coordinate ..."]) -> Float[Array, "share ..."]:
        filled = jnp.pad(leaf, [(0, share * count - leaf.shape[0]), *[(0, 0)] * (leaf.ndim - 1)])
        parts = [filled[copy * share :][:share, ..., at] for at, copy in enumerate(copies)]
        return jnp.stack(parts, axis=-1)

    return designs, jax.tree.map(shared_out, along)


@motor_program
def _assessed(
    system: System,
    goal: Goal,
    values: Float[Array, "result point"],
    faults: Int[Array, " point"],
) -> Assessment:
    """What a goal says of results, without the results themselves."""
    return say_of_designs(system, _metrics(values), faults, goal)


@motor_program
def _sloped(
    space: DesignSpace,
    given: System,
    point: Float[Array, " coordinate"],
    design: System,
    goal: Goal,
    values: Float[Array, "result point"],
    of_results: Float[Array, "used coordinate point"],
) -> Slopes:
    """Derivatives of what a goal says, from those of the results that it uses."""
    along = directions(space, given, point)
    used = [
        dict(zip(results_used(goal), of_results[..., at], strict=True))
        for at in range(of_results.shape[-1])
    ]
    return assessed_slopes(design, goal, _metrics(values), along, used)


def _metrics(values: Float[Array, "result point"]) -> tuple[Metrics, ...]:
    """One for each operating point; one array travels faster than many numbers."""
    return tuple(Metrics(**dict(zip(RESULTS, each, strict=True))) for each in values.T)


class _OneByOne:
    def __init__(
        self, space: DesignSpace, given: System, goal: Goal, point: Point, system: System
    ) -> None:
        self._space, self._given, self._goal, self._point = space, given, goal, point
        self.system = system
        self._solved: Solved = solve(system, goal)

    @cached_property
    def assessment(self) -> Assessment:
        return jax.device_get(assess_solved(self._solved, self._goal))

    def slopes(self) -> Slopes:
        return jax.device_get(
            slopes(self._space, self._given, self._point, self._solved, self._goal)
        )

"""A goal's say of many designs at once, side by side (`numerics/lanes.py`).

Designs are made and judged by the same functions as one by one, under `vmap`; what lies
between, all of the work, is written for lanes and compiled by `numerics/native`.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from camring.metrics.lane_summary import summarise_lanes
from camring.metrics.summary import Metrics
from camring.objective.design_space import AbstractSpace
from camring.objective.objective import Assessment, Goal, judge
from camring.physics.lane_cycle import LaneCycle, LanesLook, neighbour_lanes, simulate_lanes
from camring.physics.system import System


def designs_in_lanes(
    space: AbstractSpace, system: System, points: Float[Array, "lane coordinate"]
) -> System:
    """The system at each point of the unit box, every leaf with a lane for each."""
    return jax.vmap(lambda point: space.apply(system, point), out_axes=-1)(points)


def solve_designs(designs: System, look: LanesLook) -> tuple[LaneCycle, ...]:
    """Every operating point of every design."""
    return tuple(
        simulate_lanes(designs.motor, designs.fluid, point, look)
        for point in designs.operating_points
    )


def summarise_designs(
    found: tuple[LaneCycle, ...], harmonics: int, look: LanesLook
) -> tuple[Metrics, ...]:
    """Results of every operating point of every design, leaves (lane,)."""
    return tuple(summarise_lanes(each, harmonics, look.oversampling) for each in found)


def faults_of(found: tuple[LaneCycle, ...]) -> Int[Array, "operating_point lane"]:
    """Verdicts of every operating point of every design; zero is sound."""
    return jnp.stack([each.cycle.verdict.code for each in found])


def measure_designs(
    designs: System, harmonics: int, look: LanesLook
) -> tuple[tuple[Metrics, ...], Int[Array, "operating_point lane"]]:
    """Results and verdicts of every operating point of every design."""
    found = solve_designs(designs, look)
    return summarise_designs(found, harmonics, look), faults_of(found)


def solve_and_measure_designs(
    designs: System, harmonics: int, look: LanesLook
) -> tuple[tuple[LaneCycle, ...], tuple[Metrics, ...]]:
    """The cycles themselves, and results."""
    found = solve_designs(designs, look)
    return found, summarise_designs(found, harmonics, look)


def say_of_designs(
    designs: System,
    metrics: tuple[Metrics, ...],
    faults: Int[Array, "operating_point lane"],
    goal: Goal,
) -> Assessment:
    """What a goal says of each design, without the results, which the caller has."""
    said = judge(designs, goal, metrics, faults)
    return eqx.tree_at(lambda each: (each.metrics, each.faults), said, ((), None))


class ManySlopes(NamedTuple):
    """Derivatives by the unit coordinates, shape (coordinate, lane)."""

    objective: Float[Array, "coordinate lane"]
    """Of `J_phys`, the objective without penalty."""
    constraints: dict[str, Float[Array, "coordinate lane"]]
    results: tuple[dict[str, Float[Array, "coordinate lane"]], ...]
    """At each operating point, of the results asked for."""


def designs_with_slopes(
    space: AbstractSpace,
    system: System,
    points: Float[Array, "lane coordinate"],
    first: int | None = None,
) -> tuple[System, System]:
    """`designs_in_lanes`, and their derivatives by each coordinate along a new first axis.

    There is no derivative (None) of numbers that the space leaves alone.
    """
    given = jax.tree.leaves(system)

    def moved(point: Float[Array, " coordinate"]) -> System:
        design = space.apply(system, point)
        leaves, structure = jax.tree.flatten(design)
        kept = [
            None if mine is theirs else mine for mine, theirs in zip(leaves, given, strict=True)
        ]
        return jax.tree.unflatten(structure, kept)

    _, linear = jax.linearize(jax.vmap(moved, out_axes=-1), points)
    along = jnp.eye(points.shape[-1])[:first, None]
    slopes = jax.vmap(linear)(jnp.broadcast_to(along, (len(along), *points.shape)))
    return designs_in_lanes(space, system, points), slopes


def slopes_of_designs(
    designs: System,
    along: System,
    found: tuple[LaneCycle, ...],
    goal: Goal,
    look: LanesLook,
    results: Sequence[str] = (),
) -> ManySlopes:
    """How objective and constraints of each design change with every coordinate, exactly.

    Parameters
    ----------
    along
        Derivatives of the designs by the coordinates that count (`designs_with_slopes`).
    found
        What was solved at the points; nothing is solved again, see `neighbour_lanes`.
    results
        Names of results, such as `efficiency`, whose slopes are wanted, too.
    """
    moved = jax.tree.map(lambda slope: slope is not None, along, is_leaf=lambda leaf: leaf is None)
    numbers, rest = eqx.partition(designs, moved)

    def judged(numbers: System) -> tuple[Array, dict[str, Array], tuple[dict[str, Array], ...]]:
        designs = eqx.combine(numbers, rest)
        near = tuple(
            neighbour_lanes(known.cycle, designs.motor, designs.fluid, point, look)
            for known, point in zip(found, designs.operating_points, strict=True)
        )
        metrics = summarise_designs(near, goal.harmonics, look)
        said = judge(designs, goal, metrics, faults_of(near))
        wanted = tuple({name: getattr(each, name) for name in results} for each in metrics)
        return said.physical_objective, said.constraints, wanted

    _, linear = jax.linearize(judged, numbers)
    return ManySlopes(*_in_groups(linear, along))


TOGETHER = 3
"""Coordinates whose slopes are taken in one pass over what the design itself has left."""


def _in_groups(linear: Callable[[System], tuple], along: System) -> tuple:
    """A linear function of every entry along the first axis, some at a time."""
    count = jax.tree.leaves(along)[0].shape[0]
    groups = -(-count // TOGETHER)

    def grouped(leaf: Array) -> Array:
        missing = [(0, groups * TOGETHER - count), *((0, 0) for _ in leaf.shape[1:])]
        return jnp.pad(leaf, missing).reshape(groups, TOGETHER, *leaf.shape[1:])

    def of_group(some: System) -> tuple:
        each = [linear(jax.tree.map(lambda leaf, k=k: leaf[k], some)) for k in range(TOGETHER)]
        return jax.tree.map(lambda *parts: jnp.stack(parts), *each)

    found = jax.lax.map(of_group, jax.tree.map(grouped, along))
    return jax.tree.map(lambda leaf: leaf.reshape(-1, *leaf.shape[2:])[:count], found)

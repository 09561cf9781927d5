"""A goal's say of many designs at once, side by side (`numerics/batch.py`).

Designs are made and assessed by the same functions as one by one, under `vmap`; what lies
between, all of the work, is written for batches and compiled by `compiler`.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple, TypeVar

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from camring.metrics.batch_summary import summarise_batch
from camring.metrics.summary import Metrics
from camring.objective.design_space import AbstractSpace
from camring.objective.objective import Assessment, Goal, assessment_of
from camring.physics.batch_cycle import BatchCycle, BatchResolution
from camring.physics.heat.batch_simulation import neighbour_batch, simulate_batch
from camring.physics.system import System

Found = TypeVar("Found")


def designs_in_batch(
    space: AbstractSpace, system: System, points: Float[Array, "batch coordinate"]
) -> System:
    """The system at each point of the unit box, every leaf with the batch as its last axis."""
    return jax.vmap(lambda point: space.apply(system, point), out_axes=-1)(points)


def solve_designs(
    designs: System, resolution: BatchResolution, filled: Float[Array, " batch"] | None = None
) -> tuple[BatchCycle, ...]:
    """Every operating point of every design."""
    return tuple(
        simulate_batch(designs.motor, designs.fluid, point, resolution, filled)
        for point in designs.operating_points
    )


def summarise_designs(
    found: tuple[BatchCycle, ...], harmonics: int, resolution: BatchResolution
) -> tuple[Metrics, ...]:
    """Results of every operating point of every design, leaves (batch,)."""
    return tuple(
        summarise_batch(each, harmonics, resolution.oversampling, resolution.integrated)
        for each in found
    )


def faults_of(found: tuple[BatchCycle, ...]) -> Int[Array, "operating_point batch"]:
    """Verdicts of every operating point of every design; zero is sound."""
    return jnp.stack([each.cycle.verdict.code for each in found])


def measure_designs(
    designs: System,
    harmonics: int,
    resolution: BatchResolution,
    filled: Float[Array, " batch"] | None = None,
) -> tuple[tuple[Metrics, ...], Int[Array, "operating_point batch"]]:
    """Results and verdicts of every operating point of every design; `filled` as in
    `simulate_batch`."""
    found = solve_designs(designs, resolution, filled)
    return summarise_designs(found, harmonics, resolution), faults_of(found)


def solve_and_measure_designs(
    designs: System, harmonics: int, resolution: BatchResolution
) -> tuple[tuple[BatchCycle, ...], tuple[Metrics, ...]]:
    """The cycles themselves, and results."""
    found = solve_designs(designs, resolution)
    return found, summarise_designs(found, harmonics, resolution)


def say_of_designs(
    designs: System,
    metrics: tuple[Metrics, ...],
    faults: Int[Array, "operating_point batch"],
    goal: Goal,
) -> Assessment:
    """What a goal says of each design, without the results, which the caller has."""
    said = assessment_of(designs, goal, metrics, faults)
    return eqx.tree_at(lambda each: (each.metrics, each.faults), said, ((), None))


class ManySlopes(NamedTuple):
    """Derivatives by the unit coordinates, shape (coordinate, batch)."""

    objective: Float[Array, "coordinate batch"]
    """Of `J_phys`, the objective without penalty."""
    constraints: dict[str, Float[Array, "coordinate batch"]]
    results: tuple[dict[str, Float[Array, "coordinate batch"]], ...]
    """At each operating point, of the results asked for."""


def designs_with_slopes(
    space: AbstractSpace,
    system: System,
    points: Float[Array, "batch coordinate"],
    first: int | None = None,
) -> tuple[System, System]:
    """`designs_in_batch`, and their derivatives by each coordinate along a new first axis.

    There is no derivative (None) of numbers that the space leaves alone.
    """

    def moved(point: Float[Array, " coordinate"]) -> System:
        return where_other(space.apply(system, point), system)

    _, linear = jax.linearize(jax.vmap(moved, out_axes=-1), points)
    along = jnp.eye(points.shape[-1])[:first, None]
    slopes = jax.vmap(linear)(jnp.broadcast_to(along, (len(along), *points.shape)))
    return designs_in_batch(space, system, points), slopes


def where_other(design: System, given: System) -> System:
    """A design with None for every number that is the given system's own."""
    leaves, structure = jax.tree.flatten(design)
    own = jax.tree.leaves(given)
    kept = [None if mine is theirs else mine for mine, theirs in zip(leaves, own, strict=True)]
    return jax.tree.unflatten(structure, kept)


def slopes_of_designs(
    designs: System,
    along: System,
    found: tuple[BatchCycle, ...],
    goal: Goal,
    resolution: BatchResolution,
    results: Sequence[str] = (),
) -> ManySlopes:
    """How objective and constraints of each design change with every coordinate, exactly.

    Parameters
    ----------
    along
        Derivatives of the designs by the coordinates that count (`designs_with_slopes`).
    found
        What was solved at the points; nothing is solved again, see `neighbour_batch`.
    results
        Names of results, such as `efficiency`, whose slopes are wanted, too.
    """
    numbers, rest = moving(designs, along)

    def assessed(numbers: System) -> tuple[Array, dict[str, Array], tuple[dict[str, Array], ...]]:
        designs = eqx.combine(numbers, rest)
        near = tuple(
            neighbour_batch(known.cycle, designs.motor, designs.fluid, point, resolution)
            for known, point in zip(found, designs.operating_points, strict=True)
        )
        metrics = summarise_designs(near, goal.harmonics, resolution)
        said = assessment_of(designs, goal, metrics, faults_of(near))
        wanted = tuple({name: getattr(each, name) for name in results} for each in metrics)
        return said.physical_objective, said.constraints, wanted

    _, linear = jax.linearize(assessed, numbers)
    return ManySlopes(*in_groups(linear, along))


def moving(designs: System, along: System) -> tuple[System, System]:
    """The numbers that have a derivative, and the others."""
    moved = jax.tree.map(lambda slope: slope is not None, along, is_leaf=lambda leaf: leaf is None)
    return eqx.partition(designs, moved)


TOGETHER = 3
"""Coordinates whose slopes are taken in one pass over what the design itself has left."""


def in_groups(linear: Callable[[System], Found], along: System) -> Found:
    """A linear function of every entry along the first axis, some at a time."""
    count = jax.tree.leaves(along)[0].shape[0]
    groups = -(-count // TOGETHER)

    def grouped(leaf: Array) -> Array:
        missing = [(0, groups * TOGETHER - count), *((0, 0) for _ in leaf.shape[1:])]
        return jnp.pad(leaf, missing).reshape(groups, TOGETHER, *leaf.shape[1:])

    def of_group(some: System) -> Found:
        each = [linear(jax.tree.map(lambda leaf, k=k: leaf[k], some)) for k in range(TOGETHER)]
        return jax.tree.map(lambda *parts: jnp.stack(parts), *each)

    found = jax.lax.map(of_group, jax.tree.map(grouped, along))
    return jax.tree.map(lambda leaf: leaf.reshape(-1, *leaf.shape[2:])[:count], found)

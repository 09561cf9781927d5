"""Thousands of designs of one motor file, evaluated side by side.

Designs go through in blocks of a fixed size, so that nothing is compiled anew for
another number of them and memory stays the same for a million; a thread for each
processor core takes one block after another. Motors that cannot be simulated in a batch
(`physics.batch_cycle.fits`) go the ordinary way, slower, with the same results.
"""

import os
import threading
from collections.abc import Callable, Hashable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from camring.files.errors import InputError
from camring.metrics.summary import Metrics
from camring.objective.batch import (
    ManySlopes,
    designs_in_batch,
    designs_with_slopes,
    faults_of,
    measure_designs,
    say_of_designs,
    slopes_of_designs,
    solve_and_measure_designs,
)
from camring.objective.design_space import AbstractSpace
from camring.objective.objective import Assessment, Goal, evaluate
from camring.physics.batch_cycle import BatchCycle, BatchResolution, fits
from camring.physics.resolution import Resolution
from camring.physics.system import System
from camring.programs.batch_program import BatchProgram, native
from camring.programs.motor_program import motor_program

CHUNK = 1024
"""Designs side by side in one call of a program."""

FEW = 8
"""The same, where every design is solved by itself."""

Points = Float[np.ndarray, "design coordinate"]

# Eight numbers at once where the processor can; a pool of threads inside a program would
# only stand in the way of ours.
_OPTIONS: dict[str, Any] = {
    "xla_cpu_prefer_vector_width": 512,
    "xla_cpu_multi_thread_eigen": False,
}


def evaluate_many(
    space: AbstractSpace,
    system: System,
    goal: Goal,
    points: Points,
    resolution: BatchResolution | None = None,
    threads: int | None = None,
    chunk: int = CHUNK,
) -> Assessment:
    """Objective, terms, constraints and every result at many points of the unit box.

    Parameters
    ----------
    system
        The one that the space belongs to.
    resolution
        `BatchResolution()` for final results, `BatchResolution.search()` (the default) for
        objective terms to about 1e-4.
    threads
        One for each processor core that this process may use, unless given.
    chunk
        Designs in one call of a program; a smaller number where points come by the dozen.

    Returns
    -------
    NumPy arrays with a place for each design; terms and faults (operating point, design).
    A design whose `faults` are not zero has numbers that mean nothing.

    Raises
    ------
    InputError
        For points of another shape than (designs, coordinates), or none.

    Examples
    --------
    >>> import numpy as np
    >>> file = camring.read_motor_file("motor.toml")
    >>> points = np.random.default_rng(0).uniform(size=(50, file.design_space.dimension))
    >>> found = camring.evaluate_many(
    ...     file.design_space, file.system, file.goal, points, chunk=64
    ... )
    >>> found.objective.shape, found.faults.shape, found.metrics[0].efficiency.shape
    ((50,), (1, 50), (50,))
    """
    points = np.asarray(points, dtype=float)
    if points.ndim != 2 or points.shape[1] != space.dimension or not len(points):
        raise InputError(
            "the points",
            f"have the shape {points.shape}",
            f"give (designs, {space.dimension}), a coordinate for each of {', '.join(space.names)}",
        )
    resolution = resolution or BatchResolution.search()
    assess_chunk = _in_batch if fits(system.motor) else _one_by_one
    assessed = _assessed_by(assess_chunk, space, system, goal, resolution, chunk)
    whole = _Whole(len(points))

    def keep(start: int) -> None:
        whole.keep(start, assessed(points[start : start + chunk]))

    starts = range(0, len(points), chunk)
    program = jax.tree.structure((space, system)), goal, resolution, chunk, native()
    if program not in _compiled:  # side by side every thread would compile
        keep(starts[0])
        starts = starts[1:]
        _compiled.add(program)
    with ThreadPoolExecutor(threads or cores()) as pool:
        list(pool.map(keep, starts))
    return whole.result


_compiled: set[Hashable] = set()


class _Whole:
    """Results of chunks, put together as they come."""

    def __init__(self, designs: int) -> None:
        self._designs = designs
        self._first = threading.Lock()
        self.result: Any = None

    def keep(self, start: int, part: Assessment) -> None:
        with self._first:
            if self.result is None:
                self.result = jax.tree.map(self._allocated, part)
        for place, leaf in zip(jax.tree.leaves(self.result), jax.tree.leaves(part), strict=True):
            place[..., start : start + leaf.shape[-1]] = leaf

    def _allocated(self, leaf: np.ndarray) -> np.ndarray:
        return np.empty((*leaf.shape[:-1], self._designs), leaf.dtype)


def _assessed_by(
    assess_chunk: Callable[..., Assessment],
    space: AbstractSpace,
    system: System,
    goal: Goal,
    resolution: BatchResolution,
    chunk: int,
) -> Callable[[Points], Assessment]:
    def assessed(some: Points) -> Assessment:
        found = jax.device_get(assess_chunk(space, system, goal, padded(some, chunk), resolution))
        return jax.tree.map(lambda leaf: leaf[..., : len(some)], found)

    return assessed


def padded(points: Points, count: int) -> Points:
    """Points filled up to a count with copies of the first, shape (count, coordinate)."""
    missing = count - len(points)
    return np.concatenate([points, np.broadcast_to(points[:1], (missing, points.shape[1]))])


def _in_batch(
    space: AbstractSpace, system: System, goal: Goal, points: Points, resolution: BatchResolution
) -> Assessment:
    designs = _designs(space, system, jnp.asarray(points))
    metrics, faults = measure_batch(designs, goal.harmonics, resolution)
    return _assessed(designs, metrics, faults, goal)


def _assessed(
    designs: System, metrics: tuple[Metrics, ...], faults: jax.Array, goal: Goal
) -> Assessment:
    said = assess_batch(designs, metrics, faults, goal)
    return Assessment(**{**vars(said), "metrics": metrics, "faults": faults})


def assess_and_keep(
    space: AbstractSpace, system: System, goal: Goal, points: Points, resolution: BatchResolution
) -> tuple[tuple[BatchCycle, ...], Assessment]:
    """Some points side by side; and what was solved."""
    designs = _designs(space, system, jnp.asarray(points))
    cycles, metrics = solve_batch(designs, goal.harmonics, resolution)
    return cycles, _assessed(designs, metrics, batch_faults(cycles), goal)


def slopes_in_batch(
    space: AbstractSpace,
    system: System,
    goal: Goal,
    points: Points,
    cycles: tuple[BatchCycle, ...],
    resolution: BatchResolution,
    first: int | None = None,
    results: tuple[str, ...] = (),
) -> ManySlopes:
    """`objective.batch.slopes_of_designs` of what `assess_and_keep` solved, as NumPy arrays."""
    designs, along = _designs_with_slopes(space, system, jnp.asarray(points), first)
    return jax.device_get(batch_slopes(designs, along, cycles, goal, resolution, results))


_designs = motor_program(designs_in_batch, _OPTIONS)
measure_batch = BatchProgram(measure_designs, _OPTIONS)
solve_batch = BatchProgram(solve_and_measure_designs, _OPTIONS)
batch_faults = motor_program(faults_of, _OPTIONS)
assess_batch = motor_program(say_of_designs, _OPTIONS)
_designs_with_slopes = motor_program(designs_with_slopes, _OPTIONS)
batch_slopes = BatchProgram(slopes_of_designs, _OPTIONS)


@motor_program
def _one_by_one(
    space: AbstractSpace, system: System, goal: Goal, points: Points, resolution: BatchResolution
) -> Assessment:
    mesh = Resolution.coarse() if resolution == BatchResolution.search() else Resolution()
    assessed = jax.vmap(lambda point: evaluate(space.apply(system, point), goal, mesh))
    found = jax.lax.map(assessed, points.reshape(-1, FEW, points.shape[-1]))
    flat = jax.tree.map(lambda leaf: leaf.reshape(-1, *leaf.shape[2:]), found)
    return jax.tree.map(lambda leaf: jax.numpy.moveaxis(leaf, 0, -1), flat)


def cores() -> int:
    """Processor cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1

"""Many simulations at once: side by side, and one by one what is not good enough that way.

Everything that asks for many results (maps, sweeps, tables) comes through
`results_of_many`. Motors that batches can hold are solved twice, at two resolutions;
where these differ by more than `ACCURACY`, or a point has a fault, the solver for one
motor decides, as it does for motors of other kinds.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any, NamedTuple, TypeVar

import jax
import numpy as np
from jaxtyping import Bool, Int

from camring.evaluation.batch import cores, measure_batch
from camring.metrics.error_estimate import Floor, error_estimate, relative_error
from camring.metrics.summary import Metrics
from camring.numerics.quantity import real
from camring.physics.batch_cycle import COARSER, BatchResolution, fits
from camring.physics.motor import Motor
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint
from camring.physics.system import System
from camring.programs.compiled import simulate_compiled, summarise_compiled

CHUNK = 64
"""Simulations in one call of a program; bounds the memory whatever the number asked for."""

ACCURACY = 1e-4
"""Of each result; where a batch may be further off, the solver for one motor is asked."""

Tree = TypeVar("Tree")
Given = TypeVar("Given")
Found = TypeVar("Found")


class Many(NamedTuple):
    """Results of many simulations.

    Attributes
    ----------
    metrics
        Every leaf (simulation,), in the order asked for; NumPy arrays, SI.
    faults
        For each simulation its sum of `Fault` bits; zero is sound.
    """

    metrics: Metrics
    faults: Int[np.ndarray, " many"]


def results_of_many(
    motors: Motor, fluids: AbstractFluid, points: OperatingPoint, harmonics: int = 600
) -> Many:
    """Every result of many motors, each with its oil at its operating point.

    Parameters
    ----------
    motors, fluids, points
        Each leaf has a last axis of one and the same length: see `repeated` and `stacked`.
    harmonics
        Highest shaft order of the spectra.

    Notes
    -----
    A motor without a periodic solution sinks nobody else: its fault says so.
    """
    systems = System(motors, fluids, (points,))
    count = jax.tree.leaves(systems)[0].shape[-1]
    if not fits(motors):
        return one_by_one(systems, np.arange(count), harmonics)
    found, doubtful = side_by_side(systems, harmonics)
    which = np.flatnonzero(doubtful)
    if len(which):
        again = one_by_one(systems, which, harmonics)
        for kept, better in zip(jax.tree.leaves(found), jax.tree.leaves(again), strict=True):
            kept[which] = better
    return found


def side_by_side(systems: System, harmonics: int = 600) -> tuple[Many, Bool[np.ndarray, " many"]]:
    """Results by batches, and which of them may be off by more than `ACCURACY`.

    Parameters
    ----------
    systems
        Of one operating point, leaves (..., simulation); motors that `fits`.
    """
    found, coarser = (
        in_chunks(partial(measured, harmonics=harmonics, filled=share), systems)
        for share in (1.0, COARSER)
    )
    return found, ~agreed(found, coarser)


def measured(some: System, harmonics: int, filled: float) -> Many:
    """Results of a few simulations side by side, leaves (..., simulation).

    Parameters
    ----------
    filled
        Share of the elements of `BatchResolution.fine()` that are used.
    """
    share = real(np.full(jax.tree.leaves(some)[0].shape[-1], filled))
    (metrics,), faults = jax.device_get(
        measure_batch(some, harmonics, BatchResolution.fine(), share)
    )
    return Many(metrics, faults[0])


def agreed(
    found: Many, coarser: Many, names: Sequence[str] | None = None
) -> Bool[np.ndarray, " many"]:
    """Which simulations a coarser solution confirms to `ACCURACY`, in these results or in all."""
    # The coarser one's error is about four times as large: the difference is mostly its own.
    errors = error_estimate(found.metrics, coarser.metrics, factor=1, floor=Floor(0, 0))

    def largest(place: int) -> float:
        shares = relative_error(of_one(found.metrics, place), of_one(errors, place))
        return max(shares.get(name, 0.0) for name in names or shares)

    sound = (found.faults == 0) & (coarser.faults == 0)
    return np.array([good and largest(place) <= ACCURACY for place, good in enumerate(sound)])


def one_by_one(systems: System, which: Int[np.ndarray, " many"], harmonics: int = 600) -> Many:
    """Some of many simulations by the solver for one motor, as `camring simulate` has them."""

    def one(place: int) -> Many:
        here: System = of_one(systems, place)
        (point,) = here.operating_points
        cycle = simulate_compiled(here.motor, here.fluid, point)
        results = summarise_compiled(cycle, harmonics)
        return Many(*jax.device_get((results, cycle.verdict.code)))

    return stacked(on_all_cores(one, which.tolist()))


def in_chunks(function: Callable[[Tree], Found], tree: Tree) -> Found:
    """A function of so many along the last axis at a time, put together again.

    The last chunk is filled up with copies, so any number of simulations is one program.
    """
    count = jax.tree.leaves(tree)[0].shape[-1]
    parts = [part_of(tree, start, CHUNK) for start in range(0, count, CHUNK)]
    found = on_all_cores(function, parts)
    return jax.tree.map(lambda *each: np.concatenate(each, axis=-1)[..., :count], *found)


def part_of(tree: Tree, start: int, size: int) -> Tree:
    """So many simulations from a place on, filled up with copies of the last one."""

    def cut(leaf: Any) -> np.ndarray:
        leaf = np.asarray(leaf)
        return leaf[..., np.minimum(np.arange(start, start + size), leaf.shape[-1] - 1)]

    return jax.tree.map(cut, tree)


def on_all_cores(function: Callable[[Given], Found], given: Sequence[Given]) -> list[Found]:
    """One after another for the first, which may have to compile; the others side by side."""
    first = [function(each) for each in given[:1]]
    with ThreadPoolExecutor(cores()) as pool:
        return [*first, *pool.map(function, given[1:])]


def of_one(tree: Tree, place: int) -> Tree:
    """One of many simulations."""
    return jax.tree.map(lambda leaf: np.asarray(leaf)[..., place], tree)


def repeated(tree: Tree, count: int) -> Tree:
    """One motor, oil or operating point as a batch of equal ones."""

    def many(leaf: Any) -> np.ndarray:
        leaf = np.asarray(leaf)[..., None]
        return np.broadcast_to(leaf, (*leaf.shape[:-1], count))

    return jax.tree.map(many, tree)


def stacked(trees: Sequence[Tree]) -> Tree:
    """Motors, oils or operating points of one structure as a batch, one along the last axis."""
    return jax.tree.map(
        lambda *leaves: np.stack([np.asarray(leaf) for leaf in leaves], axis=-1), *trees
    )

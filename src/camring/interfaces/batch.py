"""Many simulations at once: one compiled program, met in chunks of one size.

Everything that asks for many results (maps, sweeps) comes through `results_of_many`.
Motors that can be simulated in lanes are (`physics/lane_cycle.py`), and those among them
whose lane has not settled are looked at again one by one.
"""

from collections.abc import Sequence
from typing import NamedTuple, TypeVar

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Int

from camring.metrics.lane_summary import summarise_lanes
from camring.metrics.summary import Metrics, summarise
from camring.numerics.verdict import Fault
from camring.physics.cycle import simulate
from camring.physics.fluid import AbstractFluid
from camring.physics.lane_cycle import LanesLook, fits, simulate_lanes
from camring.physics.motor import Motor
from camring.physics.operating_point import OperatingPoint
from camring.physics.resolution import Resolution

CHUNK = 64  # simulations in flight; bounds the memory whatever the number asked for

Tree = TypeVar("Tree")


class Many(NamedTuple):
    """Results of many simulations.

    Attributes
    ----------
    metrics
        Every leaf with a leading axis, in the order asked for; NumPy arrays, SI.
    faults
        For each simulation its sum of `Fault` bits; zero is sound.
    """

    metrics: Metrics
    faults: Int[np.ndarray, " many"]


def results_of_many(
    motors: Motor,
    fluids: AbstractFluid,
    points: OperatingPoint,
    resolution: Resolution | None = None,
    harmonics: int = 600,
) -> Many:
    """Every result of many motors, each with its oil at its operating point.

    Parameters
    ----------
    motors, fluids, points
        Each leaf has a leading axis of one and the same length: see `repeated` and
        `stacked`.
    resolution
        Of motors that are looked at one by one; a motor in a lane has `LanesLook()`,
        unless a resolution is given.
    harmonics
        Highest shaft order of the spectra.

    Notes
    -----
    A motor without a periodic solution sinks nobody else: its fault says so. The last
    chunk is filled up with copies, so any number of simulations is one program.
    """
    everything = (motors, fluids, points)
    if resolution is not None or not fits(motors):
        return _in_chunks(everything, resolution or Resolution(), harmonics)
    found = _in_chunks(everything, LanesLook(), harmonics)
    lost = np.flatnonzero(found.faults & Fault.NOT_CONVERGED)
    if not len(lost):
        return found
    some = jax.tree.map(lambda leaf: np.asarray(leaf)[lost], everything)
    again = _in_chunks(some, Resolution(), harmonics)
    return jax.tree.map(lambda whole, part: _with(whole, lost, part), found, again)


def _with(whole: np.ndarray, places: Int[np.ndarray, " place"], part: np.ndarray) -> np.ndarray:
    changed = whole.copy()
    changed[places] = part
    return changed


def _in_chunks(
    everything: tuple[Motor, AbstractFluid, OperatingPoint],
    look: Resolution | LanesLook,
    harmonics: int,
) -> Many:
    count = len(jax.tree.leaves(everything)[0])
    parts = []
    for start in range(0, count, CHUNK):
        chosen = np.minimum(np.arange(start, start + CHUNK), count - 1)
        chunk = jax.tree.map(lambda leaf, chosen=chosen: jnp.asarray(leaf)[chosen], everything)
        found = (
            _lanes(chunk, look, harmonics)
            if isinstance(look, LanesLook)
            else _results(chunk, look, harmonics)
        )
        parts.append(jax.device_get(found))
    joined = jax.tree.map(lambda *leaves: np.concatenate(leaves)[:count], *parts)
    return Many(*joined)


def _lanes(
    chunk: tuple[Motor, AbstractFluid, OperatingPoint], look: LanesLook, harmonics: int
) -> tuple[Metrics, Int[Array, " many"]]:
    motors, fluids, points = jax.tree.map(lambda leaf: jnp.moveaxis(leaf, 0, -1), chunk)
    found = _simulate_lanes(motors, fluids, points, look)
    return _summarise_lanes(found, harmonics, look.oversampling), found.cycle.verdict.code


# Two programs: see `objective/lanes.py`.
_simulate_lanes = eqx.filter_jit(simulate_lanes)
_summarise_lanes = eqx.filter_jit(summarise_lanes)


@eqx.filter_jit
def _results(
    chunk: tuple[Motor, AbstractFluid, OperatingPoint], resolution: Resolution, harmonics: int
) -> tuple[Metrics, Int[Array, " many"]]:
    def one(
        motor: Motor, fluid: AbstractFluid, point: OperatingPoint
    ) -> tuple[Metrics, Int[Array, ""]]:
        cycle = simulate(motor, fluid, point, resolution)
        return summarise(cycle, harmonics), cycle.verdict.code

    return jax.vmap(one)(*chunk)


def repeated(tree: Tree, count: int) -> Tree:
    """One motor, oil or operating point as a batch of equal ones."""
    return jax.tree.map(lambda leaf: np.broadcast_to(leaf, (count, *np.shape(leaf))), tree)


def stacked(trees: Sequence[Tree]) -> Tree:
    """Motors, oils or operating points of one structure as a batch."""
    return jax.tree.map(lambda *leaves: np.stack([np.asarray(leaf) for leaf in leaves]), *trees)

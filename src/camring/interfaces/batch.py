"""Many simulations at once: one compiled program, met in chunks of one size.

Everything that asks for many results (maps, sweeps) comes through
`results_of_many`, so that a faster way to solve a batch has one place to go.
"""

from collections.abc import Sequence
from typing import NamedTuple, TypeVar

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Int

from camring.interfaces.motor_program import motor_program
from camring.metrics.summary import Metrics, summarise
from camring.physics.cycle import simulate
from camring.physics.fluid import AbstractFluid
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
    harmonics
        Highest shaft order of the spectra.

    Notes
    -----
    A motor without a periodic solution sinks nobody else: its fault says so. The last
    chunk is filled up with copies, so any number of simulations is one program.
    """
    resolution = resolution or Resolution()
    everything = (motors, fluids, points)
    count = len(jax.tree.leaves(everything)[0])
    parts = []
    for start in range(0, count, CHUNK):
        chosen = np.minimum(np.arange(start, start + CHUNK), count - 1)
        chunk = jax.tree.map(lambda leaf, chosen=chosen: jnp.asarray(leaf)[chosen], everything)
        parts.append(jax.device_get(_results(chunk, resolution, harmonics)))
    joined = jax.tree.map(lambda *leaves: np.concatenate(leaves)[:count], *parts)
    return Many(*joined)


@motor_program
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

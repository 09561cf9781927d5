"""Results of the product and of the independent solver, side by side."""

from dataclasses import replace
from functools import cache

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from motors import Case, Structure, awkward_case, sound_case, stacked
from reference_files import reference_results

from camring.metrics.independent import independent_results
from camring.metrics.summary import summarise
from camring.physics.cycle import simulate
from camring.physics.resolution import Resolution
from camring.physics.waveforms import waveforms

RESULTS = tuple(reference_results("mid")[0])  # the names of model.md section 10


BATCH = 8  # every run is a batch of this size, so that a structure is compiled once


@eqx.filter_jit
def _run(motor, fluid, point, resolution, filled):
    def one(motor, fluid, point):
        cycle = simulate(motor, fluid, point, resolution, filled)
        return cycle, summarise(cycle)

    return jax.vmap(one)(motor, fluid, point)


def run_all(cases: list[Case], resolution: Resolution | None = None):
    """Cycles and metrics of motors of one structure, with a leading axis."""
    resolution = resolution or Resolution()
    shape, filled = replace(resolution, filled=1.0), jnp.asarray(resolution.filled)
    found = []
    for first in range(0, len(cases), BATCH):
        some = cases[first : first + BATCH]
        padded = some + [some[-1]] * (BATCH - len(some))
        batch = _run(*stacked(padded), shape, filled)
        found.append(jax.tree.map(lambda leaf, count=len(some): leaf[:count], batch))  # noqa: B008
    return jax.tree.map(lambda *parts: jnp.concatenate(parts), *found)


def run(case: Case, resolution: Resolution | None = None):
    """Cycle and metrics of one motor."""
    return single(run_all([case], resolution), 0)


def single(tree, index: int):
    """One motor out of a batch."""
    return jax.tree.map(lambda leaf: leaf[index], tree)


waveforms_of = eqx.filter_jit(waveforms)
"""Waveforms of one cycle at some angles, compiled once for each number of angles."""


def records(metrics) -> list[dict[str, float]]:
    """A batch of metrics as one record for each motor."""
    columns = {name: np.atleast_1d(np.asarray(getattr(metrics, name))) for name in RESULTS}
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


@cache
def independent_sound(seed: int, structure: Structure) -> dict[str, float]:
    return independent_results(*sound_case(seed, structure), tolerance=1e-8)


@cache
def independent_awkward(seed: int, trouble: str, structure: Structure) -> dict[str, float]:
    return independent_results(*awkward_case(seed, trouble, structure), tolerance=1e-8)


def scales(record: dict[str, float], case: Case) -> dict[str, float]:
    """What an error of each result is relative to.

    The result itself, but for the few that are small differences of large numbers: a
    loss near zero is judged against all losses, a pressure near zero against the pressure
    difference, a contact force near zero against the force of that pressure.
    """
    drop = float(case.point.pressure_drop)
    force = drop * float(case.motor.piston.area)
    losses = sum(abs(record[f"{kind}_loss"]) for kind in KINDS_OF_LOSS)
    floors = {f"{kind}_loss": 0.01 * losses for kind in KINDS_OF_LOSS}
    floors |= {"min_pressure": 0.02 * drop, "min_contact_force": 0.02 * force}
    return {name: max(abs(value), floors.get(name, 0.0)) for name, value in record.items()}


KINDS_OF_LOSS = ("throttling", "leakage", "friction", "compression")


def relative_errors(found, expected, case: Case) -> dict[str, float]:
    """Error of each result against the independent solver's."""
    scale = scales(expected, case)
    return {name: abs(found[name] - expected[name]) / scale[name] for name in RESULTS}


def plain_errors(found, expected) -> dict[str, float]:
    """Error of each result relative to the result itself."""
    return {
        name: abs(found[name] - expected[name]) / (abs(expected[name]) or 1.0) for name in RESULTS
    }

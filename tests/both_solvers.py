"""Results of the product and of the independent solver, side by side."""

from collections.abc import Callable, Mapping, Sequence
from functools import cache

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from motors import Case, Structure, awkward_case, sound_case
from reference_files import reference_results

from camring.metrics.batch_summary import summarise_batch
from camring.metrics.summary import summarise as summarise_one
from camring.numerics.quantity import real
from camring.physics.batch_cycle import BatchResolution
from camring.physics.heat.batch_simulation import simulate_batch
from camring.physics.heat.simulation import neighbour
from camring.physics.piston_state import quadrature_samples
from camring.physics.resolution import Resolution
from camring.physics.waves.waveforms import waveforms
from camring.programs.batch_program import BatchProgram
from camring.programs.compiled import simulate, summarise
from camring.reference import independent_results

RESULTS = (
    *reference_results("mid")[0],  # the names of docs/theory.md section 10
    "energy_efficiency",
    "port_efficiency",
    "port_power",
    "full_leakage_loss",
    "return_flow",
    "case_drain",
    "return_flow_ripple",
    "l10_life",
)


def run_all(cases: list[Case], resolution: Resolution | None = None):
    """Cycles and metrics of motors of one structure, with a leading axis.

    One after another through the programs of the command line: whoever has compiled a
    structure, in whatever process, has done it for all tests (docs/notes/tests.md).
    """
    found = []
    for case in cases:
        cycle = simulate(*case, resolution)
        found.append((cycle, summarise(cycle)))
    return jax.tree.map(lambda *leaves: np.stack(leaves), *jax.device_get(found))


def run(case: Case, resolution: Resolution | None = None):
    """Cycle and metrics of one motor."""
    return single(run_all([case], resolution), 0)


def single(tree, index: int):
    """One motor out of a batch."""
    return jax.tree.map(lambda leaf: leaf[index], tree)


def side_by_side(cases: list) -> dict[str, float]:
    """Results of the first of some motors, solved as a batch of all of them twice."""
    batch = jax.tree.map(lambda *leaves: jnp.stack(leaves, axis=-1), *(cases * 2))
    found = BatchProgram(summarise_batch)(BatchProgram(simulate_batch)(*batch, BatchResolution()))
    return {name: float(leaf[0]) for name, leaf in vars(found).items()}


def slope_along(cycle, case: Case, where: Callable, steps: Sequence):
    """Derivatives of every result by a change of the numbers that `where` takes out of a motor."""
    still = jax.tree.map(jnp.zeros_like, case.motor)
    return _slope(cycle, *case, eqx.tree_at(where, still, tuple(map(real, steps))))


@jax.jit
def _slope(cycle, motor, fluid, point, along):
    def found(motor):
        return summarise_one(neighbour(cycle, motor, fluid, point))

    return jax.jvp(found, (motor,), (along,))[1]


def assert_differences(
    case: Case,
    where: Callable,
    steps: Sequence,
    slopes: Mapping[str, float],
    resolution: Resolution,
    share: float = 1e-3,
) -> None:
    """Slopes of some results are central differences of motors a share of the steps away."""
    given = [np.asarray(each) for each in where(case.motor)]
    above, below = (
        run(
            case.changed(
                lambda c: where(c.motor),
                tuple(x + by * step for x, step in zip(given, steps, strict=True)),
            ),
            resolution,
        )[1]
        for by in (share, -share)
    )
    for result, slope in slopes.items():
        high, low = (float(getattr(each, result)) for each in (above, below))
        difference = (high - low) / (2 * share)
        scale = 1e-7 * abs(high) / share + 1e-5 * abs(difference)
        assert float(slope) == pytest.approx(difference, abs=scale), result


def oil_left_over(cycle) -> float:
    """What of the mean flow that comes in neither goes out nor leaks, as a share of it."""
    into, out, lost = map(float, _mean_flows(cycle))
    return (into + out - lost) / into


@eqx.filter_jit
def _mean_flows(cycle):
    samples = quadrature_samples(cycle)
    piston = samples.piston
    flows = piston.supply_flow, piston.return_flow, piston.leakage_flow
    return [samples.mean(flow) for flow in flows]


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
    loss near zero is compared with all losses, a pressure near zero against the pressure
    difference, a contact force near zero against the force of that pressure.
    """
    drop = float(case.point.pressure_drop)
    force = drop * float(case.motor.piston.area)
    losses = sum(abs(record[f"{kind}_loss"]) for kind in KINDS_OF_LOSS)
    floors = {f"{kind}_loss": 0.01 * losses for kind in KINDS_OF_LOSS}
    floors |= {"full_leakage_loss": 0.01 * losses}
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

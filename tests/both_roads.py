"""Results of the product and of the independent solver, side by side."""

from functools import cache

import equinox as eqx
import jax
import numpy as np
from motors import Case, Structure, awkward_case, sound_case, stacked

from camring.metrics.independent import independent_results
from camring.metrics.summary import summarise
from camring.physics.cycle import simulate
from camring.physics.resolution import Resolution

RESULTS = (
    "mean_torque torque_ripple torque_ripple_peak_to_peak pressure_ripple flow_ripple "
    "displacement stroke ideal_torque supply_flow efficiency volumetric_efficiency "
    "hydromechanical_efficiency input_power output_power throttling_loss leakage_loss "
    "friction_loss compression_loss min_pressure max_pressure min_contact_force "
    "max_contact_stress min_undercut_factor max_pressure_angle max_velocity max_acceleration "
    "max_jerk min_volume natural_frequency damping_ratio jerk_objective spectral_pressure "
    "spectral_torque"
).split()


def _run(motor, fluid, point, resolution):
    cycle = simulate(motor, fluid, point, resolution)
    return cycle, summarise(cycle)


_single = eqx.filter_jit(_run)
_batch = eqx.filter_jit(jax.vmap(_run, in_axes=(0, 0, 0, None)))


def run(case: Case, resolution: Resolution | None = None):
    """Cycle and metrics of one motor, compiled once for each structure."""
    return _single(*case, resolution or Resolution())


def run_all(cases: list[Case], resolution: Resolution | None = None):
    """Cycles and metrics of motors of one structure, as one batch."""
    return _batch(*stacked(cases), resolution or Resolution())


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

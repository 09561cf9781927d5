"""Laws of the detailed laws in a running motor: balance, limits, accuracy, hard cases."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest
from both_solvers import RESULTS, oil_left_over, relative_errors, run
from detailed_motors import detailed_case, hard_case
from motors import STRUCTURES, Case, sound_case

from camring.physics.oil.aerated_fluid import AeratedFluid
from camring.physics.resolution import Resolution
from camring.reference import independent_solution

LOSSES = ("throttling_loss", "leakage_loss", "friction_loss")
FINEST = Resolution(elements=2000)


def record(metrics):
    return {name: float(getattr(metrics, name)) for name in RESULTS}


@pytest.mark.parametrize("seed", range(4))
def test_every_result_is_that_of_the_second_solver(seed):
    case = detailed_case(seed)
    cycle, metrics = run(case)
    assert int(cycle.verdict.code) == 0
    expected = independent_solution(*case, tolerance=1e-9).results
    errors = relative_errors(record(metrics), expected, case)
    assert max(errors.values()) < 1e-5, errors


@pytest.mark.parametrize(
    ("trouble", "seed", "within"),
    [
        ("trapped", 2, 1e-5),
        ("trapped", 3, 1e-5),
        ("nearly touching", 1, 1e-5),
        ("crawling", 2, 1e-5),
        ("racing", 2, 1e-5),  # 2 kPa to 4,470 bar
        ("racing", 3, 3e-5),
        ("much air", 2, 1e-5),
    ],
)
def test_hard_cases_are_sound_answers(trouble, seed, within):
    case = hard_case(seed, trouble)
    cycle, metrics = run(case)
    assert int(cycle.verdict.code) == 0
    assert float(metrics.min_pressure) > 0
    expected = independent_solution(*case, tolerance=1e-9).results
    errors = relative_errors(record(metrics), expected, case)
    assert max(errors.values()) < within, errors


def test_without_leakage_and_openings_the_verdict_says_so():
    case = hard_case(1, "trapped")
    where = lambda c: (  # noqa: E731
        c.motor.leakage.coefficient,
        c.motor.gap.clearance,
        c.motor.valve_plate.port_area,
    )
    cycle, _ = run(case.changed(where, (0.0, 1e-12, 1e-30)))
    assert "neither opens nor leaks" in cycle.verdict.explain()


@pytest.mark.parametrize("seed", [0, 3])
def test_the_mass_balance_of_power_closes_and_every_loss_is_a_loss(seed):
    _, metrics = run(detailed_case(seed), FINEST)
    assert abs(float(metrics.power_residual)) < 1e-9
    assert float(metrics.compression_loss) == 0
    for name in LOSSES:
        assert float(getattr(metrics, name)) > 0


def test_oil_in_is_oil_out_and_leakage():
    cycle, _ = run(detailed_case(0), FINEST)
    assert abs(oil_left_over(cycle)) < 1e-9


@pytest.mark.parametrize("modulus", [1.4e9, 1.4e11])
def test_oil_without_air_comes_to_the_constant_law_as_it_stiffens(modulus):
    """The two differ by the strain dp/beta and no more."""
    motor, constant, point = sound_case(2, STRUCTURES[0])
    constant = eqx.tree_at(lambda f: f.bulk_modulus, constant, jnp.asarray(modulus))
    aerated = AeratedFluid(
        constant.density,
        constant.bulk_modulus,
        constant.vapour_pressure,
        constant.transition_pressure,
        air_fraction=0.0,
    )
    one = record(run(Case(motor, constant, point))[1])
    other = record(run(Case(motor, aerated, point))[1])
    strain = float(point.pressure_drop) / modulus
    for name in ("mean_torque", "torque_ripple", "max_pressure", "input_power", "efficiency"):
        assert other[name] == pytest.approx(one[name], rel=3 * strain + 2e-6), name


def test_time_below_a_pressure_is_that_of_the_second_solver():
    case = hard_case(3, "trapped")
    cycle, metrics = run(case)
    orbit = independent_solution(*case, tolerance=1e-8).orbit
    period = float(cycle.motor.cam.period)
    pressure = orbit.pressure((np.arange(400_000) + 0.5) / 400_000 * period)
    for limit, share in (
        (case.fluid.atmospheric_pressure, metrics.share_below_air_release),
        (case.fluid.vapour_pressure, metrics.share_below_vapour),
    ):
        assert float(share) == pytest.approx(np.mean(pressure < float(limit)), abs=2e-5)
    assert float(metrics.air_release_margin) < 0
    margin = float(metrics.min_pressure) - float(case.fluid.vapour_pressure)
    assert float(metrics.vapour_margin) == pytest.approx(margin)

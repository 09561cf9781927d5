"""Idle lobes: half the lobes displace half, and every law holds on the others as before."""

from dataclasses import replace
from math import gcd, lcm

import jax
import numpy as np
import pytest
from both_solvers import (
    RESULTS,
    assert_differences,
    relative_errors,
    run,
    side_by_side,
    slope_along,
)
from detailed_motors import HALF, half_case
from motors import Case

from camring.analyses.modes import balanced_splits
from camring.geometry.idle_lobes import pattern_repeats
from camring.metrics.displacement import driving, rises_between_knots
from camring.metrics.idle_drag import idle_drag
from camring.metrics.radial_load import radial_load
from camring.metrics.starting import starting
from camring.physics.piston_state import quadrature_samples
from camring.physics.resolution import Resolution
from camring.physics.rotation import in_mode, turned
from camring.reference import independent_results
from camring.reference.machine import machine_of
from camring.reference.standstill import standing_torque

FINEST = Resolution(elements=1500)


def backwards(case: Case) -> Case:
    """The same the other way round; a notch is at the wrong end there."""
    plate = case.motor.valve_plate
    ports = {name: replace(getattr(plate, name), notch=None) for name in ("supply", "return_")}
    motor = replace(case.motor, valve_plate=replace(plate, **ports))
    return Case(motor, case.fluid, replace(case.point, reverse=True))


@pytest.fixture(scope="module")
def half():
    case = half_case(0)
    return case, *run(case, FINEST)


def record(metrics):
    return {name: float(getattr(metrics, name)) for name in RESULTS}


def test_half_of_the_lobes_displace_half(half):
    case, _, metrics = half
    motor = case.motor
    whole = replace(motor.valve_plate, idle_lobes=())
    area = motor.pistons * float(motor.piston.area)
    full = area * float(rises_between_knots(replace(motor, valve_plate=whole)))
    assert float(metrics.displacement) == pytest.approx(full / 2, rel=1e-12)
    radii = np.asarray(motor.cam.pitch_radius(np.linspace(0, motor.cam.period, 20_001)).value)
    sampled = area * motor.lobes * np.sum(np.maximum(np.diff(radii), 0))
    assert full == pytest.approx(sampled, rel=1e-6)


def test_the_balance_closes_and_every_loss_is_a_loss(half):
    _, cycle, metrics = half
    assert int(cycle.verdict.code) == 0
    assert abs(float(metrics.power_residual)) < 1e-9
    for name in ("throttling_loss", "leakage_loss", "friction_loss"):
        assert float(getattr(metrics, name)) > 0, name


def test_every_result_is_that_of_the_second_solver(half):
    """Which goes all round the ring, whatever the pattern repeats."""
    case, _, metrics = half
    expected = independent_results(*case, tolerance=1e-9)
    errors = relative_errors(record(metrics), expected, case)
    assert max(errors.values()) < 1e-5, errors


def test_backwards_other_lobes_idle_in_the_mirror_image(half):
    case = backwards(half_case(1, idle=(0,)))
    image = turned(case.motor, case.point)
    assert image.valve_plate.idle_lobes == (0,)
    assert turned(image, case.point) is image
    _, metrics = run(case)
    expected = independent_results(*case, tolerance=1e-9)
    errors = relative_errors(record(metrics), expected, case)
    assert max(errors.values()) < 1e-5, errors
    assert float(metrics.displacement) == pytest.approx(expected["displacement"], rel=1e-9)


def test_many_side_by_side_are_the_motors_alone(half):
    cases = [tuple(half_case(seed)) for seed in (0, 2)]
    case, _, metrics = half
    mine = side_by_side(cases)
    errors = relative_errors(mine, record(metrics), case)
    for name in ("mean_torque", "friction_loss", "case_drain", "efficiency", "supply_flow"):
        assert errors[name] < 5e-5, (name, errors[name])
    assert mine["displacement"] == pytest.approx(float(metrics.displacement), rel=1e-12)


def test_slopes_are_differences(half):
    case, cycle, _ = half

    def where(motor):
        return motor.cam.control_radii, motor.valve_plate.shift, motor.piston.bore

    radii, _, bore = (np.asarray(each) for each in where(case.motor))
    bend = 0.02 * np.ptp(radii) * np.sin(1 + 2.3 * np.arange(len(radii)))
    steps = (bend, 0.01 * case.motor.valve_plate.pitch, 0.01 * bore)
    results = ("mean_torque", "friction_loss", "displacement", "supply_flow")
    slope = slope_along(cycle, case, where, steps)
    assert_differences(case, where, steps, {n: getattr(slope, n) for n in results}, FINEST)


def test_it_starts_as_the_second_solver_says_both_ways(half):
    case, _, _ = half
    found = jax.jit(lambda *tree: starting(*tree, angles=200))(*case)
    expected = standing_torque(machine_of(*case), np.asarray(found.angle))
    for mine, theirs in zip((found.forward, found.backward), expected, strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=0, atol=1e-8 * np.abs(theirs).max())


def test_radial_forces_of_a_pattern_that_balances_them_cancel(half):
    """Six pistons, the pattern twice a revolution: each is opposed by one that does the same."""
    case, cycle, _ = half
    load = jax.device_get(jax.jit(radial_load)(cycle))
    one = float(case.motor.piston.area) * float(case.point.pressure_drop)
    assert float(load.outwards) > one
    assert float(load.largest) < 1e-9 * one


def test_idle_lobes_drag_and_the_others_drive(half):
    """Both together are the shaft's mean torque; what idles cannot give power."""
    case, cycle, metrics = half
    drag = float(jax.jit(idle_drag)(cycle))
    assert 0 < drag < 0.1 * float(metrics.mean_torque)
    samples = quadrature_samples(cycle)
    fed = driving(cycle.motor.valve_plate, samples.piston.angle)
    driven = case.motor.pistons * float(samples.mean(samples.piston.torque * fed))
    assert driven - drag == pytest.approx(float(metrics.mean_torque), rel=1e-12)


def test_a_pattern_repeats_as_often_as_it_looks_the_same():
    assert pattern_repeats((0, 2, 4), 6) == 3
    assert pattern_repeats((0, 3), 6) == 2
    assert pattern_repeats((0, 1), 6) == 1
    assert pattern_repeats((), 6) == 6
    case = half_case(0)
    assert in_mode(case.motor, ()) is case.motor
    assert in_mode(case.motor, HALF).surviving_order == lcm(6, 2)


def test_splits_that_keep_radial_forces_balanced_are_those_that_pistons_share_a_turn_with():
    """Counted by trying every pattern of few lobes."""
    for pistons in range(1, 11):
        for lobes in range(2, 9):
            patterns = [
                tuple(k for k in range(lobes) if number >> k & 1)
                for number in range(1, 2**lobes - 1)
            ]
            able = {
                len(each) for each in patterns if gcd(pistons, pattern_repeats(each, lobes)) > 1
            }
            assert {idle for idle, _ in balanced_splits(pistons, lobes)} == able

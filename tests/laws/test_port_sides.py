"""Ports of supply and return with numbers of their own: area, coefficient, ramp, notch."""

from dataclasses import replace

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from both_solvers import (
    RESULTS,
    assert_differences,
    oil_left_over,
    relative_errors,
    run,
    side_by_side,
    slope_along,
)
from detailed_motors import half_case
from motors import sound_case

from camring.metrics.starting import starting
from camring.physics.chamber import chamber_at
from camring.physics.cycle import reference_radius
from camring.physics.pressure import port_flows, pressure_slope
from camring.physics.resolution import Resolution
from camring.physics.rotation import in_mode, turned, with_like_ports
from camring.reference import independent_results
from camring.reference.chamber import Chamber
from camring.reference.machine import machine_of
from camring.reference.standstill import standing_torque

FINEST = Resolution(elements=1500)


def ends(motor):
    """Numbers of both sides that the tests move."""
    supply, back = motor.valve_plate.supply, motor.valve_plate.return_
    return supply.area, back.area, back.discharge_coefficient, supply.ramp, back.notch.angle


@pytest.fixture(scope="module")
def apart():
    case = half_case(0)
    return case, *run(case, FINEST)


def record(metrics):
    return {name: float(getattr(metrics, name)) for name in RESULTS}


def test_every_result_is_that_of_the_second_solver(apart):
    case, _, metrics = apart
    expected = independent_results(*case, tolerance=1e-9)
    errors = relative_errors(record(metrics), expected, case)
    assert max(errors.values()) < 1e-5, errors


def test_power_in_is_power_out_and_the_losses(apart):
    _, cycle, metrics = apart
    assert int(cycle.verdict.code) == 0
    assert abs(float(metrics.power_residual)) < 1e-9
    for name in ("throttling_loss", "leakage_loss", "friction_loss"):
        assert float(getattr(metrics, name)) > 0, name


def test_oil_in_is_oil_out(apart):
    """Masses, for this oil has air in it."""
    _, cycle, _ = apart
    assert abs(oil_left_over(cycle)) < 1e-9


def test_a_narrower_return_throttles_more(apart):
    case, _, metrics = apart
    narrow = case.changed(
        lambda c: c.motor.valve_plate.return_.area, float(ends(case.motor)[1]) / 1.5
    )
    _, throttled = run(narrow, FINEST)
    assert float(throttled.throttling_loss) > 1.1 * float(metrics.throttling_loss)
    assert float(throttled.mean_torque) < float(metrics.mean_torque)


def test_many_side_by_side_are_the_motors_alone(apart):
    cases = [tuple(half_case(seed)) for seed in (0, 2)]
    case, _, metrics = apart
    mine = side_by_side(cases)
    errors = relative_errors(mine, record(metrics), case)
    for name in ("mean_torque", "throttling_loss", "case_drain", "efficiency", "supply_flow"):
        assert errors[name] < 5e-5, (name, errors[name])


def test_slopes_are_differences(apart):
    case, cycle, _ = apart
    steps = [0.01 * np.asarray(each) for each in ends(case.motor)]
    results = ("mean_torque", "throttling_loss", "leakage_loss", "supply_flow")
    slope = slope_along(cycle, case, ends, steps)
    assert_differences(case, ends, steps, {n: getattr(slope, n) for n in results}, FINEST)


def test_it_starts_as_the_second_solver_says_both_ways():
    case = half_case(0)
    found = jax.jit(lambda *tree: starting(*tree, angles=200))(*case)
    expected = standing_torque(machine_of(*case), np.asarray(found.angle))
    for mine, theirs in zip((found.forward, found.backward), expected, strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=0, atol=1e-8 * np.abs(theirs).max())


def some_chambers(motor):
    angle = jnp.linspace(0.01, 2 * np.pi / motor.lobes, 23)
    radius = motor.cam.pitch_radius(angle)
    return angle, chamber_at(motor, reference_radius(motor), angle, radius)


@eqx.filter_jit
def slope_at(motor, fluid, point, angle, pressure):
    ours = chamber_at(motor, reference_radius(motor), angle, motor.cam.pitch_radius(angle))
    return pressure_slope(motor, fluid, point, ours, jnp.full(len(angle), pressure))


def test_the_chambers_pressure_rises_as_the_second_solver_writes_it():
    """At one pressure all round a revolution: no orbit, only both writings of the laws."""
    case = half_case(1)
    machine = machine_of(*case)
    chamber = Chamber(machine)
    motor = in_mode(case.motor, case.point.idle_lobes)
    edges = chamber.edges
    angle = (edges[:-1] + edges[1:]) / 2
    pressure = float(case.point.return_pressure) + 3e6
    found = slope_at(motor, case.fluid, case.point, jnp.asarray(angle), pressure)
    shift = machine.return_pressure
    state = chamber.state(pressure, shift)
    expected = []
    for start, end, at in zip(edges[:-1], edges[1:], angle, strict=True):
        slope, there = chamber.slopes(start, end, shift)(state, float(at))
        expected.append(slope * (there if chamber.oil.logarithmic else chamber.scale))
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


def test_a_side_that_repeats_the_common_numbers_changes_no_bit():
    case = sound_case(0)
    motor, plate = case.motor, case.motor.valve_plate
    own = dict(
        area=plate.port_area,
        discharge_coefficient=motor.orifice.discharge_coefficient,
        ramp=plate.window.ramp,
    )
    same = replace(plate, return_=replace(plate.return_, **own))
    other = replace(motor, valve_plate=same)
    for one, two in ((motor, other), (motor, with_like_ports(other))):
        found = []
        for each in (one, two):
            _, chamber = some_chambers(each)
            pressure = jnp.full_like(chamber.volume, 7e6)
            found.append(pressure_slope(each, case.fluid, case.point, chamber, pressure))
        np.testing.assert_array_equal(*found)


def test_each_side_lets_through_what_its_own_numbers_say():
    """By hand, Torricelli's law far from the transition pressure."""
    case = sound_case(0)
    plate = case.motor.valve_plate
    back = replace(plate.return_, area=2e-5, discharge_coefficient=0.8, ramp=1.0)
    motor = replace(case.motor, valve_plate=replace(plate, return_=back))
    angle, chamber = some_chambers(motor)
    pressure = jnp.full_like(chamber.volume, float(case.point.return_pressure) + 4e7)
    flows = port_flows(motor, case.fluid, case.point, chamber, pressure)
    half = float(back.width) / 2
    away = np.abs(np.asarray(angle) - float(back.centre) - float(plate.shift))
    share = np.clip((half - away) / half, 0, 1)
    expected = -0.8 * 2e-5 * share * np.sqrt(2 * 4e7 / float(case.fluid.density))
    np.testing.assert_allclose(flows.return_, expected, rtol=1e-5, atol=1e-12)
    _, before = some_chambers(case.motor)
    np.testing.assert_array_equal(chamber.supply_area, before.supply_area)


def test_backwards_each_side_takes_its_numbers_along():
    """The window that was the return's is fed through the return's area, in both solvers."""
    case = sound_case(0)
    plate = case.motor.valve_plate
    back = replace(plate.return_, area=2e-5, discharge_coefficient=0.8, ramp=0.9)
    motor = replace(case.motor, valve_plate=replace(plate, return_=back))
    point = replace(case.point, reverse=True)
    image = turned(motor, point)
    angle = jnp.linspace(0.01, 2 * np.pi / motor.lobes, 23)
    reference = reference_radius(motor)
    ahead = chamber_at(motor, reference, angle, motor.cam.pitch_radius(angle))
    behind = chamber_at(image, reference, -angle, image.cam.pitch_radius(-angle))
    np.testing.assert_allclose(behind.supply_area, ahead.return_area, rtol=0, atol=1e-16)
    np.testing.assert_allclose(behind.return_area, ahead.supply_area, rtol=0, atol=1e-16)
    assert float(image.orifice_of(image.valve_plate.supply).discharge_coefficient) == 0.8
    fed = machine_of(motor, case.fluid, point).supply
    assert (fed.area, fed.discharge_coefficient, fed.ramp) == (2e-5, 0.8, 0.9)

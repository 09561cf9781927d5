"""Both directions of rotation: backwards, ports exchanged, is the mirror image forwards."""

from dataclasses import replace

import equinox as eqx
import jax
import numpy as np
import pytest
from motors import STRUCTURES, Case, sound_case
from scipy.integrate import solve_ivp

from camring.geometry.notch import ReliefNotch
from camring.geometry.window import TabulatedWindow
from camring.physics.chamber import chamber_at
from camring.physics.mirror import mirrored
from camring.physics.motor import Motor
from camring.physics.pressure import pressure_slope
from camring.physics.rotation import turned
from camring.programs.compiled import simulate, summarise
from camring.reference import OrbitError, independent_results
from camring.reference.machine import machine_of

STRUCTURE = STRUCTURES[0]
LOPSIDED = TabulatedWindow(np.array([-1.0, -0.5, 0.6, 1.0]), np.array([0.0, 0.9, 1.0, 0.0]))
COMPARED = (
    "mean_torque",
    "torque_ripple",
    "pressure_ripple",
    "flow_ripple",
    "supply_flow",
    "efficiency",
    "throttling_loss",
    "leakage_loss",
    "compression_loss",
    "min_pressure",
    "max_pressure",
    "min_contact_force",
    "max_contact_stress",
    "displacement",
)


def backwards(case: Case) -> Case:
    return Case(case.motor, case.fluid, replace(case.point, reverse=True))


def results(case: Case) -> dict[str, float]:
    found = jax.device_get(summarise(simulate(*case)))
    return {name: float(value) for name, value in vars(found).items()}


def exchanged(motor: Motor) -> Motor:
    plate = motor.valve_plate
    return replace(motor, valve_plate=replace(plate, supply=plate.return_, return_=plate.supply))


@pytest.fixture(scope="module")
def lopsided() -> Case:
    """With a cam, windows and a timing that are each other one way round."""
    case = sound_case(8, STRUCTURE)
    return case.changed(lambda c: c.motor.valve_plate.shift, 0.004 * case.motor.valve_plate.pitch)


def test_a_symmetric_motor_does_not_care_which_way_it_turns(lopsided):
    radii = np.asarray(lopsided.motor.cam.control_radii)
    symmetric = lopsided.changed(
        lambda c: (
            c.motor.cam.control_radii,
            c.motor.valve_plate.shift,
            c.motor.valve_plate.return_.width,
        ),
        ((radii + np.roll(radii[::-1], 1)) / 2, 0.0, lopsided.motor.valve_plate.supply.width),
    )
    one, other = results(symmetric), results(backwards(symmetric))
    for name in COMPARED:
        assert other[name] == pytest.approx(one[name], rel=1e-7), name


def test_the_motor_seen_from_behind_turned_backwards_is_the_motor_forwards(lopsided):
    behind = Case(exchanged(mirrored(lopsided.motor)), lopsided.fluid, lopsided.point)
    one, other = results(lopsided), results(backwards(behind))
    for name in COMPARED:
        assert other[name] == pytest.approx(one[name], rel=1e-9), name
    assert abs(results(backwards(lopsided))["torque_ripple"] / one["torque_ripple"] - 1) > 1e-3


def test_the_power_balance_closes_backwards_and_the_second_solver_agrees(lopsided):
    case = backwards(lopsided)
    found = results(case)
    assert abs(found["power_residual"]) < 1e-6
    expected = independent_results(*case, tolerance=1e-9)
    for name in COMPARED:
        assert found[name] == pytest.approx(expected[name], rel=2e-5), name


def test_integration_in_time_of_the_motor_as_it_stands_finds_the_same_pressure(lopsided):
    """No mirror: `psi = -angle` grows, supply oil comes through the return's windows."""
    motor, fluid, point = lopsided
    cycle = simulate(*backwards(lopsided))
    reference = float(cycle.reference_radius)
    reverse = eqx.tree_at(lambda p: p.shaft_speed, point, -point.shaft_speed)
    fed = exchanged(motor)

    @jax.jit
    def rate(psi, pressure):
        angle = -psi
        chamber = chamber_at(fed, reference, angle, fed.cam.pitch_radius(angle))
        return -pressure_slope(fed, fluid, reverse, chamber, pressure)

    period = motor.cam.period
    found = solve_ivp(
        lambda psi, pressure: np.asarray(rate(psi, pressure[0]))[None],
        (0, 2 * period),
        [float(point.return_pressure)],
        method="LSODA",
        rtol=1e-8,
        atol=1.0,
        max_step=period / 200,
        dense_output=True,
    )
    nodes = np.asarray(cycle.orbit.mesh.start)
    inside = (nodes > 0.05 * period) & (nodes < 0.95 * period)
    ends = np.asarray(fluid.pressure(cycle.orbit.stage_state))[-1]  # at the end of each element
    at = nodes[1:]
    expected = found.sol(period + at)[0]
    drop = float(point.pressure_drop)
    assert np.abs(ends[:-1] - expected)[inside[1:]].max() < 2e-5 * drop


def test_turning_twice_changes_nothing_more(lopsided):
    point = backwards(lopsided).point
    once = turned(lopsided.motor, point)
    assert turned(once, point) is once
    again = turned(once, lopsided.point)
    for one, two in zip(jax.tree.leaves(lopsided.motor), jax.tree.leaves(again), strict=True):
        np.testing.assert_allclose(np.asarray(one), np.asarray(two), rtol=0, atol=1e-15)


@pytest.mark.parametrize("structure", STRUCTURES, ids=lambda each: each.kind)
def test_both_solvers_see_the_same_machine_from_behind(structure):
    """Each by its own arithmetic, for rings and planar cams and lopsided windows too."""
    case = sound_case(5, structure)
    motor = eqx.tree_at(lambda m: m.valve_plate.window, case.motor, LOPSIDED)
    point = backwards(case).point
    one = machine_of(motor, case.fluid, point)
    other = machine_of(turned(motor, point), case.fluid, point)
    np.testing.assert_allclose(one.control, other.control, rtol=1e-13)
    for port in ("supply", "return_"):
        mine, theirs = getattr(one, port), getattr(other, port)
        assert (mine.width, mine.centre) == pytest.approx((theirs.width, theirs.centre))
        np.testing.assert_allclose(mine.table, theirs.table, rtol=1e-13)
    still = machine_of(motor, case.fluid, case.point)
    assert not np.allclose(one.control, still.control, rtol=1e-6)


def test_a_relief_notch_turns_forwards_only(lopsided):
    motor = eqx.tree_at(
        lambda m: m.valve_plate.notch,
        lopsided.motor,
        ReliefNotch(0.03, 0.05),
        is_leaf=lambda x: x is None,
    )
    with pytest.raises(ValueError, match="closing edge"):
        turned(motor, backwards(lopsided).point)
    with pytest.raises(OrbitError, match="closing edge"):
        machine_of(motor, lopsided.fluid, backwards(lopsided).point)

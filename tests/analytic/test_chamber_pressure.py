"""Closed forms of the chamber pressure (docs/theory.md section 11), in both solvers.

Each case is a motor of the first structure with numbers for which a stretch of
its cycle has a known solution.
"""

from math import pi

import numpy as np
import pytest
from both_solvers import run, waveforms_of
from motors import STRUCTURES, sound_case

from camring.reference import machine_of
from camring.reference.orbit import periodic_orbit

POINTS = 2001


def product_pressure(case, angle):
    cycle, _ = run(case)
    assert int(cycle.verdict.code) == 0
    return np.asarray(waveforms_of(cycle, angle).chamber_pressure)


def independent_pressure(case, angle):
    return periodic_orbit(machine_of(*case), 1e-9).pressure(angle)


SOLVERS = pytest.mark.parametrize(
    "pressure_of", [product_pressure, independent_pressure], ids=["product", "independent"]
)


def base_case(seed=1):
    """Windows narrow enough to seal the chamber for a while at both dead centres."""
    case = sound_case(seed, STRUCTURES[0])
    pitch = case.motor.valve_plate.pitch
    width = 0.4 * pitch
    return case.changed(
        lambda c: (
            c.motor.valve_plate.supply.width,
            c.motor.valve_plate.return_.width,
            c.motor.valve_plate.shift,
        ),
        (width, width, 0.0),
    )


def round_case(seed=1):
    """The same with a round cam: fixed volume."""
    case = base_case(seed)
    radius = np.full(case.motor.cam.control_count, 0.15)
    return case.changed(lambda c: c.motor.cam.control_radii, radius)


def sealed_angles(case):
    """Angles from supply closing to return opening."""
    plate = case.motor.valve_plate
    start = float(plate.supply.centre + plate.supply.width / 2)
    end = float(plate.return_.centre - plate.return_.width / 2)
    assert end > start
    return np.linspace(start, end, POINTS)


def volume(case, angle):
    motor = case.motor
    radius = np.asarray(motor.cam.pitch_radius(angle).value)
    lowest = np.asarray(motor.cam.pitch_radius(np.linspace(0, motor.cam.period, 20001)).value).min()
    return float(motor.dead_volume) + float(motor.piston.area) * (radius - lowest)


@SOLVERS
@pytest.mark.parametrize("seed", [1, 2])
def test_a_sealed_chamber_is_a_spring_of_oil(pressure_of, seed):
    """P - P0 = beta ln(V0 / V)."""
    case = base_case(seed).changed(lambda c: c.motor.leakage.coefficient, 0.0)
    angle = sealed_angles(case)
    pressure, chamber = pressure_of(case, angle), volume(case, angle)
    expected = pressure[0] + float(case.fluid.bulk_modulus) * np.log(chamber[0] / chamber)
    assert np.ptp(pressure) > 5e5
    np.testing.assert_allclose(
        pressure, expected, rtol=0, atol=1e-6 * float(case.point.pressure_drop)
    )


@SOLVERS
def test_pressure_leaks_away_exponentially_from_a_fixed_volume(pressure_of):
    """P - P_case falls as exp(-t beta Cl / V)."""
    case = round_case()
    angle = sealed_angles(case)
    stretch, speed = angle[-1] - angle[0], float(case.point.shaft_speed)
    modulus, chamber = float(case.fluid.bulk_modulus), float(case.motor.dead_volume)
    leak = 1.5 * chamber * speed / (modulus * stretch)  # falls to exp(-1.5) while sealed
    case = case.changed(lambda c: c.motor.leakage.coefficient, leak)
    above = pressure_of(case, angle) - float(case.point.case_pressure)
    expected = above[0] * np.exp(-(angle - angle[0]) / speed * modulus * leak / chamber)
    assert above[-1] < 0.25 * above[0]
    np.testing.assert_allclose(above, expected, rtol=5e-6)


@SOLVERS
def test_the_root_of_the_drop_falls_linearly_while_a_fixed_volume_fills(pressure_of):
    """d sqrt(Ps - P)/dt = -beta Cd A sqrt(2/density) / (2 V), until the drop is of p_tr's size."""
    transition = 1e3
    case = (
        round_case()
        .changed(lambda c: c.motor.leakage.coefficient, 0.0)
        .changed(lambda c: c.fluid.transition_pressure, transition)
        .changed(lambda c: c.motor.valve_plate.window.ramp, 0.1)
    )
    plate, point = case.motor.valve_plate, case.point
    chamber, speed = float(case.motor.dead_volume), float(point.shaft_speed)
    drop, width = float(point.pressure_drop), float(plate.supply.width)
    through = float(case.motor.orifice.discharge_coefficient) * np.sqrt(
        2 / float(case.fluid.density)
    )
    rate = float(case.fluid.bulk_modulus) * through / (2 * chamber * speed)  # for each m2
    area = np.sqrt(drop) / (0.75 * width * rate)
    case = case.changed(lambda c: c.motor.valve_plate.port_area, area)
    first = float(plate.supply.centre) - width / 2 + 0.1 * width / 2
    angle = np.linspace(first, first + 0.55 * width, POINTS)
    root = np.sqrt(float(point.supply_pressure) - pressure_of(case, angle))
    assert root[-1] > 30 * np.sqrt(transition)
    np.testing.assert_allclose(root, root[0] - rate * area * (angle - first), rtol=2e-6)


@SOLVERS
@pytest.mark.parametrize("seed", [1, 3])
def test_stiff_oil_lets_pressure_follow_the_flow_at_once(pressure_of, seed):
    """P = Ps - (density/2) (Ap w s' / (Cd A))^2 in a fully open supply window."""
    case = sound_case(seed, STRUCTURES[0])
    pitch = case.motor.valve_plate.pitch
    case = (
        case.changed(lambda c: c.fluid.bulk_modulus, 1e12)
        .changed(lambda c: c.fluid.transition_pressure, 100.0)
        .changed(lambda c: c.motor.leakage.coefficient, 0.0)
        .changed(lambda c: c.motor.valve_plate.window.ramp, 0.3)
        .changed(
            lambda c: (c.motor.valve_plate.supply.width, c.motor.valve_plate.return_.width),
            (0.52 * pitch, 0.52 * pitch),
        )
    )
    plate, motor = case.motor.valve_plate, case.motor
    centre = float(plate.supply.centre + plate.shift)
    angle = np.linspace(centre - 0.1 * pitch, centre + 0.1 * pitch, POINTS)
    swept = float(motor.piston.area * case.point.shaft_speed) * np.asarray(
        motor.cam.pitch_radius(angle).first
    )
    assert swept.min() > 0
    opened = float(motor.orifice.discharge_coefficient * plate.port_area)
    expected = float(case.fluid.density) / 2 * (swept / opened) ** 2
    drop = float(case.point.supply_pressure) - pressure_of(case, angle)
    np.testing.assert_allclose(drop, expected, rtol=1e-4)


@SOLVERS
@pytest.mark.parametrize("seed", [0, 4])
def test_the_torque_of_pressure_is_the_loop_of_the_indicator_diagram(pressure_of, seed):
    """Mean torque without mass and damping: Np NL/(2 pi) times the loop integral of P dV."""
    case = sound_case(seed, STRUCTURES[0])
    angle = case.motor.cam.period * np.linspace(0, 1, POINTS)
    pressure, chamber = pressure_of(case, angle), volume(case, angle)
    loop = np.sum((pressure[1:] + pressure[:-1]) / 2 * np.diff(chamber))
    pistons, lobes = case.motor.pistons, case.motor.lobes
    slope = np.asarray(case.motor.cam.pitch_radius(angle).first)
    force = float(case.motor.piston.area) * (pressure - float(case.point.case_pressure))
    by_work = np.mean((force * slope)[:-1])
    assert pistons * by_work == pytest.approx(pistons * lobes / (2 * pi) * loop, rel=2e-5)

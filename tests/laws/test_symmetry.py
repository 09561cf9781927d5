"""Turned machines run as turned cycles; mirrored ones run backwards as mirrored cycles."""

from math import pi

import numpy as np
import pytest
from both_solvers import RESULTS, run_all, single, waveforms_of
from motors import STRUCTURES, sound_case

from camring.geometry.contour import undercut_factor
from camring.physics.chamber import chamber_at
from camring.physics.force import radial_force
from camring.physics.pressure import pressure_slope


def turned(case, steps: int):
    """Cam and valve plate turned together by whole control spacings."""
    radii = np.roll(np.asarray(case.motor.cam.control_radii), steps)
    angle = steps * case.motor.cam.period / len(radii)
    shift = float(case.motor.valve_plate.shift) + angle
    return (
        case.changed(lambda c: c.motor.cam.control_radii, radii).changed(
            lambda c: c.motor.valve_plate.shift, shift
        ),
        angle,
    )


def mirrored(case):
    """Cam and valve plate as seen in a mirror, the shaft turning the other way."""
    plate = case.motor.valve_plate
    radii = np.roll(np.asarray(case.motor.cam.control_radii)[::-1], 1)
    return (
        case.changed(lambda c: c.motor.cam.control_radii, radii)
        .changed(
            lambda c: (
                c.motor.valve_plate.supply.centre,
                c.motor.valve_plate.return_.centre,
                c.motor.valve_plate.shift,
            ),
            (-float(plate.supply.centre), -float(plate.return_.centre), -float(plate.shift)),
        )
        .changed(lambda c: c.point.shaft_speed, -float(case.point.shaft_speed))
    )


@pytest.mark.parametrize("steps", [1, 7])
def test_cam_and_plate_turned_together_turn_the_cycle(steps):
    case = sound_case(3, STRUCTURES[0])
    other, angle = turned(case, steps)
    cycles, metrics = run_all([case, other])
    at = np.linspace(0, 2 * pi, 501)
    here = waveforms_of(single(cycles, 0), at)
    there = waveforms_of(single(cycles, 1), at + angle)
    for name in ("lift", "velocity", "chamber_pressure", "contact_force", "torque"):
        one, two = np.asarray(getattr(here, name)), np.asarray(getattr(there, name))
        np.testing.assert_allclose(one, two, rtol=0, atol=2e-5 * np.abs(one).max())
    for name in RESULTS:
        one, two = np.asarray(getattr(metrics, name))
        assert two == pytest.approx(one, rel=2e-5), name


@pytest.mark.parametrize("seed", range(3))
def test_mirrored_cam_and_plate_run_backwards_obey_the_mirrored_equation(seed):
    """Every term of motion, pressure and force, so that the unique orbit is mirrored too."""
    case = sound_case(seed, STRUCTURES[0])
    other = mirrored(case)
    angle = np.linspace(-2, 5, 401)  # meets no knot, where jerk has two sides
    pressure = np.random.default_rng(seed).uniform(0, 3e7, angle.shape)
    sides = []
    for one, sign in ((case, 1.0), (other, -1.0)):
        motor, fluid, point = one
        radius = motor.cam.pitch_radius(sign * angle)
        chamber = chamber_at(motor, 0.1, sign * angle, radius)
        slope = pressure_slope(motor, fluid, point, chamber, pressure)
        force = radial_force(motor.piston, pressure, 1e5, radius, point.shaft_speed, 12.0)
        even = [radius.value, radius.second, chamber.volume, chamber.supply_area, force]
        even += [chamber.return_area, undercut_factor(radius, motor.roller.radius)]
        odd = [radius.first, radius.third, slope, force * radius.first]
        sides.append([np.asarray(x) for x in even] + [sign * np.asarray(x) for x in odd])
    for one, two in zip(*sides, strict=True):
        np.testing.assert_allclose(one, two, rtol=0, atol=1e-9 * np.abs(one).max())


def test_a_motor_that_is_its_own_mirror_image_runs_the_same_both_ways():
    """Reversing means swapping the port pressures: with a symmetric cam nothing changes."""
    case = sound_case(2, STRUCTURES[0])
    radii = np.asarray(case.motor.cam.control_radii)
    pitch = case.motor.valve_plate.pitch
    case = case.changed(
        lambda c: c.motor.cam.control_radii, (radii + np.roll(radii[::-1], 1)) / 2
    ).changed(lambda c: c.motor.valve_plate.shift, 0.0)
    plate = case.motor.valve_plate
    # Seen from the block the return port of before comes first, mirrored, as the supply port.
    reverse = case.changed(
        lambda c: (
            c.motor.valve_plate.supply.width,
            c.motor.valve_plate.return_.width,
            c.motor.valve_plate.supply.centre,
            c.motor.valve_plate.return_.centre,
        ),
        (
            plate.supply.width,
            plate.return_.width,
            -float(plate.return_.centre) + pitch,
            -float(plate.supply.centre) + pitch,
        ),
    )
    _, metrics = run_all([case, reverse])
    for name in RESULTS:
        one, two = np.asarray(getattr(metrics, name))
        assert two == pytest.approx(one, rel=1e-6), name

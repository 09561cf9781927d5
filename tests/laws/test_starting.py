"""Torque at standstill: by two solvers, against geometry, and by its slopes."""

from math import pi

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from detailed_motors import detailed_case
from motors import STEEL, Case, Structure, sound_case

from camring.geometry.cam import RadialCam
from camring.geometry.piston import Piston, ReturnSpring, Roller
from camring.geometry.profiles import zero_ripple_cams
from camring.geometry.valve_plate import LinearWindow, Port, ValvePlate
from camring.metrics.starting import starting
from camring.physics.friction import ViscousFriction
from camring.physics.leakage import ConstantLeakage
from camring.physics.motor import Motor
from camring.physics.oil.fluid import ConstantFluid
from camring.physics.operating_point import OperatingPoint
from camring.physics.orifice import TurbulentOrifice
from camring.physics.stribeck_friction import StribeckFriction
from camring.reference import machine_of
from camring.reference.standstill import standing_torque

ANGLES = 60
STRUCTURE = Structure("radial", 5, 4, 12, reference="mean")

at_rest = eqx.filter_jit(lambda case: starting(*case, angles=ANGLES))


def with_rest(case, spring=True):
    """The motor with contacts that stick at rest, and springs."""
    friction = StribeckFriction(case.motor.friction.damping, 0.008, 0.05, 0.3, 0.03, 0.12, 0.05)
    springs = ReturnSpring(2e3, 90.0) if spring else None
    motor = eqx.tree_at(
        lambda m: (m.friction, m.piston.spring), case.motor, (friction, springs),
        is_leaf=lambda x: x is None,
    )  # fmt: skip
    return Case(motor, case.fluid, case.point)


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("kind", [sound_case, detailed_case])
def test_both_ways_are_those_of_the_second_solver(kind, seed):
    case = with_rest(kind(seed, STRUCTURE))
    found = at_rest(tuple(case))
    expected = standing_torque(machine_of(*case), np.asarray(found.angle))
    for mine, theirs in zip((found.forward, found.backward), expected, strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=0, atol=1e-9 * np.abs(theirs).max())
    for reverse in (False, True):
        least = np.min(expected[int(reverse)])
        assert float(found.starting_torque(reverse)) == pytest.approx(least, rel=1e-9)


def quiet_motor(roller=0.0, gap=1e-9):
    """A cam without ripple of its own, windows that touch at the dead centres."""
    lobes, pistons = 6, 8
    pitch = 2 * pi / lobes
    steps = next(zero_ripple_cams(pistons, lobes, 24))
    ports = [Port(pitch / 2 * (1 - gap), centre) for centre in (pitch / 4, 3 * pitch / 4)]
    motor = Motor(
        RadialCam(0.09 + 0.01 * steps.control_values(24), repeats=lobes),
        Piston(0.03, 0.3),
        Roller(0.012, 0.028, STEEL),
        STEEL,
        ValvePlate(6e-5, *ports, LinearWindow(1e-6), 0.0, lobes=lobes),
        5e-6,
        TurbulentOrifice(0.65),
        ConstantLeakage(1e-18),
        ViscousFriction(20.0, roller, 0.0),
        pistons=pistons,
        lobes=lobes,
    )
    return Case(motor, ConstantFluid(870.0, 1.4e9, 3e3), OperatingPoint(5.0, 201e5, 1e5, 1e5))


def test_a_cam_without_ripple_starts_with_all_its_ideal_torque_wherever_it_stands():
    found = at_rest(tuple(quiet_motor()))
    np.testing.assert_allclose(found.forward, found.ideal_torque, rtol=1e-5)
    np.testing.assert_allclose(found.backward, found.ideal_torque, rtol=1e-5)


def test_a_rolling_motor_loses_its_coefficient_times_the_arm_of_the_load():
    """With four of eight pistons loaded at `F`, `mu F / cos(phi) (1 + kappa Rf) |C'|` each."""
    case = quiet_motor(0.02)
    motor, found = case.motor, at_rest(tuple(case))
    force = 200e5 * float(motor.piston.area)
    shifts = motor.cam.period / motor.distinct_phases * np.arange(motor.distinct_phases)
    radius = motor.cam.pitch_radius(jnp.asarray(np.asarray(found.angle)[:, None] + shifts))
    r, r1, r2 = (np.asarray(each) for each in radius[:3])
    stretch = 1 + 0.012 * (r**2 + 2 * r1**2 - r * r2) / (r**2 + r1**2) ** 1.5
    arm = np.hypot(1, r1 / r) * stretch * np.hypot(r, r1)
    lost = 0.02 * force * 2 * np.sum(np.where(r1 > 0, arm, 0), axis=1)
    # Where a piston stands in a dwell its slope does not say which port it is at.
    moving = np.min(np.abs(r1), axis=1) > 1e-9
    assert np.count_nonzero(moving) > 15
    expected = float(found.ideal_torque) - lost
    np.testing.assert_allclose(np.asarray(found.forward)[moving], expected[moving], rtol=1e-5)


def test_slopes_are_differences():
    case = with_rest(detailed_case(0, STRUCTURE))

    def where(motor):
        return motor.friction.roller_static, motor.roller.radius, motor.piston.bore

    def least(values):
        motor = eqx.tree_at(where, case.motor, tuple(values))
        return starting(motor, case.fluid, case.point, angles=ANGLES).starting_torque()

    least = jax.jit(least)
    values = jnp.stack([jnp.asarray(each) for each in where(case.motor)])
    slopes = jax.jit(jax.jacfwd(least))(values)
    for place, value in enumerate(values):
        step = 1e-5 * float(value)
        above, below = (float(least(values.at[place].add(by))) for by in (step, -step))
        assert float(slopes[place]) == pytest.approx((above - below) / (2 * step), rel=1e-5)

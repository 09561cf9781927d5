"""Limits in which a motor becomes simple."""

from math import pi, sqrt

import numpy as np
import pytest
from both_solvers import run_all
from motors import STRUCTURES, sound_case

from camring.physics.linearised import LinearChamber, torque_harmonics


def idealised(case, stiffness):
    """Nothing leaks, rubs or throttles, ports change over at the dead centres, stiff oil."""
    pitch = case.motor.valve_plate.pitch
    count = case.motor.cam.control_count
    sine = 0.2 - 0.008 * np.cos(2 * pi * np.arange(count) / count)
    return (
        case.changed(lambda c: c.fluid.bulk_modulus, stiffness)
        .changed(lambda c: (c.motor.leakage.coefficient, c.motor.friction.damping), (0.0, 0.0))
        .changed(lambda c: c.motor.cam.control_radii, sine)
        .changed(
            lambda c: (
                c.motor.valve_plate.supply.width,
                c.motor.valve_plate.return_.width,
                c.motor.valve_plate.shift,
                c.motor.valve_plate.window.ramp,
                c.motor.valve_plate.port_area,
            ),
            (pitch / 2, pitch / 2, 0.0, 0.05, 20 * float(case.motor.valve_plate.port_area)),
        )
    )


def test_a_stiff_lossless_motor_gives_the_ideal_torque_and_the_rippling_sine():
    """Mean torque dp V_D / (2 pi); ripple that of the rectified sine, K = 4.

    What remains is compression, as 1/modulus: 0.2 % at 20 GPa, a tenth of it here.
    """
    case = idealised(sound_case(0, STRUCTURES[0]), 2e11)
    _, metrics = run_all([case])
    assert float(metrics.hydromechanical_efficiency[0]) == pytest.approx(1, abs=3e-4)
    assert float(metrics.volumetric_efficiency[0]) == pytest.approx(1, abs=3e-4)
    assert float(metrics.efficiency[0]) == pytest.approx(1, abs=4e-4)
    true_rms = sqrt(2) * float(metrics.torque_ripple[0])
    assert true_rms == pytest.approx(0.09772081, rel=0.02)


def test_stiffer_oil_comes_closer_to_the_ideal():
    case = sound_case(0, STRUCTURES[0])
    cases = [idealised(case, modulus) for modulus in (1e9, 4e9, 1.6e10)]
    _, metrics = run_all(cases)
    shortfall = 1 - np.asarray(metrics.volumetric_efficiency)
    assert np.all(np.diff(np.abs(shortfall)) < 0)


def test_twice_the_leakage_costs_twice_the_leaked_oil():
    case = sound_case(1, STRUCTURES[0])
    coefficient = float(case.motor.leakage.coefficient)
    cases = [
        case.changed(lambda c: c.motor.leakage.coefficient, factor * coefficient)
        for factor in (1, 2, 3)
    ]
    _, metrics = run_all(cases)
    steps = np.diff(np.asarray(metrics.leakage_loss))
    assert steps[1] == pytest.approx(steps[0], rel=2e-3)


# --- the linear model ------------------------------------------------------

CHAMBER = LinearChamber(volume=2e-5, piston_area=1e-3, bulk_modulus=1.4e9, conductance=3e-12)


def test_the_linear_chamber_is_a_high_pass_from_lift_to_pressure():
    slow, fast = np.array([1e-7, 1e-6]), np.array([1e7, 1e8])
    corner = 1 / float(CHAMBER.time_constant)
    np.testing.assert_allclose(
        CHAMBER.transfer(corner * slow), -1e-3 / 3e-12 * 1j * corner * slow, rtol=2e-6
    )
    np.testing.assert_allclose(CHAMBER.transfer(corner * fast), -1.4e9 * 1e-3 / 2e-5, rtol=2e-6)
    assert abs(CHAMBER.transfer(np.array(corner))) == pytest.approx(
        1.4e9 * 1e-3 / 2e-5 / sqrt(2), rel=1e-12
    )
    assert float(CHAMBER.time_constant) == pytest.approx(2e-5 / (1.4e9 * 3e-12), rel=1e-12)


def test_the_linear_chamber_solves_its_differential_equation():
    """dP/dt + (beta Ch/V) P = -(beta Ap/V) ds/dt for a lift that is one cosine."""
    frequency, time = 40.0, np.linspace(0, 0.3, 4001)
    lift = 1e-4 * np.exp(1j * frequency * time)
    pressure = np.asarray(CHAMBER.transfer(np.array(frequency))) * lift
    left = 1j * frequency * pressure + pressure / float(CHAMBER.time_constant)
    right = -1.4e9 * 1e-3 / 2e-5 * 1j * frequency * lift
    np.testing.assert_allclose(left, right, rtol=1e-12)


def test_torque_harmonics_are_the_harmonics_of_the_product():
    rng = np.random.default_rng(2)
    highest, step = 6, 3
    orders = np.arange(-highest, highest + 1)

    def real_series():
        half = rng.normal(size=highest) + 1j * rng.normal(size=highest)
        return np.concatenate([half[::-1].conj(), [rng.normal()], half])

    force, lift = real_series(), real_series()
    angle = 2 * pi / step * np.arange(64) / 64
    waves = np.exp(1j * step * orders[:, None] * angle)
    product = (force @ waves).real * ((1j * step * orders * lift) @ waves).real
    expected = np.array([np.mean(product * np.exp(-1j * step * n * angle)) for n in orders])
    np.testing.assert_allclose(torque_harmonics(force, lift, step), expected, atol=1e-12)

"""A motor of an open program, whose numbers are known to the last digit.

Seven pistons on six lobes under 450 bar: `hydraulic-motor-optimizer`, by the constants of its
`include/config.h`. Its chamber pressure is the one at which flows balance, as with a stiff oil,
and its torque that of pressure alone. What this shows stands in docs/validation.md.
"""

from math import pi, tan

import jax
import pytest

from camring.files.motor import parse_motor_file
from camring.files.starting.library import published
from camring.physics.resolution import Resolution
from camring.programs.compiled import simulate, summarise

TORQUE, FLOW, LEAKAGE, PEAK_TO_PEAK = 2135.862, 179.772 / 6e4, 122.14, 0.0253  # theirs, SI


@pytest.fixture(scope="module")
def file():
    return parse_motor_file(published()["open-7x6"])


@pytest.fixture(scope="module")
def found(file):
    system = file.system
    (point,) = system.operating_points
    cycle = simulate(system.motor, system.fluid, point, Resolution(elements=320))
    assert int(cycle.verdict.code) == 0
    return jax.device_get(summarise(cycle))


def test_mean_torque_without_the_films_drag(file, found):
    """Their pistons leak through the gap and do not drag in it."""
    (point,) = file.system.operating_points
    drag = float(found.friction_loss) / float(point.shaft_speed)
    assert 2 < drag < 3
    assert float(found.mean_torque) + drag == pytest.approx(TORQUE, rel=1e-6)


def test_supply_flow_and_power_that_leaks(found):
    """They sum 15,003 steps of three revolutions, on a cam of straight pieces."""
    assert float(found.supply_flow) == pytest.approx(FLOW, rel=1e-5)
    assert float(found.leakage_loss) == pytest.approx(LEAKAGE, rel=1.5e-4)


def test_ripple_is_that_of_a_sine_cam_on_fourteen_half_waves(file, found):
    """`(pi/14) tan(pi/28)`, docs/theory.md section 11; windows that open in 0.6 deg add little."""
    closed_form = pi / 14 * tan(pi / 28)
    assert closed_form == pytest.approx(0.02528, abs=5e-6)
    assert float(found.torque_ripple_peak_to_peak) == pytest.approx(closed_form, rel=5e-3)
    assert float(found.torque_ripple_peak_to_peak) == pytest.approx(PEAK_TO_PEAK, abs=1e-4)


def test_displacement_is_pistons_lobes_area_and_stroke(found):
    assert float(found.displacement) == pytest.approx(42 * pi / 4 * 0.0275**2 * 0.012, rel=1e-9)

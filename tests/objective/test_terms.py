"""The terms of the objective at their edges."""

from types import SimpleNamespace

import numpy as np
import pytest

from camring.objective.terms import TERM_RESULTS, raw_terms


def inefficiency(input_power, output_power, ideal_torque=1.0):
    pumps = input_power < 0
    efficiency = input_power / output_power if pumps else output_power / input_power
    results = dict.fromkeys(TERM_RESULTS, 0.0) | {"efficiency": efficiency}
    found = SimpleNamespace(**results, input_power=input_power, ideal_torque=ideal_torque)
    return float(raw_terms(found)["inefficiency"])


def test_a_motor_loses_what_its_efficiency_leaves():
    assert inefficiency(100.0, 90.0) == pytest.approx(0.1)


def test_a_brake_is_worse_than_any_motor():
    assert inefficiency(100.0, -20.0) == pytest.approx(1.2)


def test_a_pump_is_the_worse_the_more_it_delivers():
    """A pump's good efficiency must not count as a motor's."""
    assert 3 < inefficiency(-50.0, -100.0) < inefficiency(-90.0, -100.0) < 4


def test_from_motor_over_brake_to_pump_it_gets_worse_without_a_jump():
    """Less and less comes in as oil, more and more at the shaft, round by round degree."""
    turned = np.linspace(np.pi / 4, -3 * np.pi / 4, 2000)[1:-1]
    found = np.array([inefficiency(np.cos(each), np.sin(each)) for each in turned])
    steps = np.diff(found)
    assert np.all(steps > 0)
    assert steps.max() < 2.5 * np.pi / 2000
    assert found[0] == pytest.approx(0, abs=0.01)
    assert found[-1] == pytest.approx(4, abs=0.01)


def test_where_it_is_to_brake_shaft_and_oil_change_places():
    """What is good there is a pump; what drives is as bad as a pump where a motor is wanted."""
    turned = np.linspace(np.pi / 4, -3 * np.pi / 4, 200)[1:-1]
    for oil, shaft in np.stack([np.cos(turned), np.sin(turned)], axis=1):
        braking = inefficiency(-shaft, -oil, ideal_torque=-1.0)
        assert braking == pytest.approx(inefficiency(oil, shaft), rel=1e-12)

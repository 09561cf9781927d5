"""The terms of the objective at their edges."""

from types import SimpleNamespace

import pytest

from camring.objective.terms import TERM_RESULTS, raw_terms


def inefficiency(input_power, output_power):
    results = dict.fromkeys(TERM_RESULTS, 0.0) | {"efficiency": output_power / input_power}
    return float(raw_terms(SimpleNamespace(**results, input_power=input_power))["inefficiency"])


def test_a_motor_loses_what_its_efficiency_leaves():
    assert inefficiency(100.0, 90.0) == pytest.approx(0.1)


def test_a_brake_is_worse_than_any_motor():
    assert inefficiency(100.0, -20.0) == pytest.approx(1.2)


def test_a_pump_is_the_worse_the_more_it_delivers():
    """Shaft power in, oil out: both negative, and their ratio looks like an efficiency."""
    assert 2 < inefficiency(-90.0, -100.0) < inefficiency(-50.0, -100.0)

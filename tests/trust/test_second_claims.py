"""What the second solver has not seen it is never said to have confirmed."""

import dataclasses
import math

import pytest
from motors import sound_case

from camring.metrics.summary import Metrics
from camring.objective.constraints import BANDS, LOWER_LIMITS, UPPER_LIMITS
from camring.reference import independent_results
from camring.studies.reference_results import GEOMETRY_ALONE, all_results


@pytest.fixture(scope="module")
def found():
    return independent_results(*sound_case(0), tolerance=1e-4)


def test_every_limit_bounds_a_result_that_the_second_solver_has(found):
    bounded = {*UPPER_LIMITS.values(), *LOWER_LIMITS.values(), *sum(BANDS.values(), ())}
    assert bounded - {*found} == {*GEOMETRY_ALONE}


def test_what_it_does_not_compute_is_no_number(found):
    ours = {each.name: 1.0 for each in dataclasses.fields(Metrics)}
    whole = all_results(ours, found)
    assert whole.keys() == ours.keys()
    for name, value in whole.items():
        if name in found:
            assert value == found[name]
        else:
            assert value == 1.0 if name in GEOMETRY_ALONE else math.isnan(value), name

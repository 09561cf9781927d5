"""Under the moving hand a design is what it is at rest, to what the eye can tell."""

from dataclasses import replace

import numpy as np
import pytest

from camring.files.motor import parse_motor_file
from camring.files.starting.library import library
from camring.metrics.shown import METRICS
from camring.studio.evaluation import evaluated
from camring.studio.following import followed
from camring.studio.moved_design import Movable

pytestmark = pytest.mark.slow

FILE = parse_motor_file(library()["wheel"])
FOLLOWED = 3e-4  # of a result, where a batch at final resolution differs from one motor
OF_FLOW = 2e-3  # of its ripples, which jumps of the flow carry
WAVES = 4e-3  # of their range; orders are those of samples, into which a jump aliases


@pytest.fixture(scope="module")
def both():
    system = Movable(FILE).system
    first, second = system.operating_points
    system = replace(system, operating_points=(first, replace(second, reverse=True)))
    return followed(system, FILE.goal), evaluated(system, FILE.goal)


def test_results_and_limits_agree_forwards_and_backwards(both):
    found, exact = both
    assert found.fault == exact.fault == ""
    for k, name in enumerate(METRICS):
        if name == "power_residual":  # of the numerics, not of the motor
            continue
        close = OF_FLOW if "flow_ripple" in name else FOLLOWED
        scale = np.abs(exact.results[:, k]) + 1e-12 * np.max(np.abs(exact.results))
        assert np.all(np.abs(found.results[:, k] - exact.results[:, k]) < close * scale), name
    for name, g in exact.limits.items():
        assert found.limits[name] == pytest.approx(g, abs=FOLLOWED), name


def test_waves_agree_forwards_and_backwards(both):
    found, exact = both
    for mine, other in zip(found.waves, exact.waves, strict=True):
        for name in mine._fields:
            here, there = (np.asarray(getattr(each, name)) for each in (mine, other))
            size = np.max(np.abs(there)) if "orders" in name else np.ptp(there)
            assert np.max(np.abs(here - there)) < WAVES * size, name

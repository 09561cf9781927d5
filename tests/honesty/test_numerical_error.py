"""The reported numerical error never understates the true one (house.md)."""

from dataclasses import replace

import numpy as np
import pytest
from both_roads import RESULTS, independent_awkward, independent_sound, run_all, single
from motors import AWKWARD, STRUCTURES, awkward_case, sound_case

from camring.metrics.error_estimate import error_estimate
from camring.physics.resolution import Resolution

# The independent solver's own error, relative; below it the two cannot be told apart.
JUDGE = 2e-8
SEEDS = range(8)


def understated(cases, truths):
    """Results whose true error is larger than the reported one, as sentences."""
    cycles, metrics = run_all(cases)
    _, coarser = run_all(cases, Resolution().second_look())
    reported = error_estimate(metrics, coarser)
    for index, truth in enumerate(truths):
        if int(cycles.verdict.code[index]) != 0:
            continue  # refused: nothing is claimed
        found, error = single(metrics, index), single(reported, index)
        for name in RESULTS:
            wrong = abs(float(getattr(found, name)) - truth[name])
            claimed = float(getattr(error, name))
            if wrong > claimed + JUDGE * abs(truth[name]):
                share = abs(truth[name]) or 1.0
                yield f"{index}: {name} {wrong / share:.1e}, said {claimed / share:.1e}"


@pytest.mark.parametrize("structure", STRUCTURES[:2], ids=lambda s: s.kind)
def test_the_error_of_sound_motors_is_not_understated(structure):
    cases = [sound_case(seed, structure) for seed in SEEDS]
    truths = [independent_sound(seed, structure) for seed in SEEDS]
    assert list(understated(cases, truths)) == []


@pytest.mark.parametrize("trouble", AWKWARD)
def test_the_error_of_awkward_motors_is_not_understated(trouble):
    seeds = range(4)
    cases = [awkward_case(seed, trouble) for seed in seeds]
    truths = [independent_awkward(seed, trouble, STRUCTURES[0]) for seed in seeds]
    assert list(understated(cases, truths)) == []


def test_elements_that_are_not_filled_are_as_if_they_were_not_there():
    cases = [sound_case(seed, STRUCTURES[0]) for seed in SEEDS]
    _, filled = run_all(cases, replace(Resolution(), filled=0.7))
    _, fewer = run_all(cases, replace(Resolution(), elements=224))
    for name in RESULTS:
        np.testing.assert_allclose(
            getattr(filled, name), getattr(fewer, name), rtol=1e-9
        )  # rounding


def test_the_reported_error_is_not_absurdly_large_either():
    """An estimate that says one would never understate and never help."""
    cases = [sound_case(seed, STRUCTURES[0]) for seed in SEEDS]
    _, metrics = run_all(cases)
    _, coarser = run_all(cases, Resolution().second_look())
    reported = error_estimate(metrics, coarser)
    for name in ("mean_torque", "torque_ripple", "efficiency", "max_pressure", "supply_flow"):
        share = np.asarray(getattr(reported, name)) / np.abs(np.asarray(getattr(metrics, name)))
        assert np.median(share) < 6e-6, name

"""Every result of a sound motor within 1e-5 of the independent solver, as it comes."""

import numpy as np
import pytest
from both_solvers import (
    independent_awkward,
    independent_sound,
    plain_errors,
    records,
    relative_errors,
    run_all,
)
from motors import AWKWARD, STRUCTURES, awkward_case, sound_case

PROMISED = 1e-5
SEEDS = range(8)


def described(errors):
    worst = sorted(errors.items(), key=lambda item: -item[1])[:4]
    return ", ".join(f"{name} {error:.1e}" for name, error in worst)


@pytest.mark.parametrize("structure", STRUCTURES, ids=lambda s: f"{s.kind}-{s.pistons}-{s.lobes}")
def test_sound_motors_are_as_accurate_as_promised(structure):
    cases = [sound_case(seed, structure) for seed in SEEDS]
    cycles, metrics = run_all(cases)
    assert np.all(np.asarray(cycles.verdict.code) == 0)
    for seed, case, found in zip(SEEDS, cases, records(metrics), strict=True):
        errors = relative_errors(found, independent_sound(seed, structure), case)
        bad = max(errors.values()) >= PROMISED
        assert not bad, f"seed {seed}: {described(errors)}"


@pytest.mark.parametrize("trouble", AWKWARD)
def test_awkward_motors_are_as_accurate_or_refused(trouble):
    """Off by more than was promised only with a verdict that says so."""
    seeds = range(3)
    cases = [awkward_case(seed, trouble) for seed in seeds]
    cycles, metrics = run_all(cases)
    codes = np.asarray(cycles.verdict.code)
    for seed, case, found, code in zip(seeds, cases, records(metrics), codes, strict=True):
        errors = relative_errors(found, independent_awkward(seed, trouble, STRUCTURES[0]), case)
        bad = code == 0 and max(errors.values()) >= PROMISED
        assert not bad, f"seed {seed}: {described(errors)}"


def test_most_sound_motors_meet_the_promise_even_where_results_nearly_cancel():
    """Without the floors that `relative_errors` gives to differences of large numbers."""
    cases = [sound_case(seed, STRUCTURES[0]) for seed in SEEDS]
    _, metrics = run_all(cases)
    worst = [
        max(plain_errors(found, independent_sound(seed, STRUCTURES[0])).values())
        for seed, found in zip(SEEDS, records(metrics), strict=True)
    ]
    assert np.median(worst) < PROMISED

"""Slopes by differences: exact enough on what is smooth, refused on noise, made at once."""

import zlib

import numpy as np
import pytest

from camring.search.descent.differences import LONGEST, SHORTEST, Differences, NoSlopes
from camring.search.descent.gradient import GradientSearch
from camring.search.descent.path import Known
from camring.search.minimise import minimise
from camring.search.problem import Evaluation, Problem
from camring.search.strategies import Task, strategy_named

BUDGET = 300


def smooth(x):
    return 1 + np.sum(np.sin(3 * x + np.arange(len(x)))), np.array([x[0] * x[-1] - 0.4])


def slopes_of_smooth(x):
    of_limit = np.zeros(len(x))
    of_limit[0], of_limit[-1] = x[-1], x[0]
    return 3 * np.cos(3 * x + np.arange(len(x))), of_limit


def noise(x, size):
    """The same for the same point, and another for each other."""
    return size * (zlib.crc32(np.asarray(x).tobytes()) / 2**31 - 1)


def noisy(function, size):
    def evaluate(x):
        objective, limits = function(x)
        return objective + noise(x, size), limits + noise(-x, size)

    return evaluate


class Laboratory:
    """Answers whatever is asked, and notes what."""

    def __init__(self, function, fails=lambda x: False):
        self.function, self.fails, self.asked, self.ahead = function, fails, [], []

    def __call__(self, point, ahead=()):
        self.asked.append(point)
        self.ahead.append([each.tobytes() for each in ahead])
        if self.fails(point):
            return Evaluation(0, point, np.nan, np.array([np.nan]), failure="it burst")
        return Evaluation(0, point, *self.function(point))


def measured(function, start, sizes=(1.0, 1.0), **settings):
    laboratory = Laboratory(function, **settings)
    known = Known([], laboratory)
    return Differences.measured(known, known.at(np.array(start)), np.array(sizes)), laboratory


INSIDE, ON_THE_EDGE = [0.25, 0.625, 0.1875, 0.75], [0.0, 1.0, 1.0, 0.5]


@pytest.mark.parametrize("start", [INSIDE, ON_THE_EDGE])
def test_of_what_is_smooth_they_are_its_slopes(start):
    differences, laboratory = measured(smooth, start)
    assert differences.step == SHORTEST
    assert len(laboratory.asked) == 4  # a row of three tells that there is no noise
    of_objective, of_limits = differences(np.array(start))
    exact, of_limit = slopes_of_smooth(np.array(start))
    # A step's length times half the second derivative, 9 at most.
    np.testing.assert_allclose(of_objective, exact, atol=5 * SHORTEST)
    np.testing.assert_allclose(of_limits, of_limit[None], atol=5 * SHORTEST)
    assert all(np.all((each >= 0) & (each <= 1)) for each in laboratory.asked)


@pytest.mark.parametrize("size", [1e-9, 1e-7, 1e-6])
def test_with_noise_the_step_is_so_long_that_slopes_are_still_some(size):
    differences, _ = measured(noisy(smooth, size), INSIDE)
    assert SHORTEST <= differences.step <= LONGEST
    exact, _ = slopes_of_smooth(np.array(INSIDE))
    found, _ = differences(np.array(INSIDE))
    # Noise of a row of three is known within a factor of three or so.
    assert np.linalg.norm(found - exact) < 0.1 * np.linalg.norm(exact)


@pytest.mark.parametrize("size", [3e-4, 1e-2, 1.0])
def test_noise_that_leaves_no_slopes_is_said(size):
    with pytest.raises(NoSlopes, match="differ by noise"):
        measured(noisy(smooth, size), INSIDE)


def test_what_has_flat_limits_or_rounds_is_not_noisy():
    differences, _ = measured(lambda x: (x[0], np.array([-1.0])), INSIDE)
    assert differences.step == SHORTEST
    differences, _ = measured(lambda x: (x[0] + 1e3, np.array([-0.1 - x[1] / 3])), INSIDE)
    assert differences.step == SHORTEST


@pytest.mark.parametrize("value", [0.0, 3.0])
def test_where_the_objective_is_the_same_that_is_said(value):
    with pytest.raises(NoSlopes, match="is the same"):
        measured(lambda x: (value, np.array([x[0]])), INSIDE)


def test_a_limit_in_large_units_hides_no_noise():
    def evaluate(x):
        objective, _ = noisy(smooth, 1e-2)(x)
        return objective, 1e6 * smooth(x)[1]

    with pytest.raises(NoSlopes, match="differ by noise"):
        measured(evaluate, INSIDE, sizes=(1.0, 1e6))


def test_where_a_step_fails_the_other_side_is_taken():
    differences, _ = measured(smooth, INSIDE, fails=lambda x: x[1] > 0.625)
    found, _ = differences(np.array(INSIDE))
    exact, _ = slopes_of_smooth(np.array(INSIDE))
    np.testing.assert_allclose(found, exact, atol=5 * SHORTEST)
    differences, _ = measured(smooth, INSIDE, fails=lambda x: x[1] != 0.625)
    found, _ = differences(np.array(INSIDE))
    np.testing.assert_allclose(found, exact * [1, 0, 1, 1], atol=5 * SHORTEST)


def test_all_of_a_gradient_can_be_asked_at_once():
    differences, laboratory = measured(smooth, INSIDE)
    before = len(laboratory.asked)
    differences(np.array(INSIDE))
    asked = [each.tobytes() for each in laboratory.asked[before:]]
    assert len(asked) == 4
    assert laboratory.ahead[before] == asked[1:]
    differences(np.array(INSIDE))
    assert len(laboratory.asked) == before + 4  # and nothing twice


def problem_of(function, dimension=8):
    return Problem(
        dimension, 1, lambda points: [(*function(x), np.nan, None) for x in np.atleast_2d(points)]
    )


def valley(point):
    """Rosenbrock's in eight variables, at most 1 at its bottom's end, with a limit beside it."""
    x = 4 * point - 2
    return float(np.sum(100 * (x[1:] - x[:-1] ** 2) ** 2 + (1 - x[:-1]) ** 2)), 0.5 - x[3:4]


def searched(name, function, budget=BUDGET):
    strategy = strategy_named(name, Task(8, budget))
    return minimise(problem_of(function), strategy, budget, seed=0)


def test_a_narrow_bent_valley_is_gone_down_to_its_end():
    found = searched("differences", valley)
    assert found.best.feasible()
    assert found.best.objective < 0.01
    assert found.history[-1].phase.startswith("descent")


def test_a_noisy_valley_is_left_to_processes():
    found = searched("differences", noisy(valley, 10.0), 60)
    phases = [each.phase for each in found.history]
    assert sum(each.startswith("descent") for each in phases) <= 9  # three rows of three
    assert phases[-1] == "scbo"


def test_automatic_is_what_takes_the_fewest_evaluations():
    def named(*task, **more):
        return type(strategy_named("automatic", Task(*task, **more))).__name__

    assert named(6, 300) == "Scbo"
    assert named(11, 300) == "Hybrid"
    assert named(11, 60) == "Scbo"  # no descent can be had for that
    assert named(11, 300, approximate=lambda points: points[:, 0]) == "Scbo"


def test_as_a_stage_descents_start_from_all_that_was_evaluated():
    """The best of them is none of its own design."""
    history = [
        Evaluation(trial, np.full(8, place), *valley(np.full(8, place)))
        for trial, place in enumerate((0.1, 0.74, 0.9))
    ]
    proposal = GradientSearch(8).propose(history, {}, 0)
    assert proposal.phase == "descent 1"
    assert proposal.memory["starts"] == [1]
    assert np.linalg.norm(proposal.point - history[1].point) < 1e-5


def test_an_objective_may_be_zero_where_the_search_begins():
    """Then its size is that of its changes."""
    given = np.full(8, 0.5)

    def bowl(x):
        return float(100 * np.sum((x - 0.3) ** 2 - (given - 0.3) ** 2)), np.array([-1.0])

    strategy = GradientSearch(8, given=(tuple(given),))
    found = minimise(problem_of(bowl), strategy, 120, seed=1)
    assert found.history[0].objective == 0
    assert found.best.objective == pytest.approx(bowl(np.full(8, 0.3))[0], abs=1e-3)


@pytest.mark.parametrize("level", [0.0, 1e4, -1e6])
def test_a_constant_part_of_the_objective_costs_no_accuracy(level):
    def raised(point):
        objective, limits = valley(point)
        return objective + level, limits

    found = searched("differences", raised)
    assert found.best.objective - level < 0.05

"""Descent by slopes: published optima, several starts, failures, and the same bits again."""

import json

import numpy as np
import pytest

from camring.search.descent.gradient import SOBOL_STARTS, GradientSearch
from camring.search.minimise import minimise
from camring.search.problem import Evaluation, Problem

STEP = 1e-6


def slopes_of(problem):
    """Central differences, good to ten digits on these smooth problems."""

    def slopes(point):
        steps = STEP * np.eye(problem.dimension)
        ahead, behind = problem.evaluate(point + steps), problem.evaluate(point - steps)
        rise = [
            np.concatenate([[a[0] - b[0]], a[1] - b[1]]) / (2 * STEP)
            for a, b in zip(ahead, behind, strict=True)
        ]
        objective, *constraints = np.array(rise).T
        return objective, np.array(constraints).reshape(problem.constraint_count, -1)

    return slopes


def searched(problem, budget=400, seed=0, **settings):
    strategy = GradientSearch(problem.dimension, slopes_of(problem), **settings)
    return minimise(problem, strategy, budget, seed=seed)


def test_six_active_constraints_of_ten_variables(g07):
    for seed in range(3):
        found = searched(g07, seed=seed)
        assert found.best.feasible()
        assert found.best.objective == pytest.approx(24.3062, rel=1e-5)
        assert "3 of 3 descents" in found.stop_reason


def test_a_band_as_thin_as_a_displacements(thin_slab, thin_slab_minimum):
    found = searched(thin_slab)
    assert found.best.feasible()
    assert found.best.objective < 1.0001 * thin_slab_minimum


def test_several_starts_find_the_best_of_several_minima(townsend):
    """At least nine of ten seeds: eight descents cannot see every corner."""
    best = [searched(townsend, seed=seed).best.objective for seed in range(10)]
    assert np.sum(np.array(best) < -2.0239) >= 9


@pytest.mark.long
def test_a_tenth_of_the_evaluations_that_no_slopes_need(thin_slab, thin_slab_found):
    """To the objective at which the Bayesian search of 220 evaluations ends."""
    target = thin_slab_found.best.objective
    history = searched(thin_slab).history
    needed = next(e.trial for e in history if e.feasible() and e.objective <= target) + 1
    assert needed - SOBOL_STARTS <= len(thin_slab_found.history) / 10


def test_any_trial_is_proposed_again_with_the_same_bits(townsend):
    memories = []
    strategy = GradientSearch(2, slopes_of(townsend), given=((0.5, 0.5),))
    found = minimise(
        townsend,
        strategy,
        80,
        seed=3,
        on_evaluation=lambda evaluation, memory: memories.append(json.dumps(memory)),
    )
    assert len({one.phase for one in found.history}) > 3
    for cut in range(len(found.history)):
        memory = json.loads(memories[cut - 1]) if cut else {}
        begun_anew = GradientSearch(2, slopes_of(townsend), given=((0.5, 0.5),))
        for each in (strategy, begun_anew):  # the one goes on where it waits, the other replays
            again = each.propose(found.history[:cut], memory, 3)
            assert again.point.tobytes() == found.history[cut].point.tobytes(), cut
            assert json.dumps(again.memory) == memories[cut], cut


def test_a_descent_under_way_asks_for_no_gradient_twice(townsend):
    asked = []

    def slopes(point):
        asked.append(point.tobytes())
        return slopes_of(townsend)(point)

    found = minimise(townsend, GradientSearch(2, slopes), 30, seed=3)
    assert len(asked) < 2 * len(found.history)  # objective and limits each ask


def parabola(failing=lambda point: False, limit=None):
    """Least at 0.7 everywhere; fails where asked; the sum of coordinates kept below a limit."""

    def evaluate(points):
        found = []
        for point in points:
            failed = failing(point)
            value = np.nan if failed else float(np.sum((point - 0.7) ** 2)) + 1
            g = [] if limit is None else [np.sum(point) - limit]
            found.append((value, np.array(g), np.nan, "no such design" if failed else None))
        return found

    return Problem(3, 0 if limit is None else 1, evaluate)


def slopes_of_parabola(point):
    return 2 * (point - 0.7), np.ones((1, 3))


def test_designs_that_fail_are_walked_around():
    """Nothing works where a first step that is too long ends."""
    problem = parabola(lambda point: point[0] > 0.8, limit=2.0)
    found = minimise(problem, GradientSearch(3, slopes_of_parabola), 300)
    assert any(each.failed for each in found.history)
    assert found.best.feasible()
    assert found.best.objective == pytest.approx(1 + 3 * (2 / 3 - 0.7) ** 2, rel=1e-5)


def test_when_no_design_keeps_the_limits_the_least_violation_is_found():
    found = minimise(parabola(limit=-0.5), GradientSearch(3, slopes_of_parabola), 300)
    assert not found.best.feasible()
    assert found.best.violation == pytest.approx(0.5, abs=1e-6)
    assert "descents" in found.stop_reason


def test_when_every_start_fails_the_search_says_so():
    strategy = GradientSearch(3, slopes_of_parabola)
    history = [
        Evaluation(trial, np.full(3, trial / 10), np.nan, np.array([np.nan]), failure="nothing")
        for trial in range(SOBOL_STARTS)
    ]
    assert "0 usable starts" in strategy.propose(history, {}, 0).reason


def test_no_point_leaves_the_box_and_none_is_asked_for_twice(thin_slab):
    history = searched(thin_slab).history
    points = np.array([each.point for each in history])
    assert points.min() >= 0
    assert points.max() <= 1
    assert len({point.tobytes() for point in points}) == len(points)

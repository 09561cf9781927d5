"""The simplex in a box, under constraints, stopped and continued."""

import json

import numpy as np
import pytest

from camring.search.minimise import minimise
from camring.search.nelder_mead import NelderMead
from camring.search.nelder_mead_moves import to_angles, to_box
from camring.search.problem import Evaluation, Problem, Stop


def problem(objective, dimension, constraints=None, count=0):
    def evaluate(points):
        return [
            (
                float(objective(point)),
                np.array(constraints(point) if constraints else [], dtype=float),
                np.nan,
                None,
            )
            for point in points
        ]

    return Problem(dimension, count, evaluate)


def rosenbrock(point):
    """Minimum 0 at x = 1, which is 0.75 of the box [-2, 2]."""
    x = 4 * point - 2
    return np.sum(100 * (x[1:] - x[:-1] ** 2) ** 2 + (1 - x[:-1]) ** 2)


@pytest.mark.parametrize(("dimension", "budget"), [(2, 300), (4, 1200)])
def test_rosenbrock_in_a_box(dimension, budget):
    strategy = NelderMead(dimension, start=(0.2,) * dimension, step=0.1)
    outcome = minimise(problem(rosenbrock, dimension), strategy, budget)
    assert outcome.best.objective < 1e-6
    np.testing.assert_allclose(outcome.best.point, 0.75, atol=1e-3)


def test_a_minimum_on_the_bounds_is_reached():
    target = np.array([1.3, 0.5, -0.2, 0.5])
    outcome = minimise(
        problem(lambda point: np.sum((point - target) ** 2), 4), NelderMead(4, step=0.1), 600
    )
    np.testing.assert_allclose(outcome.best.point, [1.0, 0.5, 0.0, 0.5], atol=1e-4)
    assert "shrunk" in outcome.stop_reason
    assert all(np.all((one.point >= 0) & (one.point <= 1)) for one in outcome.history)


@pytest.mark.parametrize("penalty_weight", [None, 1e4])
def test_a_constraint_is_kept(penalty_weight):
    target = np.array([0.7, 0.8])
    outcome = minimise(
        problem(
            lambda point: np.sum((point - target) ** 2),
            2,
            lambda point: [point[0] + point[1] - 1.0],
            1,
        ),
        NelderMead(2, start=(0.2, 0.2), step=0.1, penalty_weight=penalty_weight, tolerance=1e-3),
        400,
    )
    np.testing.assert_allclose(outcome.best.point, [0.45, 0.55], atol=0.02)


def test_an_infeasible_start_finds_its_way_in():
    outcome = minimise(
        problem(lambda p: p[0], 3, lambda p: [0.8 - p[0], 0.5 - p[1]], 2),
        NelderMead(3, start=(0.2, 0.2, 0.2), step=0.1),
        300,
    )
    assert outcome.best.feasible()
    assert outcome.best.objective == pytest.approx(0.8, abs=1e-3)


def test_failed_evaluations_count_as_worst():
    def objective(point):
        return np.nan if point[0] > 0.5 else -point[0] + (point[1] - 0.3) ** 2

    outcome = minimise(problem(objective, 2), NelderMead(2, start=(0.3, 0.6), step=0.15), 300)
    assert outcome.best.objective == pytest.approx(-0.5, abs=1e-3)
    assert any(one.failed for one in outcome.history)


def test_no_point_is_evaluated_twice():
    outcome = minimise(
        problem(lambda p: abs(p[0] - 1.0) + abs(p[1]), 2), NelderMead(2, step=0.3), 200
    )
    points = np.array([one.point for one in outcome.history])
    distance = np.max(np.abs(points[:, None] - points[None]), axis=-1)
    assert np.min(distance[~np.eye(len(points), dtype=bool)]) > 1e-12


def test_nothing_to_refine_is_said():
    failed = Evaluation(0, np.full(2, 0.5), np.nan, np.zeros(0), failure="no")
    answer = NelderMead(2).propose([failed], {}, 0)
    assert isinstance(answer, Stop)
    assert "failed" in answer.reason


def test_stopped_anywhere_it_continues_with_the_same_bits():
    strategy = NelderMead(3, start=(0.2, 0.4, 0.9), step=0.2)
    kept = []
    whole = minimise(
        problem(rosenbrock, 3), strategy, 120, on_evaluation=lambda _, m: kept.append(json.dumps(m))
    )
    for cut in range(1, 119):
        again = strategy.propose(whole.history[:cut], json.loads(kept[cut - 1]), 0)
        assert again.point.tobytes() == whole.history[cut].point.tobytes()
        assert json.dumps(again.memory) == kept[cut]


def test_angles_and_box_are_inverse():
    points = np.linspace(0, 1, 101)
    np.testing.assert_allclose(to_box(to_angles(points)), points, atol=1e-15)
    np.testing.assert_allclose(to_box(-to_angles(points)), points, atol=1e-15)
    assert to_box(to_angles(np.array([0.0, 1.0]))).tolist() == [0.0, 1.0]

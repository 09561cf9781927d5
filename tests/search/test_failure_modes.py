"""What has gone wrong in searches like this one, held so that it does not again."""

import time

import numpy as np
import pytest

from camring.search.bayesian import Bayesian
from camring.search.minimise import minimise
from camring.search.problem import Evaluation, Problem, Proposal
from camring.search.surrogate.dataset import collect
from camring.search.surrogate.gaussian_process import condition
from camring.search.surrogate.hyper_parameters import learn, objective_rows
from camring.search.surrogate.residual_mean import ResidualMean


def problem(objective, dimension=2, constraints=None, count=0):
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


def smallest_distance(history):
    points = np.array([one.point for one in history])
    distance = np.linalg.norm(points[:, None] - points[None], axis=-1)
    return np.min(distance[~np.eye(len(points), dtype=bool)])


def evaluations(points, values, constraints=None):
    if constraints is None:
        constraints = np.zeros((len(points), 0))
    return [
        Evaluation(trial, point, float(value), row)
        for trial, (point, value, row) in enumerate(zip(points, values, constraints, strict=True))
    ]


def test_near_duplicates_in_the_history_do_not_break_the_covariance():
    random = np.random.default_rng(0)
    points = random.random((12, 2))
    points = np.vstack([points, points, points + 1e-10, points + 1e-7]).clip(0, 1)
    history = evaluations(points, np.sum(points**2, axis=1))
    dataset = collect(history, points[0])
    learned = learn(dataset, len(points), 0.0, None)
    rows = objective_rows(ResidualMean.PLAIN, dataset, learned.objective_warp)
    posterior = condition(rows, learned.objective[ResidualMean.PLAIN].hyperparameters())
    assert np.all(np.isfinite(posterior.weights))
    answer = Bayesian(2, convergence=None).propose(history, {}, 0)
    assert isinstance(answer, Proposal)
    assert np.min(np.linalg.norm(points - answer.point, axis=1)) > 1e-5


def test_a_minimum_in_a_corner_is_not_proposed_for_ever():
    outcome = minimise(problem(np.sum), Bayesian(2, convergence=None), 40)
    assert np.all(outcome.best.point == 0.0)
    assert smallest_distance(outcome.history) > 1e-5


def test_a_flat_objective_still_gives_new_points():
    outcome = minimise(problem(lambda point: 1.0), Bayesian(2, convergence=None), 25)
    assert smallest_distance(outcome.history) > 1e-5


def test_the_given_point_twice_is_evaluated_once():
    strategy = Bayesian(2, given=((0.2, 0.3), (0.2, 0.3)), convergence=None)
    outcome = minimise(problem(np.sum), strategy, 8)
    assert outcome.history[0].point.tolist() == [0.2, 0.3]
    assert smallest_distance(outcome.history) > 1e-5


def test_a_region_that_no_initial_point_hits_is_found():
    """A disc of radius 0.05: 0.8 % of the box."""
    centre = np.array([0.83, 0.21])
    outcome = minimise(
        problem(
            lambda point: point[0],
            constraints=lambda point: [(np.sum((point - centre) ** 2) - 0.05**2) * 10],
            count=1,
        ),
        Bayesian(2, convergence=None),
        40,
        seed=3,
    )
    assert not any(one.feasible() for one in outcome.history[:6])
    assert outcome.best.feasible()
    assert outcome.best.objective == pytest.approx(0.78, abs=1e-3)


def test_where_nothing_is_feasible_the_violation_is_minimised():
    """Both cannot hold; the sum of what they miss is least anywhere between."""
    outcome = minimise(
        problem(np.sum, constraints=lambda p: [0.6 - p[0], p[0] - 0.4], count=2),
        Bayesian(2, convergence=None),
        25,
    )
    assert not outcome.best.feasible()
    assert outcome.best.violation == pytest.approx(0.2, abs=1e-6)


def test_five_decades_of_objective():
    """From 1e-3 at the best point to 100 and more in the corners."""

    def steep(point):
        return np.exp(12 * np.sum((point - [0.3, 0.6]) ** 2) ** 0.9) * 1e-3

    outcome = minimise(problem(steep), Bayesian(2, convergence=None), 40)
    values = [one.objective for one in outcome.history]
    assert outcome.best.objective < 1.01e-3
    assert max(values) / min(values) > 1e2
    assert outcome.memory["learned"]["objective_warp"][1] is not None


def test_failed_evaluations_are_recorded_and_avoided():
    """A quarter of the box cannot be computed, in three different ways."""

    def evaluate(points):
        x = points[0]
        if x[0] > 0.5 and x[1] > 0.5:
            if x[0] < 0.6:
                raise ArithmeticError("chamber volume is negative")
            if x[0] < 0.7:
                return [(np.nan, np.array([np.nan]), np.nan, "solver gave up")]
            return [(np.inf, np.array([-1.0]), np.nan, None)]
        return [(-x[0] - x[1], np.array([x[0] - 0.9]), np.nan, None)]

    outcome = minimise(Problem(2, 1, evaluate), Bayesian(2, convergence=None), 45, seed=1)
    failures = [one for one in outcome.history if one.failed]
    assert failures
    assert all(one.failure for one in failures)
    assert len(failures) < 25  # the optimum is on the edge: about every second step is beyond it
    assert outcome.best.objective < -1.49  # -1.5 in the corner (0.5, 1) of what can be computed


def test_a_problem_that_always_fails_is_given_up_with_its_reason():
    def evaluate(points):
        raise ValueError("no oil")

    outcome = minimise(Problem(2, 0, evaluate), Bayesian(2), 1000)
    assert outcome.best is None
    assert len(outcome.history) <= 30
    assert "no oil" in outcome.stop_reason


def test_a_proposal_after_five_hundred_trials_costs_no_more_than_after_three_hundred():
    random = np.random.default_rng(1)
    points = random.random((502, 4))
    values = np.sum((points - 0.4) ** 2, axis=1)
    history = evaluations(points, values, (points[:, :1] - 0.5))
    strategy = Bayesian(4, convergence=None, model_size=64, fit_size=64)

    def seconds(count):
        """Of the second proposal: the first compiles and learns afresh."""
        first = strategy.propose(history[:count], {}, 0)
        begun = time.process_time()
        strategy.propose(history[: count + 1], first.memory, 0)
        return time.process_time() - begun

    assert seconds(500) < 3 * seconds(300) + 0.1  # sizes 128 and 512 would be 60 times

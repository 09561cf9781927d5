"""The descent by quadratic models: known optima, resumption, failures."""

import json
from dataclasses import replace

import numpy as np
import pytest

from camring.search.cobyqa import Cobyqa
from camring.search.minimise import minimise
from camring.search.nelder_mead import NelderMead
from camring.search.problem import Evaluation, Stop


def evaluations_to(outcome, value):
    """How many it took to a feasible point of at most the value."""
    good = [one.feasible(1e-9) and one.objective <= value for one in outcome.history]
    return good.index(True) + 1 if True in good else len(good) + 1000


def test_a_minimum_on_an_active_constraint_takes_fewer_evaluations_than_by_a_simplex(disc):
    least = 2 * (1 - 0.5**0.5) ** 2
    runs = [
        minimise(disc, strategy, 200, seed=0)
        for strategy in (Cobyqa(2, start=(0.3, 0.6)), NelderMead(2, start=(0.3, 0.6)))
    ]
    quadratic, simplex = (evaluations_to(run, least * 1.001) for run in runs)
    assert quadratic < simplex / 2
    assert quadratic < 50


@pytest.mark.long
def test_ten_variables_under_eight_limits_are_brought_to_the_published_minimum(g07):
    """Hock and Schittkowski (1981), problem 113, from a point that keeps none of its limits."""
    best = minimise(g07, Cobyqa(10, start=(0.6,) * 10, step=0.2), 120, seed=0).best
    assert best.feasible()
    assert best.objective == pytest.approx(24.3062, rel=1e-3)


def test_a_descent_stopped_anywhere_goes_on_with_the_same_bits(disc):
    memories = []
    whole = minimise(
        disc,
        Cobyqa(2, start=(0.3, 0.6)),
        40,
        on_evaluation=lambda evaluation, memory: memories.append(json.dumps(memory)),
    )
    for cut in range(0, len(whole.history), 5):
        memory = json.loads(memories[cut - 1]) if cut else {}
        again = Cobyqa(2, start=(0.3, 0.6)).propose(whole.history[:cut], memory, 0)
        assert again.point.tobytes() == whole.history[cut].point.tobytes()


def test_it_begins_at_the_best_point_of_the_history_and_ends_there_or_better(townsend):
    begun = minimise(townsend, NelderMead(2, start=(0.9, 0.5)), 12)
    best = begun.best
    whole = minimise(townsend, Cobyqa(2, step=0.05), 60, history=begun.history)
    assert np.max(np.abs(whole.history[12].point - best.point)) < 0.06
    assert whole.best.rank() <= best.rank()
    assert "quadratic models" in minimise(townsend, Cobyqa(2), 400).stop_reason


def test_failures_are_survived(disc):
    def evaluate(points):
        return [
            (*found[:3], "the solver gave up") if abs(point[0] - 0.2) < 0.05 else found
            for point, found in zip(points, disc.evaluate(points), strict=True)
        ]

    outcome = minimise(replace(disc, evaluate=evaluate), Cobyqa(2, start=(0.3, 0.6)), 80)
    assert any(one.failed for one in outcome.history)
    assert outcome.best.objective == pytest.approx(2 * (1 - 0.5**0.5) ** 2, rel=1e-3)


def test_there_is_nothing_to_refine_where_all_has_failed():
    failed = Evaluation(0, np.full(2, 0.5), np.nan, np.zeros(0), failure="no numbers")
    assert isinstance(Cobyqa(2).propose([failed], {}, 0), Stop)

"""The benchmark's own arithmetic, and that its problems are those of the literature."""

import math
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.search.campaign import Campaign
from benchmarks.search.measures import best_so_far, quartiles, reached_after, running_time
from benchmarks.search.methods import METHODS
from benchmarks.search.oracle import Oracle, Reached, Spent
from benchmarks.search.problem import SearchProblem, ValueAt
from benchmarks.search.published import PUBLISHED
from benchmarks.search.traces import Trace, keep, kept, pack, rounded_up, trace_of

ROUNDING = {"gramacy": 2e-4, "welded-beam": 2e-5}  # of minimisers published to four to six digits


def trace(objective, violation=None, slopes=(), seed=0):
    return Trace(
        problem="p",
        method="m",
        seed=seed,
        budget=10,
        dimension=2,
        constraint_count=1,
        best_known=1.0,
        seconds=1.0,
        evaluating=0.5,
        ended="",
        objective=list(objective),
        violation=list(violation or [0.0] * len(objective)),
        slopes=list(slopes),
    )


def parabola(best=-math.inf):
    return SearchProblem(
        "parabola",
        2,
        0,
        5,
        lambda point: ValueAt(float(np.sum((point - 0.5) ** 2)), np.zeros(0)),
        lambda point: (2 * (point - 0.5), np.zeros((0, 2))),
        best=best,
    )


@pytest.mark.parametrize("name", PUBLISHED)
def test_the_published_minimiser_has_the_published_value(name):
    problem = PUBLISHED[name]()
    found = problem.evaluate(np.array(problem.minimiser))
    rounding = ROUNDING.get(name, 5e-6)
    assert found.objective == pytest.approx(problem.best, rel=rounding)
    assert found.violation < rounding


def test_a_point_that_keeps_its_limits_not_reaches_a_target():
    run = trace([0.5, 1.3, 1.05], [0.1, 0.0, 0.0])
    assert reached_after(run, 1.0, 0.1) == 3
    assert reached_after(run, 1.0, 0.01) == math.inf


def test_slopes_asked_for_until_then_count():
    run = trace([3.0, 2.0, 1.0, 1.0], slopes=[0, 1, 2, 3])
    assert reached_after(run, 1.0, 0.0, slopes_cost=2.0) == 3 + 2 * 2


def test_expected_running_time_is_all_that_was_spent_over_successes():
    runs = [trace([2.0, 1.0, 5.0]), trace([3.0, 3.0, 3.0, 3.0])]
    found = running_time(runs, 1.0, 0.0)
    assert (found.expected, found.successes, found.runs, found.longest) == (6.0, 1, 2, 4)
    assert running_time(runs[1:], 1.0, 0.0).expected == math.inf


def test_a_target_below_zero_lies_above_the_best():
    assert reached_after(trace([-0.95, -0.995]), -1.0, 0.01) == 2


def test_the_best_so_far_of_a_run_that_ended_stays():
    run = trace([4.0, 2.0, 3.0], [0.0, 0.0, 0.0])
    assert best_so_far(run, 5).tolist() == [4.0, 2.0, 2.0, 2.0, 2.0]
    assert quartiles([run], 1.0, 4)[1].tolist() == [3.0, 1.0, 1.0, 1.0]


def test_a_point_known_already_costs_nothing_and_the_budget_holds():
    oracle = Oracle(parabola(), seed=0)
    for _ in range(3):
        oracle.outcome(np.zeros(2))
    assert oracle.left == 4
    oracle.design(5)
    with pytest.raises(Spent):
        oracle.ranked(np.random.default_rng(0).random((5, 2)))
    assert len(oracle.outcomes) == 5


def test_each_seed_has_a_given_point_of_its_own_and_the_same_for_every_method():
    problem = replace(parabola(), given=((0.5, 0.98),))
    first, again, other = (Oracle(problem, seed).given[0] for seed in (0, 0, 1))
    assert first == again != other
    assert all(0 <= value <= 1 for value in (*first, *other))
    assert Oracle(problem, 0).design(3)[0].tolist() == list(first)


def test_methods_that_think_next_to_nothing_get_the_long_budget():
    problem = replace(parabola(), long_budget=50)
    assert METHODS["COBYQA"].budget(problem) == 50
    assert METHODS["scbo"].budget(problem) == 5
    assert METHODS["COBYQA"].budget(parabola()) == 5


def test_the_hardest_rival_is_one_that_got_there():
    def run(method, objective):
        return replace(trace(objective), method=method, problem="wheel")

    runs = [run("scbo", [3.0, 1.0]), run("COBYQA", [5.0, 4.0, 1.0]), run("Optuna GP", [5.0, 4.0])]
    campaign = Campaign.of(runs)
    hardest, other = campaign.duels(campaign.ours[0], "wheel", 0.0)
    assert (hardest.rival.name, hardest.ratio) == ("COBYQA", 2 / 3)
    assert (other.rival.name, other.ratio) == ("Optuna GP", 1.0)


def test_a_run_ends_at_the_best_known_value():
    oracle = Oracle(parabola(best=0.02), seed=0)
    oracle.outcome(np.zeros(2))
    with pytest.raises(Reached):
        oracle.outcome(np.full(2, 0.6))


@pytest.mark.parametrize("value", [1.23456, -1.23456, 1e-9, 6961.8139, 0.1, -0.1, 0.0])
def test_a_rounded_value_is_no_better_than_it_was(value):
    for digits in (4, 9):
        assert value <= rounded_up(value, digits) + 1e-15 * abs(value)
        assert rounded_up(value, digits) <= value + 10.0 ** (1 - digits) * abs(value)


def test_runs_are_kept_packed_and_read_again(tmp_path):
    oracle = Oracle(parabola(), seed=3)
    oracle.ranked(oracle.design(4))
    run = trace_of(oracle, "by hand", 0.25, "enough")
    keep(run, tmp_path)
    pack(tmp_path)
    packed = (tmp_path / "parabola.jsonl.gz").read_bytes()
    pack(tmp_path)
    assert (tmp_path / "parabola.jsonl.gz").read_bytes() == packed
    assert kept(tmp_path) == {("parabola", "by hand", 3): run}

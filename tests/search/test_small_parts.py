"""Sampling, warps, convergence, the dataset and the bookkeeping of evaluations."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from threadpoolctl import ThreadpoolController

from camring.search.convergence import Convergence
from camring.search.problem import Evaluation, best_of
from camring.search.sampling import generator, initial_point, sobol
from camring.search.surrogate.dataset import collect
from camring.search.surrogate.warp import Warp, candidate_warps
from camring.search.threads import one_linear_algebra_thread
from camring.search.trust_region import TrustRegion

finite = st.floats(-1e6, 1e6)


def evaluation(trial, objective, constraints=(), point=(0.5, 0.5), failure=None):
    return Evaluation(
        trial, np.array(point), objective, np.array(constraints, dtype=float), failure=failure
    )


def test_more_sobol_points_begin_with_the_same_points():
    few, many = (sobol(count, 5, generator(3, 0)) for count in (7, 200))
    assert np.array_equal(few, many[:7])


def test_sobol_fills_the_box_more_evenly_than_chance():
    """Of 64 balanced points each 64th of every axis holds exactly one."""
    cells = np.floor(64 * sobol(64, 6, generator(1, 0))).astype(int)
    assert all(len(set(column)) == 64 for column in cells.T)


def test_given_points_come_first():
    given_points = ((0.1, 0.2), (0.3, 1.4))
    assert initial_point(0, 2, 9, given_points).tolist() == [0.1, 0.2]
    assert initial_point(1, 2, 9, given_points).tolist() == [0.3, 1.0]
    np.testing.assert_array_equal(initial_point(2, 2, 9, given_points), initial_point(0, 2, 9))


def test_chance_belongs_to_seed_trial_and_stream():
    draws = {generator(*key).random() for key in ((0, 0), (0, 1), (1, 0), (0, 0, 1))}
    assert len(draws) == 4
    assert generator(5, 6).random() == generator(5, 6).random()


@given(value=finite, other=finite, centre=finite, scale=st.floats(1e-3, 1e3))
def test_a_warp_keeps_order_and_its_centre(value, other, centre, scale):
    warp = Warp(centre, scale)
    assert float(warp(np.array(centre))) == 0.0
    if value < other:
        assert float(warp(np.array(value))) <= float(warp(np.array(other)))


@given(value=st.floats(-1e3, 1e3), centre=st.floats(-10, 10), scale=st.floats(0.1, np.inf))
def test_a_warp_is_undone(value, centre, scale):
    warp = Warp(centre, scale)
    assert warp.undone(warp(np.array(value))) == pytest.approx(value, rel=1e-9, abs=1e-9)


@given(value=finite)
def test_a_warp_about_zero_keeps_feasibility(value):
    assert np.sign(Warp(0.0, 0.1)(np.array(value))) == np.sign(value)


@pytest.mark.parametrize("scale", [0.3, np.inf])
def test_the_slope_of_a_warp_is_the_central_difference(scale):
    warp, values = Warp(0.2, scale), np.linspace(-3, 3, 20)
    difference = (warp(values + 1e-6) - warp(values - 1e-6)) / 2e-6
    np.testing.assert_allclose(warp.slope(values), difference, rtol=1e-6)
    assert warp.log_jacobian(values) == pytest.approx(float(np.sum(np.log(difference))), abs=1e-6)


def test_only_spread_values_are_worth_a_logarithm():
    assert len(candidate_warps(np.full(9, 2.0), 2.0)) == 1
    assert len(candidate_warps(10.0 ** np.arange(6), 0.0)) == 3


def test_evaluations_rank_feasible_then_by_violation_then_failed():
    history = [
        evaluation(0, np.nan, failure="no"),
        evaluation(1, 1.0, [0.5, 0.1]),
        evaluation(2, 9.0, [0.3, -0.1]),
        evaluation(3, 5.0, [0.0, -1.0]),
        evaluation(4, 7.0, [-1.0, -1.0]),
    ]
    assert [one.trial for one in sorted(history, key=Evaluation.rank)] == [3, 4, 2, 1, 0]
    assert best_of(history).trial == 3
    assert best_of(history[:3]).trial == 2
    assert best_of(history[:1]) is None
    assert history[2].feasible(tolerance=0.3)
    assert not history[2].feasible()


def test_a_constraint_that_is_not_a_number_is_a_failure():
    assert evaluation(0, 1.0, [np.nan]).failed
    assert evaluation(0, 1.0, [np.nan]).violation == np.inf


def test_convergence_says_which_test_fired():
    standing = [evaluation(trial, 1.0) for trial in range(30)]
    assert "by objective" in Convergence(window=20).reason(standing)
    creeping = [evaluation(trial, 1.0 - 0.01 * trial) for trial in range(30)]
    assert "by design" in Convergence(window=20).reason(creeping)
    walking = [
        evaluation(trial, 1.0 - 0.01 * trial, point=(0.01 * trial, 0.0)) for trial in range(30)
    ]
    assert Convergence(window=20).reason(walking) is None


def test_a_search_that_explores_has_not_converged_while_its_best_improves():
    """Consecutive trials differ wildly or agree by chance; neither decides."""
    history = [
        evaluation(trial, 10.0 if trial % 2 else 5.0 - 0.1 * trial, point=(0.02 * trial, 0.0))
        for trial in range(40)
    ]
    assert Convergence(window=20).reason(history) is None


def test_no_convergence_before_something_is_feasible_or_just_after():
    infeasible = [evaluation(trial, 1.0, [0.5]) for trial in range(60)]
    assert Convergence(window=20).reason(infeasible) is None
    assert Convergence(window=20).reason([*infeasible, evaluation(60, 1.0, [-1.0])]) is None


def test_the_initial_design_is_no_standstill():
    standing = [evaluation(trial, 1.0) for trial in range(30)]
    assert Convergence(window=20).reason(standing, first=15) is None


def test_a_failure_becomes_one_more_constraint_to_learn():
    history = [evaluation(0, 1.0, [-1.0]), evaluation(1, np.nan, [0.2], failure="no")]
    dataset = collect(history, np.zeros(2))
    np.testing.assert_array_equal(dataset.restrictions, [[-1.0, -1.0], [0.2, 1.0]])
    assert collect(history[:1], np.zeros(2)).restrictions.shape == (1, 1)


def test_penalised_constraints_leave_no_columns():
    dataset = collect([evaluation(0, 1.0, [0.5, -3.0])], np.zeros(2), penalty_weight=100.0)
    assert dataset.objective[0] == 26.0
    assert dataset.restrictions.shape == (1, 0)


def test_the_nearest_rows_are_kept_and_some_far_ones():
    random = np.random.default_rng(0)
    history = [evaluation(trial, 1.0, point=random.random(2)) for trial in range(300)]
    dataset = collect(history, np.full(2, 0.5)).nearest(100)
    distance = np.sum((dataset.points - 0.5) ** 2, axis=1)
    everything = np.sum((np.array([one.point for one in history]) - 0.5) ** 2, axis=1)
    assert len(dataset.points) == 100
    assert np.sum(distance <= np.sort(everything)[74]) == 75
    assert np.max(distance) > 0.9 * np.max(everything)


def test_a_trust_region_grows_shrinks_and_begins_anew():
    region = TrustRegion(length=0.4)
    assert region.after_step(True, True).after_step(True, True).length == 0.8
    tried = region
    for _ in range(3):
        tried = tried.after_step(False, False)
    assert (tried.length, tried.caution) == (0.2, 3.0)
    assert tried.after_step(False, True).caution == 2.0
    tiny = TrustRegion(length=0.0015, losses=2).after_step(False, True)
    assert (tiny.length, tiny.collapses) == (0.8, 1)
    assert TrustRegion(length=0.01).after_discovery().length == 0.2


def test_a_trust_region_stays_in_the_box():
    region = TrustRegion(length=0.4).around(np.array([0.1, 0.5]))
    np.testing.assert_allclose(region.lower, [0.0, 0.3])
    np.testing.assert_allclose(region.upper, [0.3, 0.7])


def linear_algebra_threads():
    """Threads of each linear-algebra library that is loaded."""
    libraries = ThreadpoolController().select(user_api="blas").info()
    return [library["num_threads"] for library in libraries]


def test_linear_algebra_is_held_to_one_thread_and_let_go_again():
    with ThreadpoolController().limit(limits=2, user_api="blas"):
        before = linear_algebra_threads()
        with one_linear_algebra_thread():
            held = linear_algebra_threads()
        after = linear_algebra_threads()
    assert before  # SciPy brings one
    assert set(held) == {1}
    assert after == before


def test_linear_algebra_is_let_go_when_the_work_fails():
    before = linear_algebra_threads()
    with pytest.raises(RuntimeError), one_linear_algebra_thread():
        raise RuntimeError
    assert linear_algebra_threads() == before

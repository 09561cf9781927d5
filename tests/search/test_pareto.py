"""Fronts, their volume and their spread, on cases that are known exactly."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.optimize import rosen, rosen_der

from camring.search.multipliers import multipliers
from camring.search.pareto import scalarised
from camring.search.pareto.dominance import evenly_spread, hypervolume, non_dominated
from camring.search.pareto.front import FrontProblem, trace_front

clouds = arrays(float, st.tuples(st.integers(1, 30), st.just(2)), elements=st.floats(0, 1))


def quarter_circle(count):
    """Points of the circle about (1, 1) that face the origin."""
    turn = np.linspace(0, np.pi / 2, count)
    return 1 - np.stack([np.cos(turn), np.sin(turn)], axis=1)


def test_who_is_beaten():
    values = np.array([[0, 2], [1, 1], [2, 0], [1, 2], [1, 1], [np.nan, 0]])
    assert non_dominated(values).tolist() == [True, True, True, False, True, False]


@given(values=clouds)
def test_what_is_left_out_is_beaten_by_something_kept(values):
    kept = non_dominated(values)
    for loser in values[~kept]:
        assert np.any(np.all(values[kept] <= loser, axis=1))


@given(values=clouds)
def test_beaten_designs_add_no_volume(values):
    reference = np.array([1.1, 1.1])
    front = values[non_dominated(values)]
    assert hypervolume(front, reference) == pytest.approx(hypervolume(values, reference))


def test_the_volume_of_a_quarter_circle_is_its_area():
    """The staircase lies inside and misses at most one step's height along a side of 1."""
    found = hypervolume(quarter_circle(20_001), np.array([1.0, 1.0]))
    assert np.pi / 4 - 2e-4 < found <= np.pi / 4


def test_volumes_of_boxes():
    reference = np.ones(3)
    assert hypervolume(np.array([[0.5, 0.5, 0.5]]), reference) == pytest.approx(1 / 8)
    both = np.array([[0.5, 0.5, 0.5], [0.0, 0.75, 0.25], [2.0, 0.0, 0.0]])
    assert hypervolume(both, reference) == pytest.approx(1 / 8 + 3 / 16 - 1 / 16)


def test_the_spread_keeps_ends_and_leaves_no_crowd():
    values = quarter_circle(401)[np.r_[0:60, 60:401:10]]
    chosen = evenly_spread(values, 9)
    assert {0, len(values) - 1} <= set(chosen.tolist())
    gaps = np.linalg.norm(np.diff(values[chosen], axis=0), axis=1)
    assert len(chosen) == 9
    assert np.all((gaps > 0.5 * gaps.mean()) & (gaps < 2 * gaps.mean()))


def schaffer():
    """x from -1 to 3: x^2 against (x - 2)^2; the front is sqrt(f1) + sqrt(f2) = 2."""

    def values(point):
        x = 4 * point[0] - 1
        return np.array([x**2, (x - 2) ** 2]), np.zeros(0)

    def slopes(point):
        x = 4 * point[0] - 1
        return 4 * np.array([[2 * x], [2 * (x - 2)]]), np.zeros((0, 1))

    return FrontProblem.one_by_one(values, slopes)


def fonseca(dimension=3):
    """Fonseca and Fleming's: a front bent the wrong way, which no weighted sum reaches."""
    centre = 1 / np.sqrt(dimension)

    def values(point):
        x = 8 * point - 4
        return 1 - np.exp([-np.sum((x - s * centre) ** 2) for s in (1, -1)]), np.zeros(0)

    def slopes(point):
        x = 8 * point - 4
        found, _ = values(point)
        rows = [16 * (1 - f) * (x - s * centre) for f, s in zip(found, (1, -1), strict=True)]
        return np.array(rows), np.zeros((0, dimension))

    return FrontProblem.one_by_one(values, slopes)


def test_schaffers_front_is_found_evenly():
    front = trace_front(schaffer(), [np.array([0.9]), np.array([0.1])], 20)
    values = np.array(front.objectives)[front.best()]
    values = values[np.argsort(values[:, 0])]
    np.testing.assert_allclose(np.sqrt(values).sum(axis=1), 2, atol=1e-2)
    gaps = np.linalg.norm(np.diff(values, axis=0), axis=1)
    assert len(values) >= 20
    assert gaps.max() < 4.0 * np.median(gaps)


def test_fonsecas_front_is_found_where_it_is_bent():
    starts = [np.full(3, 0.6), np.full(3, 0.4), np.array([0.55, 0.5, 0.45])]
    front = trace_front(fonseca(), starts, 20)
    values = np.array(front.objectives)[front.best()]
    # On the front x = t (1, 1, 1)/sqrt(3): the roots of both logarithms add to 2.
    np.testing.assert_allclose(np.sqrt(-np.log1p(-values)).sum(axis=1), 2, atol=1e-2)
    assert len(values) >= 20


def test_three_objectives_and_a_limit():
    """Squared distances from the corners of a triangle, where x may not exceed 0.6."""
    corners = np.array([[0.2, 0.2], [0.8, 0.2], [0.5, 0.8]])
    limited = FrontProblem.one_by_one(
        lambda x: (np.sum((x - corners) ** 2, axis=1), np.array([x[0] - 0.6])),
        lambda x: (2 * (x - corners), np.array([[1.0, 0.0]])),
    )
    front = trace_front(limited, [np.array([0.5, 0.5]), np.array([0.9, 0.9])], 20)
    points = np.array(front.points)[front.best()]
    assert len(points) >= 15
    assert np.all(points[:, 0] <= 0.6)
    assert points[:, 0].min() < 0.25
    assert points[:, 1].max() > 0.75


def test_without_a_feasible_design_there_is_no_front():
    never = FrontProblem.one_by_one(
        lambda x: (np.array([x[0], -x[0]]), np.array([1.0])),
        lambda x: (np.array([[1.0], [-1.0]]), np.array([[0.0]])),
    )
    assert trace_front(never, [np.array([0.5])], 5).best() == []


def test_multipliers_are_the_price_of_a_limit():
    """Least (x - 1)^2 + (y - 2)^2 where x + y <= 1 holds: at (0, 1), price 2."""
    slope = np.array([2 * (0 - 1), 2 * (1 - 2)])
    factors, left = multipliers(slope, np.array([[1.0, 1.0]]))
    assert factors == pytest.approx([2.0])
    assert left == pytest.approx(0.0, abs=1e-12)


def test_no_limit_explains_a_slope_towards_the_inside():
    factors, left = multipliers(np.array([1.0, 0.0]), np.array([[1.0, 0.0]]))
    assert factors.tolist() == [0.0]
    assert left == pytest.approx(1.0)
    assert multipliers(np.array([1.0, 0.0]), np.zeros((0, 2)))[1] == 1.0


def test_an_end_of_the_front_is_followed_for_as_long_as_it_comes_down(monkeypatch):
    """Along Rosenbrock's valley, which one descent of 25 evaluations cannot leave behind."""
    monkeypatch.setattr(scalarised, "PATIENCE", 25)

    def values(point):
        return np.array([np.log1p(rosen(4 * point - 2)), np.sum((point - 1) ** 2)]), -np.ones(1)

    def slopes(point):
        at = 4 * point - 2
        of_valley = 4 * rosen_der(at) / (1 + rosen(at))
        return np.stack([of_valley, 2 * (point - 1)]), np.zeros((1, 4))

    start = np.array([0.2, 0.75, 0.2, 0.75])
    front = trace_front(FrontProblem.one_by_one(values, slopes), [start], 3)
    lowest = np.min(front.objectives, axis=0)
    assert lowest == pytest.approx([0, 0], abs=1e-3)

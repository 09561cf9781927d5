"""Neighbours on a front, and how far apart they would be if spread evenly."""

import numpy as np
import pytest

from camring.search.pareto.gaps import between_ends, neighbours, spacing


def test_neighbours_in_a_row_whatever_their_order():
    values = np.array([[0.0, 3.0], [3.0, 0.0], [1.0, 1.5], [2.0, 0.5]])
    assert sorted(neighbours(values)) == [(0, 2), (1, 3), (2, 3)]


def test_every_design_of_a_sheet_has_neighbours_and_the_far_corners_are_none():
    places = np.array(list(between_ends(np.eye(3), 28)))
    pairs = neighbours(places)
    assert {place for pair in pairs for place in pair} == set(range(len(places)))
    length = [np.linalg.norm(places[a] - places[b]) for a, b in pairs]
    assert max(length) < 0.5 * np.sqrt(2)


def test_spacing_of_what_is_spread_evenly():
    row = np.array(list(between_ends(np.array([[0.0, 1.0], [1.0, 0.0]]), 11)))
    assert spacing(row, 11) == pytest.approx(np.sqrt(2) / 10)
    sheet = np.array(list(between_ends(np.eye(3), 300)))
    edge = np.sqrt(2) / (np.sqrt(2 * len(sheet)) - 1)
    assert spacing(sheet, len(sheet)) == pytest.approx(edge, rel=0.1)


def test_places_between_ends_are_as_many_as_wanted():
    for ends, count in ((np.eye(2), 13), (np.eye(3), 13)):
        places = np.array(list(between_ends(ends, count)))
        assert len(places) >= count
        np.testing.assert_allclose(places.sum(axis=1), 1)
        assert all(np.any(np.all(np.isclose(places, end), axis=1)) for end in ends)


def test_one_or_two_designs_are_no_sheet():
    assert neighbours(np.zeros((1, 3))) == []
    assert neighbours(np.eye(3)[:2]) == [(0, 1)]

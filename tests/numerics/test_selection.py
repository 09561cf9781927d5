"""Slopes of the larger and the largest stand, whatever a compiler rounds."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from camring.numerics.selection import bounded, larger, largest, smaller, smallest

A = np.array([1.0, -2.0, 0.5, np.inf, 3.0])
B = np.array([0.5, 4.0, 0.5, 2.0, np.inf])


def slope(function, *numbers):
    """Derivatives by each of the numbers, all of whose elements move alike."""
    return [
        jax.jvp(
            function,
            tuple(map(jnp.asarray, numbers)),
            tuple(np.ones(np.shape(each)) * (k == moved) for k, each in enumerate(numbers)),
        )[1]
        for moved in range(len(numbers))
    ]


def test_values_are_those_of_numpy():
    np.testing.assert_array_equal(larger(A, B), np.maximum(A, B))
    np.testing.assert_array_equal(smaller(A, B), np.minimum(A, B))
    np.testing.assert_array_equal(bounded(A, 0, 2), np.clip(A, 0, 2))
    np.testing.assert_array_equal(bounded(A, None, 2), np.clip(A, None, 2))
    grid = jnp.asarray(np.sin(np.arange(24.0)).reshape(2, 3, 4))
    for axis in (None, 0, (0, 1)):
        np.testing.assert_array_equal(largest(grid, axis), np.max(grid, axis))
        np.testing.assert_array_equal(smallest(grid, axis), np.min(grid, axis))
    assert larger(jnp.arange(3), 1).tolist() == [1, 1, 2]
    assert int(largest(jnp.arange(3))) == 2
    assert bool(jnp.isnan(larger(jnp.nan, 1.0)))
    assert bool(jnp.isnan(smaller(1.0, jnp.nan)))


def test_each_slope_is_that_of_the_number_taken():
    first, second = slope(larger, A, B)
    assert first.tolist() == [1, 0, 0.5, 1, 0]
    assert second.tolist() == [0, 1, 0.5, 0, 1]
    first, second = slope(smaller, A, B)
    assert first.tolist() == [0, 1, 0.5, 0, 1]
    assert second.tolist() == [1, 0, 0.5, 1, 0]
    assert slope(lambda x: bounded(x, 0, 2), A)[0].tolist() == [1, 0, 1, 0, 0]


def test_a_number_that_does_not_count_may_have_an_endless_slope():
    assert slope(lambda x: larger(jnp.sqrt(x), 1.0), 0.0) == [0]


@pytest.mark.parametrize("axis", [None, (0, 1)])
def test_the_slope_of_the_largest_is_shared_by_all_that_are_it(axis):
    grid = np.array([[1.0, 3.0], [3.0 - 1e-15, 2.0]])
    weight = np.array([[7.0, 1.0], [2.0, 9.0]])
    _, found = jax.jvp(lambda x: largest(x, axis), (grid,), (weight,))
    assert float(found) == 1.5
    _, found = jax.jvp(lambda x: smallest(x, axis), (grid,), (weight,))
    assert float(found) == 7


def test_the_slope_of_the_largest_is_never_lost():
    """Where all numbers are alike, or some or all are infinite."""
    for row in ([5.0, 5.0 + 1e-15], [np.inf, 1.0], [-np.inf, 1.0], [np.inf, np.inf]):
        _, found = jax.jvp(largest, (np.array(row),), (np.array([2.0, 2.0]),))
        assert float(found) == 2
    _, found = jax.jvp(largest, (np.array([-np.inf, 1.0]),), (np.array([3.0, 4.0]),))
    assert float(found) == 4

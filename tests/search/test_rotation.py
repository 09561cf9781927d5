"""Axes along which a function varies, learned from its own gradients."""

import jax
import numpy as np

from camring.search.surrogate.gaussian_process import Hyperparameters, condition_once, pad, predict
from camring.search.surrogate.likelihood import fit, standard_starts
from camring.search.surrogate.rotation import fit_with_axes, mean_gradients

DIMENSION, COUNT = 3, 60


def rows(function, seed=0):
    points = np.random.default_rng(seed).random((COUNT, DIMENSION))
    return pad(points, function(points), np.ones((COUNT, 1)), 64), points


def ridge(points):
    """A narrow valley across all axes."""
    return np.cos(9 * points @ np.array([0.6, 0.64, 0.48]))


def test_the_gradients_of_the_mean_are_its_differences():
    axes = np.linalg.qr(np.random.default_rng(1).normal(size=(DIMENSION, DIMENSION)))[0]
    observations, points = rows(ridge)
    posterior = condition_once(observations, Hyperparameters(np.full(3, 0.5), 1e-6, axes))
    gradients = np.asarray(mean_gradients(posterior))
    mean = jax.jit(lambda at: predict(posterior, at, np.ones((COUNT, 1)))[0])
    for axis in range(DIMENSION):
        shift = 1e-5 * np.eye(DIMENSION)[axis]
        difference = (mean(points + shift) - mean(points - shift)) / 2e-5
        np.testing.assert_allclose(gradients[:COUNT, axis], difference, rtol=1e-5, atol=1e-5)
    assert np.all(gradients[COUNT:] == 0.0)


def test_a_valley_across_the_axes_is_learned_along_its_own():
    observations, _ = rows(ridge)
    straight, density = fit(observations, standard_starts(DIMENSION))
    rotated, rotated_density = fit_with_axes(observations, straight, density)
    assert rotated.axes is not None
    assert rotated_density > density + 2 * DIMENSION
    axes = rotated.axes_array()
    np.testing.assert_allclose(axes.T @ axes, np.eye(DIMENSION), atol=1e-12)
    shortest = axes[:, np.argmin(rotated.parameters[:DIMENSION])]
    assert abs(shortest @ np.array([0.6, 0.64, 0.48])) > 0.999

    asked = np.random.default_rng(2).random((200, DIMENSION))
    basis = np.ones((200, 1))
    errors = [
        np.std(
            predict(condition_once(observations, one.hyperparameters()), asked, basis)[0]
            - ridge(asked)
        )
        for one in (straight, rotated)
    ]
    assert errors[1] < 0.2 * errors[0]


def test_a_function_of_single_variables_keeps_the_axes_of_the_box():
    observations, _ = rows(lambda points: np.sin(6 * points[:, 0]) + 0.1 * points[:, 1])
    straight, density = fit(observations, standard_starts(DIMENSION))
    assert fit_with_axes(observations, straight, density)[0].axes is None

"""Laws of Gaussian processes that hold whatever the data."""

import jax
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camring.search.surrogate.gaussian_process import (
    Hyperparameters,
    Observations,
    capacity_for,
    condition,
    leave_one_out,
    pad,
    predict,
)
from camring.search.surrogate.likelihood import (
    cost_and_gradient,
    fit,
    log_likelihood,
    standard_starts,
)

condition = jax.jit(condition)
predict = jax.jit(predict)
leave_one_out = jax.jit(leave_one_out)

DIMENSION = 3
AXES = np.linalg.qr(np.random.default_rng(8).normal(size=(DIMENSION, DIMENSION)))[0]


def wavy(points):
    return np.sin(3 * points[:, 0]) + points[:, 1] ** 2 - points[:, 1] * points[:, 2]


def rows(count, seed=0, columns=2):
    random = np.random.default_rng(seed)
    points = random.random((count, DIMENSION))
    basis = np.column_stack([np.ones(count), np.cos(points[:, 0])])[:, :columns]
    return points, wavy(points), basis


def some_hyperparameters(noise_ratio=1e-4):
    return Hyperparameters(np.array([0.4, 0.7, 0.9]), noise_ratio, AXES)


def unpadded(points, values, basis):
    return Observations(points, values, basis, np.ones(len(points), dtype=bool))


@pytest.mark.parametrize(
    ("count", "capacity"), [(1, 64), (64, 64), (65, 128), (256, 256), (300, 512), (513, 1024)]
)
def test_capacities_are_few(count, capacity):
    assert capacity_for(count) == capacity


def test_rows_beyond_the_capacity_are_refused():
    with pytest.raises(ValueError, match="capacity_for"):
        pad(*rows(70), 64)


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_the_posterior_interpolates_as_noise_vanishes(seed):
    points, values, basis = rows(20, seed)
    posterior = condition(pad(points, values, basis, 64), some_hyperparameters(1e-10))
    mean, variance = predict(posterior, points, basis)
    np.testing.assert_allclose(mean, values, atol=1e-5)
    assert np.all(np.asarray(variance) < 1e-6 * posterior.signal_variance)


def test_padding_changes_nothing():
    points, values, basis = rows(40)
    asked, _, asked_basis = rows(9, seed=5)
    plain = condition(unpadded(points, values, basis), some_hyperparameters())
    padded = condition(pad(points, values, basis, 128), some_hyperparameters())
    for one, other in zip(
        predict(plain, asked, asked_basis), predict(padded, asked, asked_basis), strict=True
    ):
        np.testing.assert_allclose(one, other, rtol=1e-8, atol=1e-10)
    np.testing.assert_allclose(log_likelihood(plain), log_likelihood(padded), rtol=1e-12)
    for one, other in zip(leave_one_out(plain), leave_one_out(padded), strict=True):
        np.testing.assert_allclose(one, other[:40], rtol=1e-8, atol=1e-10)
        assert np.all(np.asarray(other[40:]) == 0.0)


def test_a_masked_row_is_as_good_as_absent():
    points, values, basis = rows(30)
    values[7] = np.nan
    kept = np.arange(30) != 7
    with_hole = condition(pad(points, values, basis, 64), some_hyperparameters())
    without = condition(pad(points[kept], values[kept], basis[kept], 64), some_hyperparameters())
    asked, _, asked_basis = rows(9, seed=5)
    np.testing.assert_allclose(
        predict(with_hole, asked, asked_basis), predict(without, asked, asked_basis), rtol=1e-8
    )


def test_an_unused_column_changes_nothing():
    points, values, basis = rows(30)
    none = basis * [1.0, 0.0]
    two = condition(pad(points, values, none, 64), some_hyperparameters())
    one = condition(pad(points, values, basis[:, :1], 64), some_hyperparameters())
    assert two.coefficients[1] == 0.0
    np.testing.assert_allclose(
        predict(two, points + 0.01, none),
        predict(one, points + 0.01, basis[:, :1]),
        rtol=1e-10,
        atol=1e-12,  # a variance is what is left of a prior of about one
    )


@pytest.mark.parametrize("columns", [1, 2])
def test_leave_one_out_equals_refitting_without_each_row(columns):
    count = 25
    points, values, basis = rows(count, columns=columns)
    noise_ratio = 1e-4
    whole = condition(pad(points, values, basis, 64), some_hyperparameters(noise_ratio))
    errors, variances = leave_one_out(whole)
    for row in range(count):
        kept = np.arange(count) != row
        rest = condition(pad(points[kept], values[kept], basis[kept], 64), whole.hyperparameters)
        mean, variance = predict(rest, points[row : row + 1], basis[row : row + 1])
        np.testing.assert_allclose(errors[row], mean[0] - values[row], rtol=1e-5, atol=1e-9)
        # the shape of the variance; its scale is the signal variance, fitted once on all rows
        share = variance[0] / rest.signal_variance + noise_ratio
        np.testing.assert_allclose(variances[row] / whole.signal_variance, share, rtol=1e-6)


@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 10_000), noise=st.floats(-12.0, -1.0))
def test_the_likelihood_gradient_is_the_central_difference(seed, noise):
    observations = pad(*rows(30, seed), 64)
    random = np.random.default_rng(seed)
    parameters = np.append(random.normal(-0.5, 0.4, DIMENSION), noise)
    _, gradient = cost_and_gradient(parameters, AXES, observations)
    step = 1e-4
    for place in range(DIMENSION + 1):
        shift = step * np.eye(DIMENSION + 1)[place]
        above, _ = cost_and_gradient(parameters + shift, AXES, observations)
        below, _ = cost_and_gradient(parameters - shift, AXES, observations)
        difference = (above - below) / (2 * step)
        np.testing.assert_allclose(gradient[place], difference, rtol=1e-4, atol=1e-4)


def test_the_likelihood_is_that_of_the_normal_distribution():
    points, values, basis = rows(12)
    posterior = condition(unpadded(points, values, basis), some_hyperparameters())
    scaled = (points - 0.5) @ AXES / posterior.hyperparameters.lengthscales
    distance = np.sum((scaled[:, None] - scaled[None]) ** 2, axis=-1)
    covariance = posterior.signal_variance * (np.exp(-distance / 2) + 1e-4 * np.eye(12))
    residual = values - basis @ posterior.coefficients
    sign, log_determinant = np.linalg.slogdet(2 * np.pi * covariance)
    expected = -0.5 * (residual @ np.linalg.solve(covariance, residual) + log_determinant)
    assert sign == 1
    np.testing.assert_allclose(log_likelihood(posterior), expected, rtol=1e-8)


def test_coincident_points_without_noise_are_survived_by_jitter():
    points, values, basis = rows(20)
    points = np.vstack([points, points, points[:3] + 1e-9])
    values, basis = np.tile(values, 3)[:43], np.vstack([basis, basis, basis[:3]])
    posterior = condition(pad(points, values, basis, 64), some_hyperparameters(0.0))
    assert 0.0 < posterior.jitter < 1e-6
    mean, variance = predict(posterior, points, basis)
    np.testing.assert_allclose(mean, values, atol=1e-3)
    assert np.all(np.isfinite(variance))


def test_several_starts_are_never_worse_than_one():
    observations = pad(*rows(40), 64)
    starts = standard_starts(DIMENSION)
    _, together = fit(observations, starts)
    for start in starts:
        assert together >= fit(observations, [start])[1] - 1e-9


def test_fitted_lengthscales_tell_which_variable_matters():
    points, _, basis = rows(60, columns=1)
    fitted, _ = fit(pad(points, np.sin(8 * points[:, 1]), basis, 64), standard_starts(DIMENSION))
    lengthscales = np.asarray(fitted.hyperparameters().lengthscales)
    assert lengthscales[1] < 0.2 * min(lengthscales[0], lengthscales[2])


def test_a_constant_function_is_predicted_without_complaint():
    points, _, basis = rows(20, columns=1)
    observations = pad(points, np.full(20, 3.0), basis, 64)
    fitted, _ = fit(observations, standard_starts(DIMENSION))
    mean, variance = predict(
        condition(observations, fitted.hyperparameters()), points + 0.01, basis
    )
    np.testing.assert_allclose(mean, 3.0, rtol=1e-9)
    assert np.all(np.isfinite(variance))

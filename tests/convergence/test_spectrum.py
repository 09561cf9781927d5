"""Fourier coefficients from Gauss points against closed forms, and how fast they converge."""

from math import pi

import jax.numpy as jnp
import numpy as np
import pytest

from camring.numerics.fourier import harmonics
from camring.numerics.quadrature import gauss_legendre

PERIOD = 2 * pi / 6
STEP, COUNT = 6, 30


def mesh(elements, seed=0):
    """Unequal elements of one period with their Gauss points and weights."""
    rng = np.random.default_rng(seed)
    width = rng.uniform(0.7, 1.3, elements)
    width *= PERIOD / width.sum()
    start = np.cumsum(width) - width
    points, weights = gauss_legendre(6)
    angle = (start[:, None] + width[:, None] * np.asarray(points)).ravel()
    return angle, (width[:, None] * np.asarray(weights)).ravel()


def coefficients(wave, elements):
    angle, weights = mesh(elements)
    values = jnp.asarray(wave(angle))
    return np.asarray(
        harmonics(values[None], jnp.asarray(weights), jnp.asarray(angle), STEP, COUNT)
    )[0]


def poisson_kernel(angle, sharpness=0.8):
    return (1 - sharpness**2) / (1 - 2 * sharpness * np.cos(6 * angle) + sharpness**2)


def test_a_single_wave_has_a_single_harmonic():
    found = coefficients(lambda angle: 3 + 4 * np.cos(5 * STEP * angle - 0.3), 64)
    expected = np.zeros(COUNT, complex)
    expected[4] = 2 * np.exp(-0.3j)
    np.testing.assert_allclose(found, expected, atol=1e-8)


def test_a_resonance_curve_has_geometric_harmonics():
    found = coefficients(poisson_kernel, 128)
    np.testing.assert_allclose(found, 0.8 ** np.arange(1, COUNT + 1), atol=1e-12)


def test_six_gauss_points_an_element_converge_at_order_twelve():
    exact = 0.8 ** np.arange(1, COUNT + 1)
    errors = np.array([np.abs(coefficients(poisson_kernel, n) - exact).max() for n in (12, 24, 48)])
    rate = np.log2(errors[0] / errors[2]) / 2
    assert rate > 9, (errors, rate)


@pytest.mark.parametrize("order", [100, 200])
def test_high_orders_are_resolved_by_elements_of_eight_radians(order):
    """Six Gauss points carry eight radians of phase to 1e-5, as the docstring says."""
    elements = int(np.ceil(PERIOD * order * 1.3 / 8))
    angle, weights = mesh(elements)
    wave = jnp.asarray(np.cos(6 * angle))
    found = harmonics(wave[None], jnp.asarray(weights), jnp.asarray(angle), 6, order // 6)[0]
    assert abs(found[0] - 0.5) < 1e-5
    assert float(np.abs(np.asarray(found[1:])).max()) < 1e-4

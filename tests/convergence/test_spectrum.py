"""Fourier coefficients from Gauss points against closed forms, and how fast they converge."""

from math import pi

import jax.numpy as jnp
import numpy as np
import pytest

from camring.numerics.fourier import harmonics
from camring.numerics.mesh import Mesh
from camring.numerics.quadrature import gauss_legendre

PERIOD = 2 * pi / 6
COUNT = 30


def mesh(elements, seed=0):
    """Unequal elements of one period."""
    rng = np.random.default_rng(seed)
    width = rng.uniform(0.7, 1.3, elements)
    width *= PERIOD / width.sum()
    start = np.cumsum(width) - width
    return Mesh(jnp.asarray(start), jnp.asarray(width), jnp.zeros(elements, bool))


def coefficients(wave, elements, count=COUNT):
    where = mesh(elements)
    points, _ = gauss_legendre(6)
    values = jnp.asarray(wave(np.asarray(where.at(jnp.asarray(points)))))
    return np.asarray(harmonics(values[None], where, PERIOD, count))[0]


def poisson_kernel(angle, sharpness=0.8):
    return (1 - sharpness**2) / (1 - 2 * sharpness * np.cos(6 * angle) + sharpness**2)


def test_a_single_wave_has_a_single_harmonic():
    found = coefficients(lambda angle: 3 + 4 * np.cos(30 * angle - 0.3), 64)
    expected = np.zeros(COUNT, complex)
    expected[4] = 2 * np.exp(-0.3j)
    np.testing.assert_allclose(found, expected, atol=1e-7)


def test_a_resonance_curve_has_geometric_harmonics():
    found = coefficients(poisson_kernel, 128)
    np.testing.assert_allclose(found, 0.8 ** np.arange(1, COUNT + 1), atol=1e-8)


def test_a_polynomial_through_six_points_gives_order_six_at_least():
    exact = 0.8 ** np.arange(1, COUNT + 1)
    errors = np.array([np.abs(coefficients(poisson_kernel, n) - exact).max() for n in (24, 48, 96)])
    rates = np.log2(errors[:-1] / errors[1:])
    assert np.all(rates > 5.5), (errors, rates)


def test_a_square_wave_needs_no_fine_elements():
    """Steps on nodes are exact: nothing of the jump is smeared or missed."""
    width = np.array([0.3, 0.0, 0.2, 0.5 - 1e-6, 1e-6]) * PERIOD
    where = Mesh(jnp.asarray(np.cumsum(width) - width), jnp.asarray(width), jnp.zeros(5, bool))
    level = np.array([1.0, 7.0, 1.0, 0.0, 0.0])
    values = jnp.asarray(np.broadcast_to(level, (1, 6, 5)))
    found = np.asarray(harmonics(values, where, PERIOD, 100))[0]
    order = np.arange(1, 101)
    exact = (1 - np.exp(-2j * pi * order * 0.5)) / (2j * pi * order)
    np.testing.assert_allclose(found, exact, atol=1e-5)


@pytest.mark.parametrize("spike", [1e-3, 1e-6])
def test_what_aliases_is_damped_fourfold(spike):
    """A spike has a flat spectrum, the worst there is; its hundredth order is still right."""
    width = np.array([0.4, spike, 0.6 - spike]) * PERIOD
    where = Mesh(jnp.asarray(np.cumsum(width) - width), jnp.asarray(width), jnp.zeros(3, bool))
    level = np.array([0.0, 1 / spike, 0.0])
    values = jnp.asarray(np.broadcast_to(level, (1, 6, 3)))
    found = np.abs(np.asarray(harmonics(values, where, PERIOD, 100))[0])
    exact = np.abs(np.sinc(np.arange(1, 101) * spike))
    np.testing.assert_allclose(found, exact, rtol=3e-3)
    assert abs(np.sum(found**2) / np.sum(exact**2) - 1) < 3e-4

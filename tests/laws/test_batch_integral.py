"""Spectra of waves that jump, side by side, are Fourier's, from few samples."""

import jax
import numpy as np
import pytest

from camring.numerics.batch_fourier import power_of_orders
from camring.numerics.batch_integral import INTEGRATIONS, integrated_samples
from camring.numerics.mesh import Mesh
from camring.numerics.quantity import real
from camring.numerics.radau import STAGES

PERIOD, ORDERS = 0.7, 20
FRACTIONS = np.concatenate([[0.0], STAGES])[:, None, None]
OPEN = np.array([0.2, 0.35, 0.0513])  # share of the period, in each member


def meshes(elements=31, seed=3):
    """A node where each member's wave jumps, elements of no width among the others."""
    rng = np.random.default_rng(seed)
    first = rng.uniform(0, PERIOD, len(OPEN))
    ends = np.sort(rng.uniform(0, 1, (elements - 3, len(OPEN))), axis=0)
    node = np.concatenate([np.zeros((1, len(OPEN))), ends, OPEN[None], OPEN[None]])
    start = first + PERIOD * np.sort(node, axis=0)
    width = np.diff(np.concatenate([start, start[:1] + PERIOD]), axis=0)
    return Mesh(start, width, np.zeros(start.shape, bool))


MESH = meshes()


def at_points(wave):
    """A wave of places behind the first node, at elements' starts and their three points."""
    begin = MESH.start - MESH.start[0]
    place = begin + FRACTIONS * MESH.width
    inside = begin + MESH.width / 2 < OPEN * PERIOD
    return real(wave(place, np.broadcast_to(inside, place.shape)))


def square(place, inside):
    return 5.0 + 2.0 * inside


def powers(wave):
    """By integrals, from four samples an order and from twelve, and by twelve samples."""

    @jax.jit
    def found(values, mesh):
        counts = (4 * ORDERS, 12 * ORDERS)
        integrals = [integrated_samples([values], mesh, PERIOD, count)[0] for count in counts]
        return [power_of_orders(each, ORDERS, INTEGRATIONS) for each in integrals]

    place = np.arange(12 * ORDERS)[:, None] * PERIOD / (12 * ORDERS)
    behind = (place - MESH.start[0]) % PERIOD
    plain = power_of_orders(real(wave(behind, behind < OPEN * PERIOD)), ORDERS)
    return *found(at_points(wave), MESH), plain


def test_a_wave_that_jumps_has_the_power_that_fourier_gives_it():
    """A pulse of share `s` and height `h` has the amplitudes `h sin(pi n s) / (pi n)`."""
    order = np.arange(1, ORDERS + 1)[:, None]
    expected = np.sum((2 * np.sin(np.pi * order * OPEN) / (np.pi * order)) ** 2, axis=0)
    few, many, plain = powers(square)
    np.testing.assert_allclose(few, expected, rtol=3e-4)
    np.testing.assert_allclose(many, expected, rtol=1e-6)
    # Samples of the wave itself, as many, are off by a hundred times that and more.
    assert np.max(np.abs(plain / expected - 1)) > 1e-3


@pytest.mark.parametrize("derivative", [1, INTEGRATIONS])
def test_the_slope_of_a_derivatives_power_is_its_difference(derivative):
    """Power is quadratic in the wave: the difference of both sides is exact."""
    rng = np.random.default_rng(5)
    wave, way = real(rng.normal(size=(2, 48, 2)))

    @jax.jit
    def found(wave, way):
        def of(wave):
            return power_of_orders(wave, 7, derivative)

        return *jax.jvp(of, (wave,), (way,)), (of(wave + way) - of(wave - way)) / 2

    value, slope, difference = found(wave, way)
    transform = np.fft.rfft(wave, axis=0)[1:8] / 48 * np.arange(1, 8)[:, None] ** derivative
    np.testing.assert_allclose(value, np.sum(np.abs(transform) ** 2, axis=0), rtol=1e-12)
    np.testing.assert_allclose(slope, difference, rtol=1e-11)

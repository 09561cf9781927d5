"""How fast a spline through a smooth profile comes to it: each derivative costs an order."""

from math import pi

import numpy as np
import pytest

from camring.geometry.cam import PlanarCam, RadialCam
from camring.numerics.spline import basis_matrix, evaluate_periodic

DENSE = np.linspace(0, 2 * pi, 4001)


def profile(angle):
    """A radius with all derivatives at hand: r, r', r'', r'''."""
    wave = np.exp(np.sin(angle))
    s, c = np.sin(angle), np.cos(angle)
    return (
        wave,
        wave * c,
        wave * (c**2 - s),
        wave * (c**3 - 3 * s * c - c),
    )


def interpolating_control(samples, degree):
    """Control values of the spline through equally spaced samples."""
    count = len(samples)
    impulse = np.zeros(count)
    impulse[0] = 1.0
    at_nodes = evaluate_periodic(impulse, 2 * pi * np.arange(count) / count, 2 * pi, degree).value
    symbol = np.fft.fft(np.asarray(at_nodes))
    found = np.fft.ifft(np.fft.fft(samples) / symbol)
    return found if np.iscomplexobj(samples) else found.real


def rates(errors):
    errors = np.asarray(errors)
    return np.log2(errors[:-1] / errors[1:])


@pytest.mark.parametrize(
    ("degree", "derivative"),
    [(p, k) for p in (3, 4, 5) for k in range(4)],
)
def test_each_derivative_of_a_radial_cam_costs_one_order(degree, derivative):
    errors = []
    for count in (32, 64, 128):
        samples = profile(2 * pi * np.arange(count) / count)[0]
        cam = RadialCam(interpolating_control(samples, degree), repeats=1, degree=degree)
        errors.append(
            np.abs(cam.pitch_radius(DENSE)[derivative] - profile(DENSE)[derivative]).max()
        )
    expected = degree + 1 - derivative
    assert np.all(np.abs(rates(errors) - expected) < 0.35), rates(errors)
    assert abs(rates(errors)[-1] - expected) < 0.12, rates(errors)


@pytest.mark.parametrize("derivative", range(4))
def test_each_derivative_of_a_planar_cam_costs_one_order(derivative):
    """The same profile drawn as a curve whose points are unequally turned."""
    errors = []
    for count in (64, 128, 256):
        parameter = 2 * pi * np.arange(count) / count
        turned = parameter + 0.3 * np.sin(parameter)
        curve = profile(turned)[0] * np.exp(1j * turned)
        control = interpolating_control(curve, 3)
        cam = PlanarCam(np.stack([control.real, control.imag], axis=-1), repeats=1, degree=3)
        errors.append(
            np.abs(cam.pitch_radius(DENSE)[derivative] - profile(DENSE)[derivative]).max()
        )
    expected = 4 - derivative
    assert np.all(np.abs(rates(errors) - expected) < 0.3), rates(errors)


def test_the_basis_is_the_textbook_one_for_cubics():
    expected = np.array([[0, 0, 0, 1], [1, 3, 3, -3], [4, 0, -6, 3], [1, -3, 3, -1]]) / 6
    np.testing.assert_allclose(basis_matrix(3), expected, atol=1e-16)

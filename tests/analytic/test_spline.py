"""The cam's splines against SciPy's, and what every B-spline owes its control values."""

from math import pi

import numpy as np
import pytest
from motors import STRUCTURES, random_cam
from scipy.interpolate import BSpline

from camring.geometry.cam import PlanarCam, RadialCam
from camring.numerics.spline import basis_matrix, evaluate_periodic, knots

DEGREES = (3, 4, 5)
SEEDS = range(6)


def scipy_periodic(control, period, degree, angle, derivative):
    """The definition in docs/theory.md section 2, through SciPy's recursion."""
    count, spacing = len(control), period / len(control)
    total = np.zeros_like(angle)
    for j in range(count):
        places = spacing * (np.arange(degree + 2) - (degree + 1) / 2)
        bump = BSpline.basis_element(places, extrapolate=False)
        bump = bump.derivative(derivative) if derivative else bump
        distance = (angle - j * spacing + period / 2) % period - period / 2
        total += control[j] * np.nan_to_num(bump(distance))
    return total


@pytest.mark.parametrize("degree", DEGREES)
@pytest.mark.parametrize("seed", SEEDS)
def test_the_spline_is_the_sum_of_cardinal_b_splines(degree, seed):
    rng = np.random.default_rng(seed)
    control, period = rng.normal(size=11), rng.uniform(0.5, 7)
    angle = rng.uniform(-3 * period, 3 * period, 50)
    jet = evaluate_periodic(control, angle, period, degree)
    spacing = period / len(control)
    for order, found in enumerate(jet):
        expected = scipy_periodic(control, period, degree, angle, order)
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10 / spacing**order)


@pytest.mark.parametrize("degree", DEGREES)
def test_equal_control_values_make_a_round_cam(degree):
    jet = evaluate_periodic(np.full(9, 0.2), np.linspace(-1, 8, 101), 2 * pi, degree)
    np.testing.assert_allclose(jet.value, 0.2, rtol=1e-15)
    for derivative in jet[1:]:
        np.testing.assert_allclose(derivative, 0, atol=1e-13)


@pytest.mark.parametrize("degree", DEGREES)
def test_basis_pieces_add_to_one_and_join_smoothly(degree):
    matrix = basis_matrix(degree)
    total = matrix.sum(axis=0)
    np.testing.assert_allclose(total, [1] + [0] * degree, atol=1e-15)
    pieces = [np.polynomial.Polynomial(row) for row in matrix]
    for order in range(degree):
        ends = [(piece.deriv(order) if order else piece)(1.0) for piece in pieces]
        starts = [(piece.deriv(order) if order else piece)(0.0) for piece in pieces]
        np.testing.assert_allclose(ends[:-1], starts[1:], atol=1e-13)
        assert ends[-1] == pytest.approx(0, abs=1e-13)


@pytest.mark.parametrize("degree", DEGREES)
def test_a_control_value_acts_at_its_own_angle(degree):
    count, period = 12, 1.5
    control = np.zeros(count)
    control[4] = 1.0
    centre = 4 * period / count
    offset = np.linspace(0, period / 3, 41)
    ahead = evaluate_periodic(control, centre + offset, period, degree)
    behind = evaluate_periodic(control, centre - offset, period, degree)
    np.testing.assert_allclose(ahead.value, behind.value, atol=1e-14)
    assert np.argmax(ahead.value) == 0


@pytest.mark.parametrize("degree", DEGREES)
def test_only_the_highest_derivative_jumps_and_only_at_the_knots(degree):
    rng = np.random.default_rng(degree)
    count, period = 11, 2.0
    cam = RadialCam(rng.normal(size=count), repeats=1, degree=degree)
    period = cam.period
    edges = np.append(knots(count, period, degree), knots(count, period, degree)[0] + period)
    np.testing.assert_allclose(cam.breakpoints(), edges[:-1])
    inside = cam.pitch_radius_between(edges[:-1], np.diff(edges), np.array([0.0, 0.3, 1.0]))
    spacing = period / count
    for order in range(min(degree, 4)):
        end_of_one, start_of_next = inside[order][2], np.roll(inside[order][0], -1)
        np.testing.assert_allclose(end_of_one, start_of_next, atol=1e-11 / spacing**order)
    if degree == 3:
        assert np.abs(inside.third[2] - np.roll(inside.third[0], -1)).min() > 1e-3
    middle = edges[:-1] + 0.3 * np.diff(edges)
    for between, anywhere in zip(inside, cam.pitch_radius(middle), strict=True):
        np.testing.assert_allclose(between[1], anywhere, rtol=1e-11, atol=1e-11)


@pytest.mark.parametrize("degree", DEGREES)
@pytest.mark.parametrize("seed", SEEDS)
def test_a_planar_cam_is_a_curve_and_its_radius_is_read_at_the_polar_angle(degree, seed):
    """Walk along the curve itself and ask the cam for the radius at each point's angle."""
    rng = np.random.default_rng(seed)
    lobes, count = 1 + 2 * (seed % 3), 12
    step = 2 * pi / lobes / count
    turned = step * (np.arange(count) + rng.uniform(-0.25, 0.25, count))
    radius = 0.2 * (1 + 0.1 / lobes * rng.uniform(-1, 1, count))
    points = np.stack([radius * np.cos(turned), radius * np.sin(turned)], axis=-1)
    cam = PlanarCam(points, repeats=lobes, degree=degree)
    turns = 2 * pi / lobes * np.arange(lobes)[:, None]
    ring = ((points[:, 0] + 1j * points[:, 1]) * np.exp(1j * turns)).ravel()
    parameter = rng.uniform(0, 2 * pi, 60)
    curve = [
        scipy_periodic(ring.real, 2 * pi, degree, parameter, k)
        + 1j * scipy_periodic(ring.imag, 2 * pi, degree, parameter, k)
        for k in (0, 1)
    ]
    assert float(cam.least_turning()) > 0.05
    angle, along = np.angle(curve[0]), curve[1] / curve[0]
    jet = cam.pitch_radius(angle)
    np.testing.assert_allclose(jet.value, np.abs(curve[0]), rtol=1e-13)
    np.testing.assert_allclose(
        jet.first, np.abs(curve[0]) * along.real / along.imag, rtol=1e-10, atol=1e-13
    )


@pytest.mark.parametrize("degree", DEGREES)
@pytest.mark.parametrize("kind", ["radial", "planar"])
def test_derivatives_of_the_radius_are_its_slopes(degree, kind):
    structure = next(s for s in STRUCTURES if s.kind == kind)
    structure = type(structure)(kind, structure.pistons, structure.lobes, 12, degree)
    cam = random_cam(np.random.default_rng(5), structure, 0.15, 0.015)
    edges = np.asarray(cam.breakpoints())
    middle = (edges[1:] + edges[:-1]) / 2
    step = 2e-5
    ahead, here, behind = (cam.pitch_radius(middle + k * step) for k in (1, 0, -1))
    for order in range(3):
        slope = (ahead[order] - behind[order]) / (2 * step)
        scale = np.abs(here[order + 1]).max()
        np.testing.assert_allclose(slope, here[order + 1], rtol=0, atol=1e-6 * scale)


@pytest.mark.parametrize("kind", ["radial", "planar"])
def test_lobes_are_alike_whether_written_once_or_all_round(kind):
    structure = next(s for s in STRUCTURES if s.kind == kind)
    cam = random_cam(np.random.default_rng(3), structure, 0.15, 0.015)
    lobes, angle = structure.lobes, np.linspace(-1, 7, 200)
    if kind == "radial":
        around = RadialCam(np.tile(cam.control_radii, lobes), repeats=1, degree=cam.degree)
    else:
        turn = 2 * pi / lobes * np.arange(lobes)
        points = np.asarray(cam.control_points)
        rotation = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
        around = PlanarCam(
            np.einsum("jx,xyk->kjy", points, rotation).reshape(-1, 2), repeats=1, degree=cam.degree
        )
    for one, all_round in zip(cam.pitch_radius(angle), around.pitch_radius(angle), strict=True):
        scale = np.abs(np.asarray(one)).max()
        np.testing.assert_allclose(one, all_round, rtol=0, atol=1e-11 * scale)


@pytest.mark.parametrize("degree", DEGREES)
def test_equally_turned_points_on_a_circle_make_a_nearly_round_planar_cam(degree):
    turned = 2 * pi * np.arange(24) / 24
    cam = PlanarCam(np.stack([np.cos(turned), np.sin(turned)], axis=-1), repeats=1, degree=degree)
    jet = cam.pitch_radius(np.linspace(0, 2 * pi, 300))
    assert np.ptp(jet.value) < 2e-5
    assert float(cam.least_turning()) == pytest.approx(1, abs=1e-3)

"""The pitch curve as a plane curve, its parallels, and splines that follow them."""

from math import pi

import numpy as np
import pytest

from camring.geometry.cam import PlanarCam, RadialCam
from camring.geometry.contour import pitch_curvature
from camring.geometry.outline import outline_of
from camring.numerics.spline import Jet

ROLLER = 0.012
MICROMETRE = 1e-6
ANGLES = np.linspace(-1, 8, 1501)  # rad


def lobed(count=16, repeats=6, degree=3):
    angle = 2 * pi * np.arange(count) / count
    radii = 0.0909 - 0.006 * np.cos(angle) + 0.0004 * np.sin(2 * angle)
    return RadialCam(radii, repeats=repeats, degree=degree)


def free_ring(degree=3):
    angle = 2 * pi * np.arange(96) / 96
    return RadialCam(
        0.0909 - 0.006 * np.cos(6 * angle) + 0.0005 * np.cos(angle), repeats=1, degree=degree
    )


def planar(repeats=6, degree=3):
    angle = 2 * pi / repeats * np.arange(12) / 12
    # Turned unequally, so that polar angle and parameter differ.
    radius, turned = 0.0909 - 0.006 * np.cos(6 * angle), angle + 0.004 * np.sin(6 * angle)
    points = np.stack([radius * np.cos(turned), radius * np.sin(turned)], axis=1)
    return PlanarCam(points, repeats=repeats, degree=degree)


CAMS = {
    "lobed": lobed(),
    "lobed, degree 4": lobed(degree=4),
    "free ring": free_ring(),
    "planar": planar(),
    "planar, degree 4": planar(degree=4),
}


@pytest.fixture(params=CAMS, scope="module")
def cam(request):
    return CAMS[request.param]


@pytest.fixture(scope="module")
def radius(cam):
    """The pitch radius as the simulation computes it, at `ANGLES`."""
    return Jet(*map(np.asarray, cam.pitch_radius(ANGLES)))


def test_the_outline_is_the_pitch_curve(cam, radius):
    outline, angle = outline_of(cam), ANGLES
    found = outline.places(outline.parameter_at(angle))
    np.testing.assert_allclose(np.abs(found.point), radius.value, rtol=1e-13)
    np.testing.assert_allclose(np.exp(1j * np.angle(found.point)), np.exp(1j * angle), atol=1e-12)
    np.testing.assert_allclose(found.curvature, pitch_curvature(radius), rtol=1e-8, atol=1e-8)


def test_normals_are_upright_and_point_away_from_the_shaft(cam, radius):
    outline, angle = outline_of(cam), ANGLES
    found = outline.places(outline.parameter_at(angle))
    lean = np.angle(np.exp(1j * angle) * np.conj(found.normal))
    np.testing.assert_allclose(np.tan(lean), radius.first / radius.value, atol=1e-11)
    assert np.all(np.abs(lean) < pi / 2)


def test_a_round_cam_has_a_round_surface():
    outline = outline_of(RadialCam(np.full(12, 0.09), repeats=1))
    found = outline.places(np.linspace(0, 2 * pi, 100), ROLLER)
    np.testing.assert_allclose(np.abs(found.point), 0.09 + ROLLER, rtol=1e-14)
    np.testing.assert_allclose(found.curvature, 1 / (0.09 + ROLLER), rtol=1e-12)
    assert outline.undercut(ROLLER).factor == pytest.approx(1 + ROLLER / 0.09, rel=1e-12)
    circle = outline.fit(ROLLER, 1e-8)
    assert circle.length == pytest.approx(2 * pi * (0.09 + ROLLER), rel=1e-12)
    around = circle.at(np.linspace(0, circle.length, 999))
    assert np.abs(np.abs(around) - (0.09 + ROLLER)).max() <= 1e-8


def test_a_parallel_is_longer_by_the_turn_it_makes(cam):
    """Steiner: once round, whatever the shape."""
    outline = outline_of(cam)
    pitch, surface = outline.fit(0.0, MICROMETRE), outline.fit(ROLLER, MICROMETRE)
    assert surface.length - pitch.length == pytest.approx(2 * pi * ROLLER, rel=1e-9)


def test_distances_are_measured_along_the_exact_normal(cam):
    outline = outline_of(cam)
    parameter = np.linspace(0, 2 * pi, 200)
    off = 1e-5 * np.cos(7 * parameter)
    point = outline.places(parameter, ROLLER).point + off * outline.places(parameter).normal
    near = parameter + 2e-3 * np.sin(11 * parameter)
    np.testing.assert_allclose(outline.stray(point, near, ROLLER), off, atol=1e-15)


@pytest.mark.parametrize("distance", [0.0, ROLLER])
@pytest.mark.parametrize("tolerance", [1e-6, 1e-7, 1e-8])
def test_a_spline_keeps_its_tolerance_everywhere(cam, distance, tolerance):
    outline = outline_of(cam)
    spline = outline.fit(distance, tolerance)
    exact = outline.places(np.linspace(0, 2 * pi, 3001), distance).point
    arc = np.linspace(0, spline.length, 20_011)
    followed = spline.at(arc)
    near = np.angle(followed) if outline.is_radial else np.unwrap(np.angle(followed))
    strays = np.abs(outline.stray(followed, near, distance))
    assert strays.max() <= 1.02 * tolerance
    assert spline.error <= tolerance
    # It goes once round all of the curve.
    assert np.abs(followed[0] - exact[0]) <= tolerance
    lengths = np.abs(np.diff(followed)).sum()
    assert lengths == pytest.approx(spline.length, rel=1e-5)


def test_a_spline_is_the_same_in_all_its_forms(cam):
    spline = outline_of(cam).fit(ROLLER, 1e-7)
    arc = np.linspace(0, spline.length, 500)
    clamped = spline.clamped()
    np.testing.assert_allclose(clamped(arc) @ [1, 1j], spline.at(arc), atol=1e-15)
    np.testing.assert_allclose(clamped.c[0], clamped.c[-1], atol=1e-16)
    a, b, c, d = spline.bezier().T
    middle = spline.at((spline.arc[:-1] + spline.arc[1:]) / 2)
    np.testing.assert_allclose((a + 3 * b + 3 * c + d) / 8, middle, atol=1e-15)


def test_undercut_begins_where_the_roller_is_as_large_as_the_sharpest_bend(cam):
    outline = outline_of(cam)
    grid = outline.parameter_at(np.linspace(0, 2 * pi, 20_001))
    sharpest = -outline.places(grid).curvature.min()
    largest = 1 / sharpest
    assert outline.undercut(0.99 * largest).factor == pytest.approx(0.01, rel=1e-3)
    assert outline.undercut(1.01 * largest).factor < 0
    found = outline.undercut(ROLLER)
    there = outline.places(outline.parameter_at(np.asarray(found.angle)))
    assert 1 + there.curvature * ROLLER == pytest.approx(found.factor, abs=1e-9)


def test_extremes_of_radius_lie_on_the_curve_with_nothing_beyond(cam, radius):
    outline = outline_of(cam)
    for sign, beyond in ((-1, radius.value.min()), (1, radius.value.max())):
        value, angle = outline.extreme_radius(sign)
        assert sign * (value - beyond) >= -1e-12
        assert value == pytest.approx(beyond, abs=1e-6)
        there = outline.places(outline.parameter_at(np.asarray(angle))).point
        assert np.abs(there) == pytest.approx(value, abs=1e-14)


def test_a_roller_that_cuts_a_neighbouring_flank_is_found():
    """A deep groove: every bend is wide enough, the groove is not."""
    angle = 2 * pi * np.arange(400) / 400
    pit = 0.03 / (1 + np.exp((np.abs(np.angle(np.exp(1j * angle))) - 0.25) / 0.03))
    outline = outline_of(RadialCam(0.1 - pit, repeats=1))
    assert outline.cuts_into_itself(0.002) == 0.0
    deep = outline.cuts_into_itself(0.03)
    assert 0 < deep < 0.03
    assert outline_of(lobed()).cuts_into_itself(ROLLER) == 0.0

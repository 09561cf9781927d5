"""Textbook cams are what the textbook says, in the spline itself."""

from math import gcd, pi

import numpy as np
import pytest

from camring.geometry.profiles import (
    LAWS,
    constant_acceleration,
    control_values,
    modified_trapezoid,
    sine,
    zero_ripple_cams,
)
from camring.geometry.sampling import from_first, sample_spline, turning

PHASE = np.linspace(0, 2 * pi, 20001)


def slope(values, order=1):
    for _ in range(order):
        values = np.gradient(values, PHASE)
    return values


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
class TestEveryLaw:
    def test_rises_from_nothing_to_the_whole_stroke(self, law):
        lift = law(PHASE)
        assert lift[0] == pytest.approx(0, abs=1e-15)
        assert law(np.array(pi)) == pytest.approx(1)
        assert np.all(np.diff(lift[pi >= PHASE]) >= -1e-15)

    def test_falls_as_it_rose(self, law):
        np.testing.assert_allclose(law(PHASE), law(2 * pi - PHASE), atol=1e-14)

    def test_repeats_after_a_lobe(self, law):
        np.testing.assert_allclose(law(PHASE + 2 * pi), law(PHASE), atol=1e-14)

    @pytest.mark.parametrize("degree", [3, 4, 5])
    def test_spline_passes_through_it_at_the_knots(self, law, degree):
        spline = sample_spline(control_values(law, 24, degree), 2 * pi, degree)
        knots = 2 * pi * np.arange(24) / 24
        passed = np.interp(knots, spline.angle, spline.value, period=2 * pi)
        np.testing.assert_allclose(passed, law(knots), atol=1e-12)


# Peak velocity and acceleration of one flank of unit time and rise (Norton, table 3.3).
@pytest.mark.parametrize(
    ("law", "velocity", "acceleration"),
    [(sine, pi / 2, pi**2 / 2), (constant_acceleration, 2, 4), (modified_trapezoid, 2, 4.888)],
)
def test_peaks_are_those_of_the_handbook(law, velocity, acceleration):
    lift = law(PHASE)
    inner = slice(5, -5)  # differences are one-sided at the ends
    assert np.max(slope(lift)[inner]) * pi == pytest.approx(velocity, rel=1e-3)
    assert np.max(slope(lift, 2)[inner]) * pi**2 == pytest.approx(acceleration, rel=1e-3)


@pytest.mark.parametrize(("pistons", "lobes", "count"), [(8, 6, 16), (10, 8, 20), (16, 10, 16)])
@pytest.mark.parametrize("degree", [3, 4, 5])
class TestZeroRippleCams:
    def test_slopes_of_all_pistons_add_up_to_a_constant(self, pistons, lobes, count, degree):
        phases = pistons // gcd(pistons, lobes)
        per_span = 16 * phases  # so that a piston's phase is a whole number of samples
        cams = list(zero_ripple_cams(pistons, lobes, count, degree))
        assert cams
        for cam in cams:
            spline = sample_spline(cam.control_values(count), 2 * pi, degree, per_span)
            rising = np.maximum(spline.first, 0)
            step = len(rising) // phases
            total = sum(np.roll(rising, k * step) for k in range(phases))
            np.testing.assert_allclose(total, np.mean(total), rtol=1e-12)

    def test_stroke_is_exact_and_the_dead_centre_at_angle_zero(self, pistons, lobes, count, degree):
        for cam in zero_ripple_cams(pistons, lobes, count, degree):
            values = cam.control_values(count)
            spline = sample_spline(values, 2 * pi, degree)
            assert np.ptp(spline.value) == pytest.approx(1, abs=1e-12)
            assert spline.value[0] == pytest.approx(0, abs=1e-12)
            np.testing.assert_allclose(values, np.roll(values[::-1], 1), atol=1e-12)

    def test_no_two_are_the_same(self, pistons, lobes, count, degree):
        cams = [c.control_values(count) for c in zero_ripple_cams(pistons, lobes, count, degree)]
        for place, one in enumerate(cams):
            assert all(np.max(np.abs(one - other)) > 1e-9 for other in cams[:place])


@pytest.mark.parametrize(
    ("pistons", "lobes", "count"), [(8, 6, 15), (10, 8, 16), (6, 6, 16), (8, 6, 4)]
)
def test_counts_that_allow_no_zero_ripple_cam_give_none(pistons, lobes, count):
    assert list(zero_ripple_cams(pistons, lobes, count)) == []


@pytest.mark.parametrize("degree", [3, 4, 5])
def test_samples_agree_with_the_cam_itself(degree):
    from camring.geometry.cam import RadialCam
    from camring.numerics.quantity import real

    radii = 0.1 + 0.01 * np.random.default_rng(1).random(9)
    cam = RadialCam(control_radii=real(radii), repeats=5, degree=degree)
    spline = sample_spline(radii, cam.period, degree)
    jet = cam.pitch_radius(real(spline.angle))
    np.testing.assert_allclose(spline.value, jet.value, rtol=1e-13)
    np.testing.assert_allclose(spline.first, jet.first, rtol=1e-10, atol=1e-12)


class TestTurning:
    def ring(self, repeats=6, count=12, backwards=False):
        angle = 2 * pi / repeats * np.arange(count) / count
        radius = 0.09 - 0.005 * np.cos(repeats * angle)
        angle = -angle if backwards else angle
        return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)

    def test_of_a_sound_curve_is_once_and_forward(self):
        found = turning(self.ring(), 6, 3)
        assert found.winding == 1
        assert found.least > 0.5
        assert np.ptp(found.radius.value) == pytest.approx(0.01, rel=0.1)

    def test_of_a_clockwise_curve_is_minus_one(self):
        assert turning(self.ring(1, 24, backwards=True), 1, 3).winding == -1

    def test_of_a_loop_is_negative_somewhere(self):
        points = self.ring()
        points[[4, 7]] = points[[7, 4]]
        assert turning(points, 6, 3).least < 0

    def test_start_of_the_list_does_not_change_the_curve(self):
        points = self.ring()
        turned = points @ np.array([[np.cos(2.5), np.sin(2.5)], [-np.sin(2.5), np.cos(2.5)]])
        first = from_first(turned, 6)
        assert abs(np.arctan2(first[0, 1], first[0, 0])) < pi / 6
        before, after = turning(turned, 6, 3), turning(first, 6, 3)
        np.testing.assert_allclose(np.sort(before.radius.value), np.sort(after.radius.value))

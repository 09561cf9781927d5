"""What is known exactly about smooth cams (docs/theory.md section 11)."""

from math import gcd, pi, sqrt, tan

import numpy as np
import pytest

from camring.geometry.cam import RadialCam


def zero_ripple_control(phases, count, rising, kernel, inner=0.2, stroke=0.015):
    """Control radii of one lobe whose rising slope is a box of `rising/phases` lobes, smoothed."""
    steps = np.convolve(np.ones(rising * count // phases), kernel)
    assert len(steps) + 2 <= count // 2
    slopes = np.zeros(count)
    slopes[: len(steps)] = steps
    slopes[count // 2 : count // 2 + len(steps)] = -steps
    return inner + stroke / steps.sum() * np.cumsum(slopes)


def geometric_sum(cam, pistons, angle):
    """`G`: the rising slopes of all pistons together, m/rad."""
    piston = angle[:, None] + 2 * pi * np.arange(pistons) / pistons
    return np.maximum(np.asarray(cam.pitch_radius(piston).first), 0).sum(axis=1)


MOTORS = ((8, 6), (10, 8), (16, 10), (7, 5), (9, 6))


@pytest.mark.parametrize(("pistons", "lobes"), MOTORS)
@pytest.mark.parametrize("degree", [3, 4, 5])
@pytest.mark.parametrize("seed", range(4))
def test_a_box_of_whole_piston_phases_under_any_kernel_has_no_geometric_ripple(
    pistons, lobes, degree, seed
):
    rng = np.random.default_rng(seed)
    phases = pistons // gcd(pistons, lobes)
    count = 2 * phases * 5
    space = count // 2 - (degree - 1)
    rising = int(rng.integers(1, max(space * phases // count, 1) + 1))
    width = rising * count // phases
    kernel = rng.uniform(0, 1, size=int(rng.integers(1, space - width + 2))) + 0.01
    cam = RadialCam(
        zero_ripple_control(phases, count, rising, kernel), repeats=lobes, degree=degree
    )
    total = geometric_sum(cam, pistons, np.linspace(0, 2 * pi / lobes, 397))
    np.testing.assert_allclose(total, total.mean(), rtol=1e-12)
    # Every piston's rise, spread evenly over the turn.
    stroke = np.ptp(np.asarray(cam.pitch_radius(np.linspace(0, 2 * pi, 20001)).value))
    assert total.mean() == pytest.approx(pistons * lobes * stroke / (2 * pi), rel=1e-6)


@pytest.mark.parametrize(("pistons", "lobes"), MOTORS)
def test_geometric_ripple_is_what_the_lobe_harmonics_of_the_rising_slope_say(pistons, lobes):
    """`G` holds the lobe harmonics q, 2q, ... of max(s', 0), each times the piston count."""
    rng = np.random.default_rng(pistons)
    phases = pistons // gcd(pistons, lobes)
    cam = RadialCam(0.2 + 0.004 * rng.normal(size=16), repeats=lobes, degree=3)
    grid = 4096 * phases
    phase = np.arange(grid) / grid
    rising = np.maximum(np.asarray(cam.pitch_radius(phase * 2 * pi / lobes).first), 0)
    harmonics = np.fft.fft(rising) / grid
    total = geometric_sum(cam, pistons, phase * 2 * pi / lobes)
    found = np.fft.fft(total) / grid
    for n in range(1, 40):
        expected = pistons * harmonics[n] if n % phases == 0 else 0.0
        assert abs(found[n] - expected) < 1e-9


@pytest.mark.parametrize(("pistons", "lobes", "waves"), [(8, 6, 4), (10, 8, 10), (10, 4, 10)])
def test_a_sine_cam_ripples_as_the_rectified_sine_says(pistons, lobes, waves):
    """K = q for even q, 2q for odd; the two decimals are those of docs/theory.md."""
    count = 128
    control = 0.2 - 0.01 * np.cos(2 * pi * np.arange(count) / count)
    cam = RadialCam(control, repeats=lobes, degree=5)
    phases = pistons // gcd(pistons, lobes)
    assert waves == (phases if phases % 2 == 0 else 2 * phases)
    angle = 2 * pi / lobes * np.arange(160_000) / 160_000
    total = geometric_sum(cam, pistons, angle)
    peak_to_peak = np.ptp(total) / total.mean()
    assert peak_to_peak == pytest.approx(pi / waves * tan(pi / (2 * waves)), rel=2e-6)
    true_rms = total.std() / total.mean()
    known = {4: 0.09772081, 10: 0.01485244}[waves]
    assert true_rms == pytest.approx(known, rel=1e-6)
    exact = sqrt(0.5 + waves / (4 * pi) * np.sin(2 * pi / waves)) * pi / waves
    assert true_rms == pytest.approx(sqrt((exact / np.sin(pi / waves)) ** 2 - 1), rel=3e-7)

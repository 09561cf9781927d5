"""Statistics of what scatters, on distributions and functions that are known exactly."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.special import ndtri

from camring.search.descent.gradient import GradientSearch
from camring.search.minimise import minimise
from camring.search.scatter.contributions import by_regression, by_slopes
from camring.search.scatter.distributions import KINDS, WIDTHS, deviates, owners
from camring.search.scatter.robust import RobustFunction, Scattered, ScatteredSlopes
from camring.search.scatter.statistic import SMOOTHING, MeanPlus, SmoothQuantile

WORST = SmoothQuantile(0.95)
STATISTICS = [MeanPlus(0.0), MeanPlus(2.0), SmoothQuantile(0.5), SmoothQuantile(0.95)]
samples = arrays(float, st.integers(2, 40), elements=st.floats(-10, 10), unique=True)


class TestChance:
    def test_the_same_seed_gives_the_same_bits_and_another_seed_others(self):
        one, same, other = (deviates(KINDS, 100, seed) for seed in (3, 3, 4))
        assert one.tobytes() == same.tobytes()
        assert not np.any(one == other)

    def test_more_samples_begin_with_the_same(self):
        np.testing.assert_array_equal(deviates(KINDS, 300, 0)[:100], deviates(KINDS, 100, 0))

    def test_mean_variance_and_independence(self):
        found = deviates(KINDS, 4096, 1)
        assert found.shape[1] == sum(WIDTHS.values()) == len(owners(KINDS))
        np.testing.assert_allclose(found.mean(axis=0), 0, atol=2e-3)
        np.testing.assert_allclose(np.cov(found.T, ddof=0), np.eye(4), atol=5e-3)

    def test_uniform_lies_within_its_ends_and_a_phase_on_a_circle(self):
        found = deviates(KINDS, 1000, 2)
        assert np.max(np.abs(found[:, 0])) < np.sqrt(3)
        np.testing.assert_allclose(np.sum(found[:, 2:] ** 2, axis=1), 2, rtol=1e-12)

    @pytest.mark.parametrize("share", [0.05, 0.5, 0.95])
    def test_quantiles_are_those_of_the_distributions(self, share):
        found = np.quantile(deviates(("uniform", "normal"), 2**14, 5), share, axis=0)
        exact = [np.sqrt(3) * (2 * share - 1), ndtri(share)]
        np.testing.assert_allclose(found, exact, atol=1e-3)

    def test_no_deviate_is_infinite(self):
        assert np.all(np.isfinite(deviates(("normal",) * 20, 2**12, 0)))


@pytest.mark.parametrize("statistic", STATISTICS, ids=str)
class TestStatistics:
    @given(values=samples)
    def test_weights_are_central_differences(self, statistic, values):
        values = values + np.linspace(0, 1, len(values))  # never all equal
        weights = statistic(values).weights
        step = 1e-5 * np.std(values)
        differences = [
            (statistic(values + row).value - statistic(values - row).value) / (2 * step)
            for row in step * np.eye(len(values))
        ]
        np.testing.assert_allclose(weights, differences, atol=1e-6)
        assert weights.sum() == pytest.approx(1)

    @given(values=samples, shift=st.floats(-5, 5), scale=st.floats(0.1, 10))
    def test_goes_with_the_samples(self, statistic, values, shift, scale):
        values = values + np.linspace(0, 1, len(values))
        moved = statistic(shift + scale * values)
        assert moved.value == pytest.approx(
            shift + scale * statistic(values).value, rel=1e-9, abs=1e-9
        )

    def test_of_equal_samples_is_the_sample(self, statistic):
        found = statistic(np.full(9, 0.3))
        assert found.value == pytest.approx(0.3, rel=1e-15)
        np.testing.assert_allclose(found.weights, 1 / 9)

    def test_does_not_care_for_the_order(self, statistic):
        values = np.random.default_rng(0).normal(size=50)
        assert statistic(values[::-1]).value == pytest.approx(statistic(values).value, rel=1e-12)


def test_the_smooth_quantile_of_a_normal_is_that_of_the_widened_normal():
    """A normal plus independent normal noise is a normal."""
    values = ndtri((np.arange(4096) + 0.5) / 4096)
    for share in (0.5, 0.9, 0.95):
        found = SmoothQuantile(share)(values).value
        assert found == pytest.approx(ndtri(share) * np.sqrt(1 + SMOOTHING**2), abs=2e-3)


def test_twice_as_many_samples_leave_less_than_the_root_of_the_error():
    """exp of a uniform number: mean and variance are known, Sobol's error falls as 1/N."""
    root = np.sqrt(3)
    mean = np.sinh(root) / root
    deviation = np.sqrt(np.sinh(2 * root) / (2 * root) - mean**2)

    def error(count):
        off = [
            MeanPlus(2.0)(np.exp(deviates(("uniform",), count, seed)[:, 0])).value
            for seed in range(8)
        ]
        return np.sqrt(np.mean((np.array(off) - mean - 2 * deviation) ** 2))

    errors = np.array([error(2**k) for k in (4, 6, 8, 10)])
    assert np.all(np.log2(errors[:-1] / errors[1:]) / 2 > 0.7), errors


class TestContributions:
    KINDS = ("uniform", "normal", "phase")
    SLOPES = np.array([3.0, -2.0, 0.5, 1.0])

    def test_of_a_linear_result_both_solvers_are_exact(self):
        chances = deviates(self.KINDS, 1024, 0)
        values = 7 + chances @ self.SLOPES
        exact = [9, 4, 0.25 + 1]
        slopes = by_slopes(self.SLOPES, owners(self.KINDS), values)
        plane = by_regression(chances, values, owners(self.KINDS))
        np.testing.assert_allclose(slopes.variances, exact, rtol=1e-14)
        np.testing.assert_allclose(plane.variances, exact, rtol=1e-9)
        assert plane.explained == pytest.approx(1, abs=1e-12)
        # First order gives the samples' own standard deviation.
        assert np.sqrt(slopes.variances.sum()) == pytest.approx(np.std(values), rel=3e-3)
        assert slopes.explained == pytest.approx(1, abs=6e-3)

    def test_of_a_square_slopes_explain_nothing_and_regression_says_so(self):
        chances = deviates(("uniform",), 1024, 0)
        plane = by_regression(chances, chances[:, 0] ** 2, [0])
        assert plane.explained < 1e-2
        assert by_slopes(np.zeros(1), [0], chances[:, 0] ** 2).explained == 0

    def test_of_nothing_everything_is_explained(self):
        chances = deviates(("uniform",), 16, 0)
        assert by_regression(chances, np.ones(16), [0]).explained == 1


class TestRobustFunction:
    """A narrow pit of depth 1 at 0.3 beside a wide one of 0.9 at 0.7; the place scatters."""

    CHANCES = 0.05 * deviates(("uniform",), 64, 0)[:, 0]

    def pits(self, x):
        narrow, wide = ((x - 0.3) / 0.03, (x - 0.7) / 0.2)
        value = -np.exp(-(narrow**2)) - 0.9 * np.exp(-(wide**2))
        slope = 2 * narrow / 0.03 * np.exp(-(narrow**2)) + 1.8 * wide / 0.2 * np.exp(-(wide**2))
        return value, slope

    def robust(self, statistic, of_limits=WORST, limit=1.0):
        def scattered(point):
            at = point[0] + self.CHANCES
            return Scattered(self.pits(at)[0], (at - limit)[None])

        def slopes(point):
            at = point[0] + self.CHANCES
            return ScatteredSlopes(self.pits(at)[1][None], np.ones((1, 1, len(at))))

        return RobustFunction(scattered, slopes, statistic, of_limits)

    def search(self, function):
        strategy = GradientSearch(1, function.slopes, ((0.3,),))
        return minimise(function.problem(1, 1), strategy, 200)

    @pytest.mark.parametrize("statistic", STATISTICS, ids=str)
    def test_slopes_are_central_differences(self, statistic):
        function = self.robust(statistic)
        for at in (0.28, 0.5, 0.66):
            step, point = 1e-6, np.array([at])
            rise = function.outputs(point + step)[0] - function.outputs(point - step)[0]
            objective, limits = function.slopes(point)
            assert objective[0] == pytest.approx(rise / (2 * step), rel=1e-5, abs=1e-7)
            assert limits.tolist() == [[pytest.approx(1.0)]]

    @pytest.mark.parametrize("statistic", [MeanPlus(2.0), SmoothQuantile(0.95)], ids=str)
    def test_the_robust_design_lies_in_the_wide_pit(self, statistic):
        nominal = min(np.linspace(0, 1, 1001), key=lambda x: self.pits(x)[0])
        found = self.search(self.robust(statistic)).best
        assert nominal == pytest.approx(0.3, abs=0.01)
        assert found.point[0] == pytest.approx(0.7, abs=0.02)
        fresh = 0.05 * deviates(("uniform",), 1024, 9)[:, 0]
        worse = [np.quantile(self.pits(x + fresh)[0], 0.95) for x in (nominal, found.point[0])]
        assert worse[1] < worse[0] - 0.3

    def test_a_limit_is_kept_by_the_share_asked_for(self):
        found = self.search(self.robust(MeanPlus(0.0), SmoothQuantile(0.9), limit=0.6)).best
        kept = np.mean(found.point[0] + self.CHANCES <= 0.6)
        assert 0.85 <= kept < 1

    def test_one_failed_sample_fails_the_design(self):
        function = RobustFunction(
            lambda point: Scattered(np.array([1.0, np.nan, 2.0]), np.zeros((2, 3))),
            lambda point: ScatteredSlopes(np.zeros((1, 3)), np.zeros((2, 1, 3))),
            MeanPlus(1.0),
            MeanPlus(1.0),
        )
        objective, limits, _, failure = function.outputs(np.zeros(1))
        assert np.isnan(objective)
        assert np.all(np.isnan(limits))
        assert failure == "1 of 3 samples failed"

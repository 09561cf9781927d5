"""Least squares: exact answers, intervals that hold what they promise, what they leave open."""

import numpy as np
import pytest
from scipy.stats import linregress
from scipy.stats import t as student

from camring.search.confidence import confidence, determined, drift
from camring.search.least_squares import fit_squares

X = np.linspace(0.0, 1.0, 12)
LINE = np.stack([np.ones_like(X), X], axis=1)
BOX = dict(lower=np.full(2, -50.0), upper=np.full(2, 50.0))


def line(point):
    return LINE @ point, LINE


def growth(point):
    """`exp(a + b x)`, not linear in its numbers."""
    values = np.exp(LINE @ point)
    return values, values[:, None] * LINE


def solved(measured, sizes=1.0):
    """Residuals and slopes of the best line, over the standard deviations."""
    slopes = LINE / np.broadcast_to(sizes, X.shape)[:, None]
    best, *_ = np.linalg.lstsq(slopes, measured / sizes, rcond=None)
    return best, slopes @ best - measured / sizes, slopes


def test_values_without_noise_are_met_exactly():
    found = fit_squares(growth, growth(np.array([0.3, -1.2]))[0], np.zeros(2), **BOX)
    np.testing.assert_allclose(found.point, [0.3, -1.2], rtol=1e-9)
    assert np.all(found.confidence.half_width < 1e-6)
    assert found.settled


def test_a_line_has_the_standard_errors_of_every_textbook():
    measured = 2 + 3 * X + np.random.default_rng(1).normal(scale=0.1, size=X.shape)
    _, residuals, slopes = solved(measured)
    found = confidence(residuals, slopes)
    known = linregress(X, measured)
    expected = [known.intercept_stderr, known.stderr]
    np.testing.assert_allclose(found.standard_error, expected, rtol=1e-10)
    reach = student.ppf(0.975, len(X) - 2)
    np.testing.assert_allclose(found.half_width, reach * found.standard_error, rtol=1e-12)
    mean, mean_square = X.mean(), np.mean(X**2)
    assert found.correlation[0, 1] == pytest.approx(-mean / np.sqrt(mean_square), rel=1e-10)


@pytest.mark.parametrize("known", [False, True])
def test_the_interval_holds_the_true_number_in_95_of_100_cases(known):
    truth, trials, random = np.array([2.0, 3.0]), 1000, np.random.default_rng(7)
    held = np.zeros(2)
    for _ in range(trials):
        measured = LINE @ truth + random.normal(scale=0.2, size=X.shape)
        best, residuals, slopes = solved(measured, 0.2 if known else 1.0)
        found = confidence(residuals, slopes, known=known)
        held += np.abs(best - truth) <= found.half_width
    share, chance = held / trials, np.sqrt(0.95 * 0.05 / trials)
    print(f"known deviations {known}: {share}")
    assert np.all(share > 0.95 - 3 * chance)
    assert np.all(share < 0.95 + 3 * chance)


def test_it_also_does_with_deviations_found_from_the_residuals_of_unlike_results():
    """A thousand newtonmetres to 1 % beside an efficiency to 0.1 %, both lines of the same."""
    size, noise = np.array([1000.0, 1.0]), np.array([10.0, 0.001])
    slopes = np.concatenate([size[0] * LINE, size[1] * LINE])
    group = np.repeat([0, 1], len(X))
    truth, random, trials = np.array([1.0, 0.5]), np.random.default_rng(3), 200
    held = np.zeros(2)
    for _ in range(trials):
        measured = slopes @ truth + random.normal(size=len(group)) * noise[group]
        found = fit_squares(
            lambda p: (slopes @ p, slopes), measured, np.ones(2), **BOX, group=group
        )
        held += np.abs(found.point - truth) <= found.confidence.half_width
    ratio = found.deviation[0] / found.deviation[-1]
    assert 0.4 < ratio / (noise[0] / noise[1]) < 2.5
    print(f"held {held / trials}")
    assert np.all(held / trials > 0.95 - 3.5 * np.sqrt(0.95 * 0.05 / trials))


@pytest.mark.parametrize("times", [4, 9, 100])
def test_the_interval_shrinks_as_the_root_of_the_number_of_values(times):
    _, residuals, slopes = solved(2 + X + 0.5 * np.sin(40 * X))
    once = confidence(residuals, slopes, known=True)
    often = confidence(np.tile(residuals, times), np.tile(slopes, (times, 1)), known=True)
    assert once.scatter < 1
    np.testing.assert_allclose(
        once.standard_error / often.standard_error, np.sqrt(times), rtol=1e-12
    )


def test_known_deviations_that_are_too_small_are_enlarged():
    _, residuals, slopes = solved(2 + X + 0.5 * np.sin(40 * X), 0.01)
    small = confidence(residuals, slopes, known=True)
    assert small.scatter > 10
    own = confidence(residuals, slopes)
    np.testing.assert_array_equal(small.half_width, own.half_width)


def test_two_values_of_known_deviation_have_the_interval_of_their_mean():
    """A normal's, as their weights are known: 1.96 of s over root two, not Student's 12.7."""
    residuals, slopes = np.array([0.6, -0.6]), np.ones((2, 1)) / 0.3
    found = confidence(residuals, slopes, known=True)
    np.testing.assert_allclose(found.half_width, 1.959963985 * 0.3 / np.sqrt(2), rtol=1e-9)
    unknown = confidence(residuals, slopes)
    np.testing.assert_allclose(unknown.half_width, 12.7062047 * 0.6 * np.sqrt(2) * 0.3 / np.sqrt(2))


def test_deviations_known_of_one_result_stay_where_another_has_none():
    """Equal weights: the residuals of the values without one do not shrink the others'."""
    slopes = np.ones((8, 1))
    residuals = np.array([0.1, -0.1, 0.1, -0.1, 1.1, -1.1, 1.1, -1.1])
    found = confidence(residuals, slopes, known=np.arange(8) < 4)
    np.testing.assert_allclose(found.standard_error, 1 / np.sqrt(8), rtol=1e-12)


def test_residuals_follow_nothing_that_has_one_value_and_ties_have_no_order():
    residuals, chance = np.sin(np.linspace(0, 6, 40)), np.random.default_rng(5)
    assert drift(residuals) > 3  # in the order in which they were taken
    assert drift(residuals, np.full(40, 20.0)) == 0
    assert drift(residuals, 20 + 0.1 * chance.normal(size=40)) == 0  # one setting of a bench
    assert abs(drift(residuals, np.tile([20.0, 60.0, 120.0, 200.0], 10))) < 2
    curve = np.tile([1.0, -1.0, -1.0, 1.0], 10) + 0.1 * chance.normal(size=40)
    assert drift(curve, np.tile([20.0, 60.0, 120.0, 200.0], 10)) > 3
    shuffled = chance.permutation(40)
    along = np.tile([20.0, 60.0, 120.0, 200.0], 10)
    assert drift(curve[shuffled], along[shuffled]) == pytest.approx(drift(curve, along))


def test_two_numbers_of_which_only_the_sum_counts_are_tangled_and_have_no_interval():
    slopes = np.stack([np.ones_like(X), X, 2 * X], axis=1)
    found = confidence(np.sin(9 * X), slopes)
    assert found.tangled == ((1, 2),)
    assert np.isfinite(found.half_width[0])
    assert np.all(np.isinf(found.half_width[1:]))
    assert found.correlation[1, 2] == pytest.approx(-1, abs=1e-9)


def test_three_that_only_together_are_tangled_are_named_together():
    """No two of them correlate; any two tell the third."""
    random = np.random.default_rng(2)
    one, two = random.normal(size=(2, 40))
    third = one + two + 1e-3 * random.normal(size=40)
    found = confidence(random.normal(size=40), np.stack([one, two, third], axis=1))
    assert found.tangled == ((0, 1, 2),)


def test_a_number_that_changes_nothing_is_not_determined_and_hurts_no_other():
    slopes = np.stack([np.ones_like(X), X, np.zeros_like(X)], axis=1)
    found = confidence(np.sin(9 * X), slopes)
    alone = confidence(np.sin(9 * X)[:], slopes[:, :2])
    assert np.isinf(found.half_width[2])
    assert found.tangled == ()
    freedom = (len(X) - 2) / (len(X) - 3)
    np.testing.assert_allclose(
        found.standard_error[:2], alone.standard_error * np.sqrt(freedom), rtol=1e-12
    )


def test_of_tangled_numbers_the_one_in_front_is_taken():
    slopes = 10 * np.stack([np.ones_like(X), X, X, 1e-3 * X**2], axis=1)
    assert determined(slopes, widest=0.5).tolist() == [True, True, False, False]
    assert determined(slopes[:2], widest=0.5).sum() <= 1  # two values have no freedom left for two


def test_a_number_that_would_leave_its_box_stands_at_the_bound_without_interval():
    measured = 2 - X + 0.01 * np.sin(40 * X)
    found = fit_squares(line, measured, np.ones(2), np.array([-5.0, 0.0]), np.full(2, 5.0))
    assert found.free.tolist() == [True, False]
    assert found.point[1] == 0
    assert found.point[0] == pytest.approx(measured.mean(), rel=1e-6)


def test_points_where_the_model_has_no_values_are_gone_round():
    def broken(point):
        values, slopes = growth(point)
        return (values * np.nan if point[0] > 1 else values), slopes

    measured = growth(np.array([0.9, 0.5]))[0]
    found = fit_squares(broken, measured, np.array([-8.0, 0.0]), **BOX)
    np.testing.assert_allclose(found.point, [0.9, 0.5], rtol=1e-8)


def test_as_many_numbers_as_values_cannot_be_assessed():
    with pytest.raises(ValueError, match="2 values leave no freedom to determine 2 numbers"):
        confidence(np.zeros(2), LINE[:2])


def test_residuals_drift_when_a_curve_is_fitted_by_a_line_and_not_when_they_are_chance():
    random = np.random.default_rng(5)
    x = np.linspace(-1, 1, 30)
    assert drift(x**2 - np.mean(x**2)) > 4
    strays = [drift(random.normal(size=30)) for _ in range(300)]
    assert np.mean(np.array(strays) > 3) < 0.01
    assert abs(np.mean(strays)) < 0.2

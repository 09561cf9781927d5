"""All rises and falls of sampled curves, their turning points between samples or just at one."""

import itertools

import jax
import numpy as np
import pytest

from camring.numerics.extremum import total_variation
from camring.numerics.quantity import real

LEVELS = np.array([0.0, 1.0, 0.3, 0.9, -0.2])
ROUNDING = (0.0, 1e-17, -1e-17, 3e-16, -3e-16)


_travelled_by_slope = jax.jit(
    jax.vmap(jax.value_and_grad(total_variation, 1), in_axes=(0, 0, None))
)


@pytest.mark.parametrize("ends", [*itertools.product(ROUNDING, repeat=2)])
def test_a_curve_that_turns_at_its_samples_travels_what_they_are_apart(ends):
    """Slopes are zero there but for rounding, of either sign: a knot on a dead centre."""
    slopes = np.resize(ends, len(LEVELS))
    value, slope = LEVELS[:, None], slopes[:, None]
    travelled, by_value = jax.value_and_grad(total_variation)(real(value), real(slope), real([1.0]))
    assert float(travelled) == pytest.approx(np.sum(np.abs(np.diff(LEVELS))), rel=1e-12)
    rising = np.sign(np.diff(LEVELS))
    expected = np.append(0, rising) - np.append(rising, 0)
    np.testing.assert_allclose(by_value[:, 0], expected, atol=1e-9)


@pytest.mark.parametrize("rounding", ROUNDING)
def test_a_curve_that_runs_out_into_a_flat_travels_its_height(rounding):
    """`(1 - t)^3`, whose slope has a double root at the end: rounding leaves it none."""
    height = np.random.default_rng(7).uniform(1e-3, 1, 300)
    value = np.stack([0 * height, height], axis=1)[..., None]
    slope = np.stack([3 * height, rounding * height], axis=1)[..., None]
    found, by_slope = _travelled_by_slope(real(value), real(slope), real([1.0]))
    np.testing.assert_allclose(found, height, rtol=1e-12)
    assert np.all(np.isfinite(by_slope))


@pytest.mark.parametrize("rounding", ROUNDING)
@pytest.mark.parametrize("turning", [0.0, 1e-12, 0.1, 0.5, 0.9, 1 - 1e-12, 1.0])
def test_a_parabola_travels_to_its_vertex_and_back(turning, rounding):
    """However near an end it lies, where the cubic's other turning point is nowhere."""
    at = np.array([[0.0], [1.0]])
    value, slope = (at - turning) ** 2, 2 * (at - turning) + rounding
    expected = turning**2 + (1 - turning) ** 2
    found = total_variation(real(value), real(slope), real([1.0]))
    assert float(found) == pytest.approx(expected, rel=1e-12)

"""Functions that share a division or an exponential with their slopes: both are the plain ones'."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from camring.numerics.smooth import inverse, inverse_root, power, stiffening_decay
from camring.physics.oil.aerated_fluid import AeratedFluid

POSITIVE = np.array([1e-9, 0.3, 1.0, 7.0, 4e8])


def derivatives(function, *at):
    """Value, first and second derivatives by every number, forwards over forwards."""
    first = [jax.jacfwd(function, k) for k in range(len(at))]
    second = [jax.jacfwd(each, k) for each in first for k in range(len(at))]
    return np.array([float(each(*at)) for each in (function, *first, *second)])


@pytest.mark.parametrize("x", POSITIVE)
def test_a_reciprocal_and_that_of_a_root(x):
    np.testing.assert_allclose(derivatives(inverse, x), [1 / x, -(x**-2), 2 * x**-3], rtol=1e-14)
    expected = [x**-0.5, -0.5 * x**-1.5, 0.75 * x**-2.5]
    np.testing.assert_allclose(derivatives(inverse_root, x), expected, rtol=1e-14)


@pytest.mark.parametrize("x", POSITIVE[1:])
@pytest.mark.parametrize("exponent", [-1.0, -1 / 1.4, 0.0, 2.5])
def test_a_power(x, exponent):
    ours, plain = derivatives(power, x, exponent), derivatives(jnp.power, x, exponent)
    np.testing.assert_allclose(ours, plain, rtol=1e-12, atol=1e-15 * np.abs(plain).max())


@pytest.mark.parametrize("strain", [-0.02, 0.0, 0.05, 0.4])
@pytest.mark.parametrize("gain", [0.5, 4.0, 12.0])  # below, the plain formula loses digits
def test_a_liquid_that_stiffens(strain, gain):
    def plain(strain, gain):
        return (1 + gain * strain) ** (-1 / gain)

    ours, theirs = derivatives(stiffening_decay, strain, gain), derivatives(plain, strain, gain)
    np.testing.assert_allclose(ours, theirs, rtol=1e-9, atol=1e-12)


def test_a_liquid_that_does_not_stiffen_is_an_exponential():
    found = derivatives(stiffening_decay, 0.3, 0.0)
    # By the gain the exponent's own series: -strain + gain strain^2/2 - ...
    decay = np.exp(-0.3)
    np.testing.assert_allclose(found[:3], [decay, -decay, decay * 0.3**2 / 2], rtol=1e-14)


@pytest.mark.parametrize("air", [0.0, 1e-4, 0.02])
@pytest.mark.parametrize("pressure", [40.0, 1e5, 2e6, 3e7])
def test_the_pressure_of_a_state_is_its_inverse_whatever_changes(air, pressure):
    """`state(pressure(x)) = x` stays true along modulus, air and state: so do its derivatives."""
    oil = AeratedFluid(870.0, 1.4e9, 3e3, air_fraction=air)
    state = float(oil.state(pressure))
    assert float(oil.pressure(state)) == pytest.approx(pressure, rel=1e-12)

    def left(state, modulus, air):
        changed = replace(oil, bulk_modulus=modulus, air_fraction=air)
        return changed.state(changed.pressure(state)) - state

    numbers = state, 1.4e9, air
    scale = max(abs(state), 1e-12)
    for k, number in enumerate(numbers if air else numbers[:2]):
        slope = float(jax.grad(left, k)(*numbers)) * (number if k else scale)
        assert abs(slope) < 1e-9 * scale, k

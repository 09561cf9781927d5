"""The aerated oil against quadrature, its own limits, and the second solver."""

from itertools import pairwise

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from camring.physics.oil.aerated_fluid import AeratedFluid
from camring.physics.oil.fluid import ConstantFluid
from camring.reference.laws import OilLaw
from camring.reference.parts import Oil

P0 = 101325.0
PRESSURES = np.array([200.0, 2e3, 5e4, P0, 3e5, 1e6, 2.9e6, 3.1e6, 1e7, 4e8])


def oil(**changes):
    given = {"density": 870.0, "bulk_modulus": 1.4e9, "vapour_pressure": 3e3, "viscosity": 46e-6}
    return AeratedFluid(**(given | changes))


OILS = (
    oil(),
    oil(polytropic_index=1.4, modulus_gain=9.0),
    oil(polytropic_index=0.8),
    oil(air_fraction=0.2, modulus_gain=1.0),
    oil(air_fraction=1e-4, dissolution_pressure=3e7, modulus_gain=1e-3),
)


def independent(fluid):
    names = Oil.__dataclass_fields__.keys() - {"law"}
    given = {name: getattr(fluid, name) for name in names}
    numbers = {name: float(value) for name, value in given.items() if value is not None}
    return OilLaw(Oil(**numbers, law="aerated"))


@pytest.mark.parametrize("fluid", OILS)
def test_density_and_stiffness_are_those_of_the_second_solver(fluid):
    second = independent(fluid)
    at = fluid.at(jnp.asarray(PRESSURES))
    for k, pressure in enumerate(PRESSURES):
        assert float(at.density[k]) == pytest.approx(second.density(pressure), rel=1e-12)
        assert float(at.content_slope[k]) == pytest.approx(
            second.density_slope(pressure), rel=1e-12
        )


@pytest.mark.parametrize("fluid", OILS)
def test_the_slope_is_the_derivative_of_the_density(fluid):
    slope = jax.vmap(jax.grad(fluid.density_at))(jnp.asarray(PRESSURES))
    np.testing.assert_allclose(fluid.at(jnp.asarray(PRESSURES)).content_slope, slope, rtol=1e-9)
    modulus = fluid.bulk_modulus_at(jnp.asarray(PRESSURES))
    np.testing.assert_allclose(modulus, fluid.density_at(jnp.asarray(PRESSURES)) / slope, rtol=1e-9)


@pytest.mark.parametrize("fluid", OILS)
def test_the_potential_is_the_integral_of_volume_over_pressure(fluid):
    second = independent(fluid)
    corners = sorted({P0, float(fluid.dissolution_pressure)})
    for pressure in PRESSURES:
        inside = [p for p in corners if min(P0, pressure) < p < max(P0, pressure)]
        ends = [P0, *(inside if pressure > P0 else inside[::-1]), pressure]
        expected = sum(
            quad(
                lambda u: np.exp(u) / second.density(np.exp(u)),
                np.log(a),
                np.log(b),
                epsabs=0,
                epsrel=1e-13,
                limit=200,
            )[0]
            for a, b in pairwise(ends)
        )
        found = float(fluid.potential(jnp.asarray(pressure)))
        assert found == pytest.approx(expected, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("fluid", OILS)
def test_the_potential_rises_by_one_over_density(fluid):
    rise = jax.vmap(jax.grad(fluid.potential))(jnp.asarray(PRESSURES))
    np.testing.assert_allclose(rise * fluid.density_at(jnp.asarray(PRESSURES)), 1, rtol=1e-11)


@settings(max_examples=30)
@given(pressure=st.floats(1.0, 1e9), air=st.floats(1e-6, 0.3))
def test_state_and_pressure_are_inverse_and_pressure_is_positive(pressure, air):
    fluid = oil(air_fraction=air)
    state = fluid.state(jnp.asarray(pressure))
    # Where air is compressed to nothing the state is dominated by the liquid's strain.
    assert float(fluid.pressure(state)) == pytest.approx(pressure, rel=1e-9)
    assert float(fluid.pressure(state - 10.0)) > 0
    slope = jax.grad(fluid.state)(jnp.asarray(pressure))
    assert float(fluid.state_slope(jnp.asarray(pressure))) == pytest.approx(float(slope), rel=1e-12)


@pytest.mark.parametrize("gain", [0.0, 1e-12, 1e-8, 1e-5])
def test_a_vanishing_gain_is_no_gain(gain):
    pressure = jnp.asarray(PRESSURES)
    bent, straight = oil(modulus_gain=gain), oil()
    tolerance = 1e-12 + gain * 0.3
    np.testing.assert_allclose(bent.density_at(pressure), straight.density_at(pressure), tolerance)
    np.testing.assert_allclose(bent.potential(pressure), straight.potential(pressure), tolerance)


def test_air_that_stays_as_warm_has_an_index_of_one():
    pressure = jnp.asarray(PRESSURES)
    given, left_out = oil(polytropic_index=1.0), oil()
    for law in ("density_at", "bulk_modulus_at", "potential"):
        expected = getattr(given, law)(pressure)
        np.testing.assert_allclose(getattr(left_out, law)(pressure), expected, 1e-13, 1e-12)


def test_a_vanishing_gain_still_has_a_derivative():
    def density(gain):
        return oil(modulus_gain=gain).density_at(jnp.asarray(1e8))

    slope = float(jax.grad(density)(0.0))
    small = 1e-4
    assert slope == pytest.approx(float((density(small) - density(-small)) / (2 * small)), rel=1e-5)


def test_the_bulk_modulus_rises_with_pressure_by_the_gain():
    fluid = oil(modulus_gain=9.0)
    modulus = fluid.bulk_modulus_at(jnp.asarray([4e6, 3e7]))
    assert float((modulus[1] - modulus[0]) / 2.6e7) == pytest.approx(9.0, rel=1e-9)


def test_air_softens_the_oil_below_dissolution_only():
    soft, plain = oil(air_fraction=0.02), oil(air_fraction=0.0)
    modulus = soft.bulk_modulus_at(jnp.asarray([2e5, 1e6, 5e6]))
    assert float(modulus[0]) < 0.02 * 1.4e9
    assert float(modulus[1]) < 0.7 * 1.4e9
    assert float(modulus[2]) == pytest.approx(1.4e9, rel=1e-9)
    np.testing.assert_allclose(plain.bulk_modulus_at(jnp.asarray([2e5, 5e6])), 1.4e9, rtol=1e-12)


def test_without_air_the_law_is_that_of_the_constant_one_for_small_strains():
    aerated, constant = oil(air_fraction=0.0), ConstantFluid(870.0, 1.4e9, 3e3)
    pressure = jnp.asarray([-2e7, 1e5, 3e7])
    assert float(aerated.state(jnp.asarray(1e6))) == pytest.approx(1e6 / 1.4e9)
    at, plain = aerated.at(pressure), constant.at(pressure)
    # Content is a mass for one and a volume for the other: their relative slopes agree.
    np.testing.assert_allclose(at.content_slope / at.content, plain.content_slope, rtol=1e-12)
    np.testing.assert_allclose(at.density, plain.density, rtol=0.025)
    np.testing.assert_allclose(aerated.pressure(aerated.state(pressure)), pressure, rtol=1e-12)

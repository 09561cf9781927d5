"""Orifice, gap, contact friction and named oils against formulas one can check by hand."""

from math import pi

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from camring.geometry.material import Material
from camring.geometry.piston import Piston, Roller
from camring.numerics.spline import Jet
from camring.physics.friction import SlidingContacts, ViscousFriction
from camring.physics.gap import PistonGap
from camring.physics.oil.fluid import ConstantFluid
from camring.physics.oil.presets import OILS, ZERO_CELSIUS, oil_data, walther_viscosity
from camring.physics.orifice import LaminarTurbulentOrifice, TurbulentOrifice

OIL = ConstantFluid(870.0, 1.4e9, 3e3, viscosity=46e-6)
AREA = 6e-5
PISTON = Piston(0.036, 0.5)


def flow(drop, critical=1000.0, area=AREA):
    law = LaminarTurbulentOrifice(0.65, critical)
    return law(jnp.asarray(area), jnp.asarray(drop), OIL.density, OIL)


def test_a_large_flow_number_makes_the_orifice_turbulent():
    sharp = ConstantFluid(870.0, 1.4e9, 3e3, 1e-3, viscosity=46e-6)
    torricelli = TurbulentOrifice(0.65)(jnp.asarray(AREA), jnp.asarray(2e5), OIL.density, sharp)
    assert float(flow(2e5, 1.0)) == pytest.approx(float(torricelli), rel=1e-12)


def test_a_small_flow_number_makes_it_laminar():
    """Q = Cd (2/lam_c) sqrt(4 A/pi)/viscosity A 2 x/density."""
    slope = 0.65 * AREA * 2 / 1e6 * np.sqrt(4 * AREA / pi) / 46e-6 * 2 / 870.0
    for drop in (1.0, -30.0):
        assert float(flow(drop, 1e6)) == pytest.approx(slope * drop, rel=1e-6)


def test_flow_follows_the_formula_and_the_sign_of_the_drop():
    for drop in (50.0, 4e3, 6e5):
        number = np.sqrt(4 * AREA / pi) / 46e-6 * np.sqrt(2 * drop / 870.0)
        expected = 0.65 * np.tanh(2 * number / 1000) * AREA * np.sqrt(2 * drop / 870.0)
        assert float(flow(drop)) == pytest.approx(expected, rel=1e-12)
        assert float(flow(-drop)) == pytest.approx(-expected, rel=1e-12)


@pytest.mark.parametrize(("drop", "area"), [(0.0, AREA), (1e5, 0.0), (0.0, 0.0)])
def test_every_derivative_of_the_flow_is_finite(drop, area):
    slopes = jax.grad(lambda d, a: flow(d, area=a), argnums=(0, 1))(drop, area)
    assert np.all(np.isfinite(slopes))


def test_the_gap_leaks_and_holds_back_as_a_plane_slit_does():
    mu = 870.0 * 46e-6
    centred, aside = PistonGap(15e-6, 0.03), PistonGap(15e-6, 0.03, 1.0)
    slit = pi * 0.036 * (15e-6) ** 3 / (12 * mu * 0.03)
    assert float(centred.leakage_conductance(PISTON, OIL)) == pytest.approx(slit, rel=1e-12)
    assert float(aside.leakage_conductance(PISTON, OIL)) == pytest.approx(2.5 * slit, rel=1e-12)
    shear = mu * pi * 0.036 * 0.03 / 15e-6
    assert float(centred.film_damping(PISTON, OIL)) == pytest.approx(shear, rel=1e-12)


def rubbing(radius, force, roller, speed=2.0):
    """A piston pressed on the cam, its normal force taken for its radial one."""
    force = jnp.asarray(force)
    return SlidingContacts(radius, force, force, roller, jnp.asarray(speed))


def test_a_law_sees_how_fast_roller_and_piston_slide():
    """On a round ring the roller's surface is as fast as the ring is long for each radian."""
    roller = Roller(0.016, 0.036, Material(2.1e11, 0.3))
    round_ring = Jet(*(jnp.asarray(x) for x in (0.18, 0.0, 0.0, 0.0)))
    assert float(rubbing(round_ring, 1e4, roller).roller_speed) == pytest.approx(2 * 0.196)
    falling = Jet(*(jnp.asarray(x) for x in (0.18, -0.03, 0.01, 0.0)))
    assert float(rubbing(falling, 1e4, roller).piston_speed) == pytest.approx(2 * 0.03)
    still = rubbing(falling, 1e4, roller, speed=0.0)
    assert float(still.roller_speed) == float(still.piston_speed) == 0
    lost = ViscousFriction(0.0, 0.013, 0.1).loss_torque(still, PISTON, OIL)
    assert float(lost) > 0  # coefficients without speed hold at standstill


def test_a_roller_on_a_round_ring_loses_its_friction_times_the_rings_radius():
    roller = Roller(0.016, 0.036, Material(2.1e11, 0.3))
    radius = Jet(*(jnp.asarray(x) for x in (0.18, 0.0, 0.0, 0.0)))
    law = ViscousFriction(80.0, 0.013, 0.2)
    lost = law.loss_torque(rubbing(radius, 2e4, roller), PISTON, OIL)
    assert float(lost) == pytest.approx(0.013 * 2e4 * (0.18 + 0.016), rel=1e-12)


def test_contacts_rub_only_while_pressed_and_always_against_the_motion():
    roller = Roller(0.016, 0.036, Material(2.1e11, 0.3))
    radius = Jet(*(jnp.asarray(x) for x in (0.18, 0.03, 0.01, 0.0)))
    rolling, sliding = ViscousFriction(0.0, 0.01), ViscousFriction(0.0, 0.0, 0.1)
    off, on = rubbing(radius, -5e3, roller), rubbing(radius, 5e3, roller)
    assert float(rolling.loss_torque(off, PISTON, OIL)) == 0
    assert float(rolling.loss_torque(on, PISTON, OIL)) > 0
    side = 0.1 * 5e3 * 0.03 / 0.18 * 0.03
    for contacts in (off, on):
        lost = float(sliding.loss_torque(contacts, PISTON, OIL))
        assert lost == pytest.approx(side, rel=1e-12)


@pytest.mark.parametrize(
    ("name", "grade"), [("ISO VG 32", 32), ("ISO VG 46", 46), ("ISO VG 68", 68)]
)
def test_a_grade_is_its_viscosity_at_40_degrees(name, grade):
    assert oil_data(name, ZERO_CELSIUS + 40).viscosity == pytest.approx(grade * 1e-6, rel=1e-12)


def test_walthers_equation_meets_its_points_and_falls_between():
    at = [walther_viscosity(ZERO_CELSIUS + t, 46, 6.8) for t in (20, 40, 60, 100)]
    assert at[1] == pytest.approx(46, rel=1e-12)
    assert at[3] == pytest.approx(6.8, rel=1e-12)
    assert at == sorted(at, reverse=True)
    assert 100 < at[0] < 140  # data sheets of VG 46 oils give 105 to 130 mm2/s at 20 C
    assert 19 < at[2] < 22


@pytest.mark.parametrize("name", OILS)
def test_every_oil_is_a_plausible_fluid_over_its_range(name):
    for celsius in (-20, 20, 50, 110):
        data = oil_data(name, ZERO_CELSIUS + celsius)
        assert 780 < data.density < 1120
        assert 0.9e9 < data.bulk_modulus < 4e9
        assert 0 <= data.vapour_pressure < 1.3e5
        assert 1e-6 < data.viscosity < 1e-2

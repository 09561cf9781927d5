"""What each law owes, asked of every final class of every kind: a new law is asked at once.

Numbers for a law come from its own fields: the example of its key in the motor file.
"""

import dataclasses
import typing

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from unit_systems import UnitSystem, unit_of

from camring.files.motor.entries import Numbers
from camring.files.motor.laws import SLOTS, law_keys, laws_of
from camring.geometry.material import Material
from camring.geometry.piston import Piston, Roller
from camring.geometry.window import AbstractWindow, TabulatedWindow
from camring.numerics.quantity import real
from camring.numerics.spline import Jet
from camring.physics.friction import AbstractFriction, SlidingContacts
from camring.physics.leakage import AbstractLeakage, LeakageEnds
from camring.physics.oil.fluid import AbstractFluid, ConstantFluid
from camring.physics.orifice import AbstractOrifice

OIL = ConstantFluid(870.0, 1.4e9, 3e3, viscosity=46e-6)
PISTON = Piston(0.036, 0.5)
ROLLER = Roller(0.016, 0.036, Material(2.1e11, 0.3))
PRESSURE = real(np.array([0.4e5, 1.5e5, 9e5, 2.1e7, 3.5e7]))
CASE = real(2e5)
WIDTH = real(0.5)
OURS = UnitSystem(1.0, 1.0, 1.0)
ABROAD = UnitSystem(3.2808, 0.0685, 1000.0)

# Where an example for one number makes no sensible list.
LISTS = {
    "position": [-1.0, -0.6, 0.5, 1.0],
    "opening_share": [0.0, 1.0, 1.0, 0.0],
}


def an_example(slot, law):
    """The law with the numbers that its keys' examples name."""
    numbers = {}
    for name, (_, entry, _) in law_keys(slot, law).items():
        if isinstance(entry, Numbers):
            numbers[name] = np.array(LISTS[name])
        else:
            text = entry.example
            numbers[name] = entry.read(text.strip('"') if '"' in text else float(text))
    return law(**numbers)


ALL = [an_example(slot, law) for slot in SLOTS for law in laws_of(slot).values()]


def of(parent):
    """A test of every law of a kind."""
    chosen = [law for law in ALL if isinstance(law, parent)]
    assert chosen
    return pytest.mark.parametrize("law", chosen, ids=lambda law: type(law).__name__)


def contacts(unit=OURS):
    """A piston on its way out, one at rest and one that has lifted off."""
    m, newton = unit.factor("m"), unit.factor("N")
    radius = Jet(
        real(np.full(3, 0.18)) * m,
        real(np.array([0.03, 0.0, -0.02])) * m,
        real(np.array([0.01, -0.05, 0.02])) * m,
        real(np.zeros(3)) * m,
    )
    force = real(np.array([2e4, 1e4, -5e3])) * newton
    roller = unit.convert(ROLLER)
    return SlidingContacts(radius, force, 1.02 * force, roller, real(20.0) * unit.factor("rad/s"))


def answers(law, unit=OURS):
    """Everything a law says of the same machine in some units: name -> (value, its unit)."""
    pascal, metre = unit.factor("Pa"), unit.factor("m")
    oil, piston, pressure = unit.convert(OIL), unit.convert(PISTON), PRESSURE * pascal
    match law:
        case AbstractFluid():
            volume, rate = 1e-5 * metre**3, 1e9 * unit.factor("Pa/s")
            asked = {
                "density_at": (pressure,),
                "bulk_modulus_at": (pressure,),
                "compression_power": (pressure, CASE * pascal, volume, rate),
            }
        case AbstractOrifice():
            drop, area = (pressure - 5e5 * pascal), real(6e-5) * metre**2
            asked = {"__call__": (area, drop, oil.density, oil)}
        case AbstractWindow():
            asked = {"opening": (jnp.linspace(-0.3, 0.3, 41), WIDTH), "edges": (WIDTH,)}
        case AbstractLeakage():
            asked = {"flow": (LeakageEnds(pressure, CASE * pascal), piston, oil)}
        case AbstractFriction():
            asked = {
                "viscous_damping": (piston, oil),
                "loss_torque": (contacts(unit), piston, oil),
            }
    found = {}
    for name, arguments in asked.items():
        method = getattr(law, name)
        returned = typing.get_type_hints(getattr(type(law), name), include_extras=True)["return"]
        found[name] = method(*arguments), unit_of(returned)
    return found


@pytest.mark.parametrize("law", ALL, ids=lambda law: type(law).__name__)
def test_a_law_does_not_care_which_metre_we_use(law):
    abroad = answers(ABROAD.convert(law), ABROAD)
    for name, (here, unit) in answers(law).items():
        assert unit, f"{name} says no unit"
        np.testing.assert_allclose(abroad[name][0], here * ABROAD.factor(unit), rtol=1e-11)


@jax.jit
def values(law):
    """What a law says, without units; one compilation a law."""
    return {name: value for name, (value, _) in answers(law).items()}


def scaled(law, by):
    """The law with its numbers a little larger; opening tables have the same ends."""
    if isinstance(law, TabulatedWindow):
        return TabulatedWindow(law.position, law.opening_share * np.minimum(by, 1.0))
    return jax.tree.map(lambda leaf: leaf * by, law)


@pytest.mark.parametrize("law", ALL, ids=lambda law: type(law).__name__)
def test_a_batch_of_laws_answers_as_each_of_them_does(law):
    some = [scaled(law, by) for by in (0.99, 1.0, 1.01)]
    batch = jax.tree.map(lambda *leaves: jnp.stack(leaves), *some)
    together = jax.vmap(values)(batch)
    for place, one in enumerate(some):
        for name, value in values(one).items():
            np.testing.assert_allclose(together[name][place], value, rtol=1e-12, err_msg=name)


@pytest.mark.parametrize("law", ALL, ids=lambda law: type(law).__name__)
def test_slopes_by_a_laws_own_numbers_are_differences(law):
    along = jax.jit(lambda law, change: jax.jvp(values, (law,), (change,))[1])
    for field in dataclasses.fields(law):
        if getattr(law, field.name) is None:  # a part that it does without
            continue
        value = np.asarray(getattr(law, field.name))
        if value.ndim:  # a table's knots: at a knot there is no one slope
            continue
        step = 1e-6 * (float(value) or 1.0)
        nothing = jax.tree.map(jnp.zeros_like, law)
        change = eqx.tree_at(lambda one, name=field.name: getattr(one, name), nothing, real(1.0))
        above, below = (
            values(jax.tree.map(lambda a, b, by=by: a + by * b, law, change))
            for by in (step, -step)
        )
        for name, slope in along(law, change).items():
            difference = (np.asarray(above[name]) - np.asarray(below[name])) / (2 * step)
            rounding = 1e-15 * float(np.max(np.abs(above[name]))) / step
            near = 1e-5 * float(np.max(np.abs(difference))) + 4 * rounding
            words = f"{field.name}, {name}"
            np.testing.assert_allclose(slope, difference, atol=near, err_msg=words)


@of(AbstractFluid)
def test_no_energy_is_lost_or_made_in_a_chamber_of_oil(law):
    """What flows bring is work and compression, whichever way pressure and volume go round.

    `[h c' V - K/P'] dP + [h c - P] dV` is exact, `h` above the return's: so the power balance
    closes for any motor filled with this oil.
    """
    back = real(5e5)

    def slopes(pressure):
        above = lambda at: law.potential(at) - law.potential(back)  # noqa: E731
        h, h_slope = jax.jvp(above, (pressure,), (jnp.ones_like(pressure),))
        c, c_slope = jax.jvp(law.content, (pressure,), (jnp.ones_like(pressure),))
        compressed = law.compression_power(pressure, back, real(1.0), real(1.0))
        by_pressure = h * law.at(pressure).content_slope - compressed
        return by_pressure, h_slope * c + h * c_slope - 1

    by_pressure, by_volume = slopes(PRESSURE)
    np.testing.assert_allclose(by_pressure, by_volume, atol=1e-9)


@of(AbstractFluid)
def test_the_state_of_an_oil_is_its_pressure(law):
    np.testing.assert_allclose(law.pressure(law.state(PRESSURE)), PRESSURE, rtol=1e-9)
    _, slope = jax.jvp(law.state, (PRESSURE,), (jnp.ones_like(PRESSURE),))
    np.testing.assert_allclose(law.state_slope(PRESSURE), slope, rtol=1e-9)
    assert np.all(np.asarray(law.bulk_modulus_at(PRESSURE)) > 0)
    assert np.all(np.diff(law.density_at(PRESSURE)) >= 0)


@of(AbstractOrifice)
def test_oil_flows_down_the_pressure_and_through_what_is_open(law):
    drop = real(np.array([-3e6, -40.0, 0.0, 40.0, 3e6]))
    area = real(6e-5)
    flow = np.asarray(law(area, drop, OIL.density, OIL))
    np.testing.assert_allclose(flow, -flow[::-1], rtol=1e-12)
    assert np.all(np.diff(flow) > 0)
    assert np.all(np.asarray(law(real(0.0), drop, OIL.density, OIL)) == 0)
    torricelli = float(law.gain(area, OIL)) * 1e6
    assert float(law(area, real(1e12), OIL.density, OIL)) == pytest.approx(torricelli, rel=1e-6)


@of(AbstractWindow)
def test_a_window_is_shut_outside_and_open_to_what_it_says(law):
    share = np.asarray(law.opening(jnp.linspace(-0.4, 0.4, 801), WIDTH))
    assert share.min() == 0
    assert share.max() <= 1
    outside = np.abs(np.linspace(-0.4, 0.4, 801)) >= float(WIDTH) / 2 + 1e-12
    assert np.all(share[outside] == 0)
    assert np.all(np.abs(law.edges(WIDTH)) <= float(WIDTH) / 2 + 1e-12)
    for wanted in (0.1, 0.5, 0.9):
        at = law.opens_to(real(wanted), WIDTH)
        assert float(law.opening(at, WIDTH)) == pytest.approx(wanted, rel=1e-9)


@of(AbstractLeakage)
def test_oil_leaks_out_of_higher_pressure_and_the_more_the_higher(law):
    flow = np.asarray(law.flow(LeakageEnds(PRESSURE, CASE), PISTON, OIL))
    assert np.all(flow * np.asarray(PRESSURE - CASE) >= 0)
    assert np.all(np.diff(flow) >= 0)
    assert float(law.flow(LeakageEnds(CASE, CASE), PISTON, OIL)) == 0


@of(AbstractFriction)
def test_friction_only_ever_takes_and_holds_at_standstill(law):
    assert float(law.viscous_damping(PISTON, OIL)) >= 0
    moving = contacts()
    for turning in (moving, moving._replace(shaft_speed=real(0.0))):
        lost = np.asarray(law.loss_torque(turning, PISTON, OIL))
        assert np.all(np.isfinite(lost))
        assert np.all(lost >= 0)
    unloaded = moving._replace(force=real(np.zeros(3)), normal_force=real(np.zeros(3)))
    assert np.all(np.asarray(law.loss_torque(unloaded, PISTON, OIL)) == 0)
    assert float(moving.ring_length[1]) == pytest.approx(0.196 + 0.05 / 0.18 * 0.016, rel=1e-9)


def test_every_kind_of_law_is_asked():
    kinds = {slot.parent for slot in SLOTS}
    assert kinds == {
        AbstractFluid,
        AbstractOrifice,
        AbstractWindow,
        AbstractLeakage,
        AbstractFriction,
    }

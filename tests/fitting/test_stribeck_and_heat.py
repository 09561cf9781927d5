"""Friction at rest, the speed at which it falls off, and heat transfer, from rows made by them."""

import numpy as np
import pytest
from motor_files import added, without_table

from camring.files.motor import parse_motor_file
from camring.fitting.fit import fit
from camring.fitting.fitted_numbers import numbers_named
from camring.fitting.measurements.table import parse_measured_table
from camring.fitting.simulated_rows import Bench

TRUTH = {
    "motor.roller.friction": 0.009,
    "motor.roller.static_friction": 0.035,
    "motor.roller.stribeck_speed": 0.08,
    "thermal.heat_transfer": 18.0,
}
SLOW = [(rpm, bar) for rpm in (5, 12, 30, 120, 300) for bar in (120, 250)]
FAST = [(rpm, bar) for rpm in (150, 190, 230, 270, 300) for bar in (120, 250)]
HEAD = (
    "shaft speed [rpm],supply pressure [bar],mean torque [Nm],supply flow [L/min],"
    "case temperature rise [K]"
)


def text():
    """Constants as an engineer would guess them before the bench has been asked."""
    warm = without_table("[fluid]") + '\n[fluid]\noil = "ISO VG 46"\ntemperature = "50 degC"\n'
    warm += '\n[thermal]\nambient_temperature = "20 degC"\nheat_transfer = "12 W/K"\n'
    laws = 'friction = "stribeck"\nleakage = "viscous"\nreference_viscosity = "32 mm^2/s"'
    laws += "\nside_friction = 0.02\nside_static_friction = 0.05\nside_stribeck_speed = 0.05"
    warm = added("[motor]", laws, warm)
    own = "friction = 0.012\nstatic_friction = 0.025\nstribeck_speed = 0.12"
    return added("[motor.roller]", own, warm)


@pytest.fixture(scope="module")
def file():
    return parse_motor_file(text())


def table(places, values):
    torque, flow, rise = values
    rows = (
        f"{rpm},{bar},{float(t)!r},{6e4 * float(q)!r},{float(k)!r}"
        for (rpm, bar), t, q, k in zip(places, torque, flow, rise, strict=True)
    )
    return parse_measured_table("\n".join([HEAD, *rows]))


def rows_of(file, places, noise=0.0):
    """Made by the motor with the true constants, and noise of this share."""
    numbers = numbers_named(file, list(TRUTH))
    bench = Bench(file, table(places, np.ones((3, len(places)))), numbers)
    ratios = np.array([TRUTH[each.key] / each.scale for each in numbers])
    made = bench(np.where([each.by_logarithm for each in numbers], np.log(ratios), ratios))[0]
    chance = 1 + noise * np.random.default_rng(4).normal(size=made.shape)
    return table(places, (made * chance).reshape(3, -1))


def test_rows_down_to_five_revolutions_a_minute_give_back_all_four(file):
    found = fit(file, rows_of(file, SLOW), list(TRUTH))
    assert found.squares.settled
    for number, value in zip(found.numbers, found.values, strict=True):
        assert value == pytest.approx(TRUTH[number.key], rel=1e-3), number.key
    assert not found.tangled
    assert not any("lower speeds" in sentence for sentence in found.warnings)


def test_fast_rows_tell_heat_transfer_and_say_that_they_do_not_tell_friction_at_rest(file):
    found = fit(file, rows_of(file, FAST, 0.003), list(TRUTH))
    values = dict(zip((each.key for each in found.numbers), found.values, strict=True))
    for key in ("motor.roller.friction", "thermal.heat_transfer"):
        assert values[key] == pytest.approx(TRUTH[key], rel=0.05), key
    said = [each for each in found.warnings if "measure torque at lower speeds" in each]
    named = " ".join(said)
    assert "static_friction" in named
    assert "stribeck_speed" in named

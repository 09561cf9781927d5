"""The table [tolerances]: what it says, and the sentence for whatever it cannot mean."""

import math

import numpy as np
import pytest
from motor_files import SOUND, planar, ring

from camring.evaluation.built_motors import tolerances_of
from camring.files.errors import InputError
from camring.files.motor import parse_motor_file


def with_tolerances(lines, text=SOUND):
    return f"{text}\n[tolerances]\n{lines}\n"


def with_waves(lines, text=SOUND):
    return f"{text}\n[tolerances.waviness]\n{lines}\n"


def read(lines, text=SOUND):
    return parse_motor_file(with_tolerances(lines, text)).tolerances


def test_plus_or_minus_is_the_end_of_a_uniform_and_two_sigma_of_a_normal():
    found = read(
        '"motor.bore" = "±30 um"\n'
        '"motor.piston_mass" = { plus_minus = "10 g", distribution = "normal" }\n'
        '"fluid.bulk_modulus" = { relative = "10 %" }'
    )
    assert found.kinds == ("uniform", "normal", "uniform")
    sizes = [float(each.deviation) for each in found.deviations]
    assert sizes == pytest.approx([30e-6 / math.sqrt(3), 5e-3, 0.1 / math.sqrt(3)])
    assert [each.relative for each in found.deviations] == [False, False, True]
    assert found.wording == ("± 30 um, uniform", "± 10 g, normal", "± 10 %, uniform")


def test_quoted_paths_and_nested_tables_say_the_same():
    nested = read('motor.valve_plate.shift = "0.2 deg"')
    assert nested.names == read('"motor.valve_plate.shift" = "0.2 deg"').names


def test_several_numbers_may_deviate_alike():
    one = '{ plus_minus = "0.1 deg", together_with = ["motor.valve_plate.return_width"] }'
    (found,) = read(f'"motor.valve_plate.supply_width" = {one}').deviations
    assert found.leaves == ("motor.valve_plate.supply.width", "motor.valve_plate.return_.width")


def test_an_operating_point_deviates_at_every_operating_point():
    (found,) = read('"operating_points.speed" = { relative = "5 %" }').deviations
    assert found.leaves == tuple(f"operating_points.{k}.shaft_speed" for k in (0, 1))


def test_a_tolerance_is_a_difference_whatever_zero_its_unit_has():
    """Half a bar of scatter is half a bar on a gauge, too."""
    for unit in ("bar", "barg", "bar(a)"):
        (found,) = read(f'"operating_points.return_pressure" = "0.5 {unit}"').deviations
        assert float(found.deviation) == pytest.approx(0.5e5 / math.sqrt(3))


def test_a_case_pressure_that_is_not_given_follows_the_return_pressure():
    text = SOUND.replace('case_pressure = "2 bar"\n', "", 1)
    (found,) = read('"operating_points.return_pressure" = "1 bar"', text).deviations
    assert found.leaves == (
        "operating_points.0.return_pressure",
        "operating_points.0.case_pressure",
        "operating_points.1.return_pressure",
    )


@pytest.mark.parametrize(
    ("lines", "text", "unfold"),
    [
        ('6 = "2 um"\n"18" = "1 um"', SOUND, False),
        ('3 = "2 um"\n6 = "1 um"', SOUND, True),
        ('3 = "2 um"\n6 = "1 um"', ring(), False),
    ],
)
def test_waves_unfold_the_ring_only_where_lobes_cannot_carry_them(lines, text, unfold):
    found = parse_motor_file(with_waves(lines, text)).tolerances
    assert found.waviness.unfold == unfold
    assert found.kinds == ("phase", "phase")
    np.testing.assert_allclose(found.waviness.amplitudes, [2e-6, 1e-6])


def test_a_design_of_the_file_keeps_the_table():
    text = with_tolerances('"motor.valve_plate.shift" = "0.2 deg"')
    file = parse_motor_file(text)
    again = parse_motor_file(file.with_design(file.design_space.locate(file.system)))
    assert again.tolerances.wording == ("± 0.2 deg, uniform",)


FAULTS = {
    "misspelt path": ('"motor.valve_plate.shfit" = "1 deg"', ["motor.valve_plate.shift"]),
    "last part only": ('"shift" = "1 deg"', ['you probably meant "motor.valve_plate.shift"']),
    "nothing like it": ('"gearbox" = 1', ["is no number of the motor", "give a path"]),
    "misspelt operating point": ('"operating_points.sped" = "1 rpm"', ["operating_points.speed"]),
    "a count": ('"motor.pistons" = 1', ["is a count"]),
    "a list": ('"motor.cam.control_radii" = "1 um"', ["is a list", "[tolerances.waviness]"]),
    "a word": ('"motor.name" = 1', ["is not a number"]),
    "a limit": ('"constraints.max_pressure" = "1 bar"', ["is not a number of motor"]),
    "a weight": ('"operating_points.weight" = 0.1', ["is not a number of motor"]),
    "a part that is not there": ('"motor.gap.clearance" = "2 um"', ["does not have", "clearance"]),
    "a rule": ('"motor.cam.reference_radius" = "1 um"', ["is given as the rule", '"minimum"']),
    "another dimension": ('"motor.bore" = "1 deg"', ["motor.bore", "not a length"]),
    "a share of a length": ('"motor.bore" = "1 %"', ['{ relative = "1 %" }']),
    "negative": ('"motor.bore" = "-1 um"', ["zero or more"]),
    "no number": ('"motor.bore" = true', ["must be a number"]),
    "twice": (
        '"motor.bore" = "1 um"\n'
        '"motor.roller.radius" = { plus_minus = "1 um", together_with = ["motor.bore"] }',
        ["appears twice"],
    ),
    "both": ('"motor.bore" = { plus_minus = "1 um", relative = "1 %" }', ["either plus_minus or"]),
    "neither": ('"motor.bore" = { distribution = "normal" }', ["either plus_minus or relative"]),
    "misspelt option": ('"motor.bore" = { plus_minsu = "1 um" }', ["probably meant plus_minus"]),
    "misspelt distribution": (
        '"motor.bore" = { plus_minus = "1 um", distribution = "norml" }',
        ["did you mean 'normal'"],
    ),
    "company that is no list": (
        '"motor.bore" = { plus_minus = "1 um", together_with = "motor.bore" }',
        ["must be a list of paths"],
    ),
    "too wide for its number": ('"motor.dead_volume" = "7 cm^3"', ["beyond its limits"]),
    "too wide for the pitch": (
        '"motor.valve_plate.supply_width" = { plus_minus = "20 deg", distribution = "normal" }',
        ["motor.valve_plate.supply_width", "beyond its limits", 'write "uniform"'],
    ),
    "too large a share": ('"motor.bore" = { relative = "120 %" }', ["between 0 and 99 %"]),
    "nothing": ("", ["lets nothing scatter"]),
}


@pytest.mark.parametrize(("lines", "words"), FAULTS.values(), ids=FAULTS)
def test_faults_are_one_sentence(lines, words):
    with pytest.raises(InputError) as caught:
        parse_motor_file(with_tolerances(lines))
    assert "\n" not in str(caught.value)
    for each in words:
        assert each in str(caught.value), str(caught.value)


WAVES = {
    "no order": ('three = "2 um"', SOUND, ["waviness.three", "waves in a revolution"]),
    "no whole order": ('"2.5" = "2 um"', SOUND, ["2.5", "is no order"]),
    "order zero": ('0 = "2 um"', SOUND, ["is no order"]),
    "no length": ('3 = "2 deg"', SOUND, ["waviness.3", "not a length"]),
    "too high": ('3 = "2 mm"', SOUND, ["between 0 and 1 mm"]),
    "too fine": ('30 = "2 um"', SOUND, ["96 control radii", "up to 24"]),
    "planar": ('6 = "2 um"', planar(), ["radial cam"]),
    "nothing": ("", SOUND, ["amplitude by order"]),
}


@pytest.mark.parametrize(("lines", "text", "words"), WAVES.values(), ids=WAVES)
def test_waves_that_are_none_are_one_sentence(lines, text, words):
    with pytest.raises(InputError) as caught:
        parse_motor_file(with_waves(lines, text))
    for each in words:
        assert each in str(caught.value), str(caught.value)


def test_a_file_without_tolerances_learns_how_to_write_them():
    with pytest.raises(InputError, match=r"has no table \[tolerances\]; say what scatters"):
        tolerances_of(parse_motor_file(SOUND))

"""The table of an FMU covers the envelope, and tells what is unsound in it from what is outside."""

import motor_files
import numpy as np
import pytest

from camring.exchange.fmu.axes import BAR, RPM, Ranges, axes_of
from camring.exchange.fmu.places import Found
from camring.exchange.fmu.unsound import inside, unsound_places
from camring.files.motor import parse_motor_file

# The template's operating points lie within it; their return pressure is 10 bar, the case's 2.
LINES = 'speed = ["30 rpm", "320 rpm"]\nsupply_pressure = ["60 bar", "360 bar"]'


def with_envelope(*more):
    return parse_motor_file(motor_files.added("[envelope]", "\n".join((LINES, *more))))


def unsound(file, places, lifts):
    """What is said where rollers lift off at some places and the pressure is sound everywhere."""
    places = np.array(places) * [RPM, BAR, BAR]
    count = len(places)
    found = Found(
        np.ones((count, 4)), np.ones((count, 4, 8)), np.zeros(count, int), np.full(count, 5e5),
        np.where(lifts, -1.0, 1.0),
    )  # fmt: skip
    return unsound_places(file, places, found, 2e5)


def test_without_ranges_the_axes_are_the_envelope_s():
    file = with_envelope()
    found = axes_of(file, Ranges())
    np.testing.assert_allclose(found.speeds[[0, -1]] / RPM, [30, 320])
    np.testing.assert_allclose(np.diff(np.log(found.speeds), 2), 0, atol=1e-9)
    np.testing.assert_allclose(found.drops[[0, 1, -1]] / BAR, [0, 50, 350])
    np.testing.assert_allclose(found.lows / BAR, [8, 16])
    assert (len(found.speeds), len(found.drops)) == (13, 7)
    places = np.array([[w, d, found.lows[0]] for w in found.speeds for d in found.drops[1:]])
    assert inside(file.envelope, places, found.case_pressure).all()
    ranged = axes_of(with_envelope('return_pressure = ["8 bar", "20 bar"]'), Ranges())
    np.testing.assert_allclose(ranged.lows / BAR, [6, 18])
    np.testing.assert_allclose(ranged.drops[[1, -1]] / BAR, [40, 352])


def test_operating_points_beyond_the_envelope_are_covered_as_well():
    text = motor_files.added("[envelope]", LINES.replace("320", "100").replace("360", "200"))
    file = parse_motor_file(text)
    found = axes_of(file, Ranges())
    fastest = max(float(each.shaft_speed) for each in file.system.operating_points)
    most = max(float(each.pressure_drop) for each in file.system.operating_points)
    np.testing.assert_allclose([found.speeds[-1], found.drops[-1]], [fastest, most])


def test_a_range_asked_for_is_taken_whatever_the_envelope():
    found = axes_of(with_envelope(), Ranges(speed="10..160 rpm", pressure="100 bar, 300 bar"))
    np.testing.assert_allclose(found.speeds[[0, -1]] / RPM, [10, 160])
    np.testing.assert_allclose(found.drops / BAR, [0, 90, 290])


@pytest.mark.parametrize(
    ("place", "forward", "both"),
    [
        ((100, 200, 8), True, True),
        ((30, 50, 8), True, True),
        ((320, 350, 8), True, True),
        ((29, 200, 8), False, False),
        ((100, 351, 8), False, False),
        ((100, 49, 8), False, False),
        ((100, 200, 9), False, False),
        ((-100, -200, 8), False, True),
        ((100, -200, 8), False, False),
        ((-100, 200, 8), False, False),
    ],
)
def test_a_place_is_inside_where_the_motor_must_run(place, forward, both):
    for file, expected in (
        (with_envelope(), forward),
        (with_envelope('rotation = "both"'), both),
    ):
        asked = np.array([place]) * [RPM, BAR, BAR]
        assert inside(file.envelope, asked, 2e5)[0] == expected


PLACES = [(7.5, 60, 8), (7.5, 120, 8), (15, 60, 8), (15, 120, 8), (60, 60, 8), (60, 120, 8)]


def test_inside_and_outside_are_distinguished_with_the_values_of_the_axes():
    lifts = [True, False, True, False, True, False]
    [within, without] = unsound(with_envelope(), PLACES, lifts)
    assert within.startswith("Driving inside the envelope, the roller lifts off the ring")
    assert "at 1 of 2 points" in within
    assert within.endswith(": 60 rpm with pressure drops of 60 bar.")
    assert without.startswith("Driving outside the envelope, which the motor is not for")
    assert "at 2 of 4 points" in without
    assert without.endswith(": 7.5, 15 rpm with pressure drops of 60 bar.")


def test_a_motor_that_is_sound_in_its_envelope_hears_of_what_is_outside_only():
    lifts = [True, True, True, False, False, False]
    [said] = unsound(with_envelope(), PLACES, lifts)
    assert "outside the envelope" in said
    assert said.endswith(
        ": 7.5 rpm with pressure drops of 60, 120 bar; 15 rpm with pressure drops of 60 bar."
    )
    assert unsound(with_envelope(), PLACES, np.zeros(6, bool)) == []


def test_without_an_envelope_the_values_and_the_way_out_are_said():
    file = parse_motor_file(motor_files.SOUND)
    first, way_out = unsound(file, PLACES, [True] * 4 + [False] * 2)
    assert "at 4 of 6 points" in first
    assert "7.5, 15 rpm with pressure drops of 60, 120 bar" in first
    assert "with [envelope] in it" in way_out


def test_braking_is_never_inside():
    [said] = unsound(with_envelope('rotation = "both"'), [(60, -120, 8)], [True])
    assert said.startswith("Braking, the roller lifts off the ring")

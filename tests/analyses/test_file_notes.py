"""What a file may mean otherwise than its author did is said."""

import motor_files
import pytest
from typer.testing import CliRunner

from camring.analyses.file_notes import file_notes
from camring.cli.app import app
from camring.files.motor import parse_motor_file

SOUND = motor_files.SOUND
ENVELOPE = """
[envelope]
speed = {speed}
supply_pressure = ["{low} bar", "{high} bar"]
"""


def notes(speed='["50 rpm", "320 rpm"]', low=100, high=400, text=SOUND):
    return file_notes(parse_motor_file(text + ENVELOPE.format(speed=speed, low=low, high=high)))


def test_a_file_with_units_and_points_in_its_envelope_needs_no_note():
    assert notes() == []
    assert file_notes(parse_motor_file(SOUND)) == []


def test_an_envelope_speed_without_a_unit_is_named_in_both_units():
    first, *_ = notes("[30, 300]")
    assert first == (
        "envelope.speed has no unit and is read in rad/s: 30 is 286.5 rpm and 300 is 2865 rpm; "
        'write one, ["30 rpm", "300 rpm"].'
    )


def test_one_end_without_a_unit_is_named_alone():
    (only,) = notes('["50 rpm", 40]')
    assert "40 is 382 rpm" in only
    assert '["50 rpm", "40 rpm"]' in only


def test_a_speed_of_an_operating_point_without_a_unit_is_named_by_its_number():
    text = SOUND.replace('speed = "60 rpm"', "speed = 6.283185307179586")
    (only,) = file_notes(parse_motor_file(text))
    assert only.startswith("[[operating_points]] 2, speed = 6.28319 has no unit")
    assert "60 rpm" in only


@pytest.mark.parametrize(
    "beside",
    [{"speed": '["400 rpm", "500 rpm"]'}, {"low": 20, "high": 40}],
    ids=["speed", "pressure"],
)
def test_an_envelope_beside_all_operating_points_is_named(beside):
    (only,) = notes(**beside)
    assert only.startswith("No operating point lies in the [envelope]")


def test_check_says_it(tmp_path):
    path = tmp_path / "motor.toml"
    path.write_text(SOUND + ENVELOPE.format(speed='["400 rpm", "500 rpm"]', low=100, high=400))
    done = CliRunner().invoke(app, ["check", str(path)])
    assert "No operating point lies in the [envelope], 400 to 500 rpm" in " ".join(
        done.stdout.split()
    )

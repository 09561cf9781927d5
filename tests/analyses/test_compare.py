"""camring compare: motors side by side at one operating point, marked, with what differs."""

import json
from dataclasses import replace

import pytest
from motor_files import SOUND, with_line
from typer.testing import CliRunner

from camring.analyses.comparison import differing_inputs
from camring.analyses.simulation import simulated
from camring.cli.app import app
from camring.files.motor import parse_motor_file
from camring.files.quantities import QUANTITIES
from camring.presentation.comparison import BEST, WORST, marked
from camring.studies.study_folder import StudyFolder

RUN = CliRunner()
TURNED = with_line('shift = "-0.5 deg"', with_line('dead_volume = "8000 mm^3"'))


def run(*arguments):
    return RUN.invoke(app, ["compare", *(str(argument) for argument in arguments)])


@pytest.fixture(scope="module")
def motors(tmp_path_factory):
    place = tmp_path_factory.mktemp("motors")
    (place / "given.toml").write_text(SOUND)
    study = place / "study"
    StudyFolder.create(study, SOUND.encode(), {}).close()
    (study / "best.toml").write_text(TURNED)
    return place / "given.toml", study


def test_the_document_holds_each_motors_own_results(motors):
    done = run(*motors, "--json")
    assert done.exit_code == 0, done.output
    said = json.loads(done.stdout)
    assert [each["label"] for each in said["motors"]] == ["given", "study"]
    for each, text in zip(said["motors"], (SOUND, TURNED), strict=True):
        found = simulated(parse_motor_file(text), estimate=False).outcome
        for result, own in zip(each["results"], found.results, strict=True):
            assert result["torque_ripple"] == pytest.approx(own["torque_ripple"], rel=1e-9)
    assert said["differences"] == {
        "motor.dead_volume": ["6 cm^3", "8000 mm^3"],
        "motor.valve_plate.shift": ["0 deg", "-0.5 deg"],
    }


def test_the_table_marks_the_better_and_the_worse(motors, tmp_path):
    picture = tmp_path / "both.svg"
    done = run(*motors, "--picture", picture)
    assert done.exit_code == 0, done.output
    row = next(line for line in done.stdout.splitlines() if "Torque ripple, one-sided" in line)
    assert BEST in row
    assert WORST in row
    assert "motor.valve_plate.shift" in done.stdout
    assert picture.read_text().count("<svg") == 1


def test_all_run_at_the_points_of_the_first_unless_asked_otherwise(motors, tmp_path):
    slow = tmp_path / "slow.toml"
    slow.write_text(SOUND.replace('speed = "60 rpm"', 'speed = "120 rpm"'))
    same = json.loads(run(motors[0], slow, "--json").stdout)
    one, other = (each["results"] for each in same["motors"])
    assert one == other
    assert "operating points of the first" in same["notes"][0]
    own = json.loads(run(motors[0], slow, "--own-points", "--json").stdout)
    one, other = (each["results"] for each in own["motors"])
    assert one[0] == other[0]
    # Twice the speed, nearly twice the flow.
    assert other[1]["supply_flow"] > 1.8 * one[1]["supply_flow"]


def test_units_and_defaults_are_no_difference():
    given = parse_motor_file(SOUND)
    same = parse_motor_file(with_line('dead_volume = "6000 mm^3"'))
    assert differing_inputs([given, same]) == {}
    other = parse_motor_file(with_line("ramp = 0.36"))
    assert differing_inputs([given, other, given]) == {
        "motor.valve_plate.ramp": ["0.35", "0.36", "0.35"]
    }
    unnamed = replace(given, document={**given.document, "fluid": {}})
    assert differing_inputs([given, unnamed])["fluid.density"] == ["870 kg/m^3", None]


def test_marks_know_which_way_is_better():
    ripple, efficiency = QUANTITIES["torque_ripple"], QUANTITIES["efficiency"]
    assert marked(ripple, [0.1, 0.2, 0.3]) == [BEST, "", WORST]
    assert marked(efficiency, [0.9, 0.95, 0.9]) == [WORST, BEST, WORST]
    assert marked(efficiency, [0.9, 0.9000001]) == ["", ""]
    assert marked(ripple, [0.1, float("nan")]) == ["", ""]
    assert marked(QUANTITIES["stroke"], [0.01, 0.02]) == ["", ""]


@pytest.mark.parametrize(
    ("names", "options", "words"),
    [
        (["given.toml"], [], "name 2 to 8 motors"),
        (["given.toml", "gven.toml"], [], "you probably meant"),
        (["given.toml", "."], [], "holds no study"),
        (["given.toml", "given.toml"], ["--picture", "both.gif"], "end it in .png"),
    ],
)
def test_what_cannot_be_compared_is_refused_in_a_sentence(motors, names, options, words):
    done = run(*(motors[0].parent / name for name in names), *options)
    assert done.exit_code == 2, done.output
    assert words in done.stderr
    assert done.stderr.count("\n") == 1


def test_a_study_without_a_best_motor_is_refused(motors, tmp_path):
    study = tmp_path / "unfinished"
    StudyFolder.create(study, SOUND.encode(), {}).close()
    done = run(motors[0], study)
    assert done.exit_code == 2
    assert "camring resume" in done.stderr


def test_a_picture_of_a_point_that_is_not_there_is_refused(motors, tmp_path):
    done = run(*motors, "--picture", tmp_path / "both.png", "--point", "3")
    assert done.exit_code == 2
    assert "give a number from 1 to 2" in done.stderr

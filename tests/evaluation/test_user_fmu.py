"""A user's FMU as the evaluator of a study: read as mapped, and survived."""

import math
import shutil
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from zipfile import ZipFile

import numpy as np
import pytest
from command_line import EXAMPLE
from motor_files import added
from typer.testing import CliRunner

from camring.cli.app import app
from camring.evaluation.user_programs.command import CommandFailed, UserCommand
from camring.evaluation.user_programs.evaluator import NAMES
from camring.evaluation.user_programs.fmu import Mapped, seconds, start_values, taken_from
from camring.files.errors import InputError
from camring.files.motor import parse_motor_file
from camring.studies.study_choices import command_of

pytestmark = pytest.mark.skipif(not shutil.which("cc"), reason="no C compiler")

VARIABLES = ("level", "height", "speed", "mood", "torque")
DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="waves" guid="{{1}}">
<CoSimulation modelIdentifier="waves" canHandleVariableCommunicationStepSize="true"/>
<ModelVariables>{variables}</ModelVariables>
<ModelStructure><Outputs><Unknown index="5"/></Outputs></ModelStructure>
</fmiModelDescription>"""
MAPPING = """
fmu = "waves.fmu"
until = "3 turn"
step = "1 deg"

[parameters]
level = "motor.cam.control_radii[1]"
height = "motor.valve_plate.shift"
speed = "operating_point.shaft_speed"
mood = {mood}

[results]
mean_torque = {{ output = "torque", last = "1 turn", factor = 10 }}
torque_ripple = {{ output = "torque", take = "one-sided rms", last = "1 turn", relative = true }}
max_pressure = {{ output = "torque", take = "max" }}
torque_ripple_peak_to_peak = {{ output = "torque", take = "peak to peak", last = "2 turn" }}
min_lift = {{ output = "torque", take = "final" }}
"""
DOCUMENT = {
    "design": {"motor.valve_plate.shift": 0.5, "motor.cam.control_radii": [0.1, 4.0]},
    "points": [{"shaft_speed": 10.0}, {"shaft_speed": -25.0}],
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    fmpy = pytest.importorskip("fmpy", reason="the extra camring[fmu]")
    place = tmp_path_factory.mktemp("waves")
    source = Path(__file__).with_name("waves_fmu.c")
    library = place / "waves.so"
    words = ["cc", "-O1", "-fPIC", "-shared", "-o", str(library), str(source), "-lm"]
    subprocess.run(words, check=True)
    system, suffix = fmpy.platform, fmpy.sharedLibraryExtension
    variables = "".join(
        f'<ScalarVariable name="{name}" valueReference="{place}" causality='
        + ('"output"><Real/>' if name == "torque" else '"parameter" variability="fixed">'
           '<Real start="0"/>')
        + "</ScalarVariable>"
        for place, name in enumerate(VARIABLES)
    )  # fmt: skip
    with ZipFile(place / "waves.fmu", "w") as archive:
        archive.writestr("modelDescription.xml", DESCRIPTION.format(variables=variables))
        archive.write(library, f"binaries/{system}/waves{suffix}")
    return place


def command(folder, mood=0, timeout=60.0, mapping=MAPPING):
    (folder / "map.toml").write_text(mapping.format(mood=mood))
    words = (sys.executable, "-m", "camring.evaluation.user_programs.fmu", "map.toml")
    return UserCommand(words, timeout, str(folder))


def asked(command):
    with TemporaryDirectory() as place:
        document = {**DOCUMENT, "motor_file": f"{place}/motor.toml"}
        return command.results(document, NAMES, 2)


def reason_of(wrong):
    with pytest.raises(CommandFailed) as caught:
        asked(wrong)
    return str(caught.value)


def test_its_outputs_are_taken_as_the_file_says(folder):
    for each in asked(
        command(folder)
    ):  # whole periods of level 4 and height 0.5, whatever the speed
        assert each["mean_torque"] == pytest.approx(40.0)
        assert each["torque_ripple"] == pytest.approx(0.5 / 2 / 4.0)
        assert each["max_pressure"] == pytest.approx(4.5)
        assert each["torque_ripple_peak_to_peak"] == pytest.approx(1.0)
        assert each["min_lift"] == pytest.approx(4.0)


@pytest.mark.parametrize(
    ("mood", "words"),
    [(1, "ended by signal 6"), (3, "is nan"), (4, "fmi2DoStep")],
)
def test_a_crash_a_nan_and_a_refused_step_are_failed_evaluations(folder, mood, words):
    assert words in reason_of(command(folder, mood))


def test_one_that_never_comes_back_is_stopped(folder):
    assert "took longer than 3 s and was stopped" in reason_of(command(folder, 2, timeout=3.0))


def test_misspelt_variables_and_keys_get_their_nearest_neighbour(folder):
    wrong = command(
        folder, mapping=MAPPING.replace('output = "torque", last', 'output = "torqe", last')
    )
    assert 'did you mean "torque"?' in reason_of(wrong)
    for before, after, words in (
        ("step =", "steps =", 'did you mean "step"'),
        ("waves.fmu", "wave.fmu", "which is no file"),
        ('"max"', '"maximum"', "choose final, mean, min"),
        ("factor = 10", "factr = 10", 'did you mean "factor"'),
    ):
        (folder / "wrong.toml").write_text(MAPPING.replace(before, after, 1).format(mood=0))
        with pytest.raises(InputError, match=words.replace("?", r"\?")):
            Mapped.read(folder / "wrong.toml")
    for key in ("parameters", "results"):
        others = [each for each in ("parameters", "results") if each != key]
        (folder / "wrong.toml").write_text(
            f'fmu = "waves.fmu"\nuntil = "1 s"\nstep = "1 ms"\n{key} = [3]\n[{others[0]}]\n'
        )
        with pytest.raises(InputError, match=rf"{key} is a list of 1.*write it as \[{key}\]"):
            Mapped.read(folder / "wrong.toml")
    (folder / "map.toml").write_text(MAPPING.format(mood=0))
    design = {"motor.valve_plate.shft": 1.0, "motor.cam.control_radii": [0.1, 4.0]}
    with pytest.raises(InputError, match="did you mean") as caught:
        start_values(Mapped.read(folder / "map.toml"), design, {})
    assert 'parameters.height is "motor.valve_plate.shift"' in str(caught.value)


def test_spans_are_times_or_angles_of_the_shaft():
    assert seconds("until", "20 ms", 5.0) == pytest.approx(0.02)
    assert seconds("until", "2 turn", -5.0) == pytest.approx(4 * math.pi / 5)
    for text, speed in (("2 turn", 0.0), ("0 s", 1.0), ("3 bar", 1.0)):
        with pytest.raises(InputError, match="until is"):
            seconds("until", text, speed)


def test_whole_periods_are_averaged_exactly_and_transients_left_out():
    step = 2e-3
    time = np.arange(0, 2 + step / 2, step)
    wave = 3 + np.sin(2 * np.pi * time) + 100 * np.exp(-40 * time)
    for take, exact in (("mean", 3.0), ("rms", math.sqrt(0.5)), ("one-sided rms", 0.5)):
        found = taken_from(time, wave, 1.0, step, {"take": take})
        assert found == pytest.approx(exact, rel=1e-12)


def test_a_wrong_file_is_refused_before_a_study_begins(folder, tmp_path):
    (folder / "wrong.toml").write_text(MAPPING.replace("[results]", "[result]").format(mood=0))
    out = ["optimise", str(EXAMPLE), "--out", str(tmp_path / "study"), "--fmu"]
    for path, more, words in (
        (folder / "wrong.toml", [], 'did you mean "results"'),
        (folder / "none.toml", [], "cannot be read"),
        (folder / "wrong.toml", ["--evaluator", "python x.py"], "beside --evaluator"),
    ):
        said = CliRunner().invoke(app, [*out, str(path), *more])
        assert said.exit_code == 2
        assert words in said.stderr
    assert not list(tmp_path.iterdir())


def test_it_may_stand_in_the_motor_file(folder):
    (folder / "map.toml").write_text(MAPPING.format(mood=0))
    text = added("[evaluator]", 'fmu = "map.toml"\ntimeout = "50 s"')
    found = command_of(parse_motor_file(text, folder / "motor.toml"), None, None)
    assert (found.words[-1], found.timeout) == (str(folder / "map.toml"), 50.0)
    assert asked(found)[0]["mean_torque"] == pytest.approx(40.0)

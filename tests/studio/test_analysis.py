"""Fronts and tolerances of the page are those of the command line."""

import time
from pathlib import Path

import pytest
from motor_files import SOUND, without_table

from camring.files.errors import InputError
from camring.studio.runs.analysis import Analysis

EXAMPLES = Path(__file__).parents[2] / "examples"


def test_the_line_that_is_shown_is_the_command_that_runs(tmp_path):
    front = Analysis.of_message(
        tmp_path / "f", print, {"kind": "pareto", "of": "a,b", "count": 7}
    ).command("motor.toml")
    assert front == "camring pareto motor.toml --of a,b --points 7 --out f"
    built = Analysis.of_message(tmp_path / "t", print, {"kind": "tolerance", "count": 2}).command(
        "motor.toml"
    )
    assert built == "camring tolerance motor.toml --samples 16 --out t"
    with pytest.raises(InputError, match="choose pareto or tolerance"):
        Analysis.of_message(tmp_path, print, {"kind": "rm"})


def run(tmp_path, text, message):
    said = []
    (tmp_path / "motor.toml").write_text(text)
    analysis = Analysis.of_message(tmp_path / "found", said.append, message)
    analysis.begin(text, tmp_path / "motor.toml")
    analysis._child.wait(600)
    deadline = time.monotonic() + 10
    while not said and time.monotonic() < deadline:
        time.sleep(0.01)
    return analysis, said[-1]


def test_a_command_that_refuses_says_its_own_sentence(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    text = (EXAMPLES / "wheel_motor.toml").read_text()
    analysis, said = run(tmp_path, text, {"kind": "tolerance", "count": 16})
    assert said["state"] == "failed"
    assert "[tolerances]" in said["sentence"]
    with pytest.raises(InputError, match="not in this front"):
        analysis.design(1)


def test_every_design_of_a_front_can_be_taken(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    text = without_table("[design_space.cam]", without_table("[design_space]", SOUND))
    text = f'{text}\n[design_space]\n"motor.valve_plate.shift" = ["-1 deg", "1 deg"]\n'
    message = {"kind": "pareto", "of": "torque_ripple,efficiency", "count": 3}
    analysis, said = run(tmp_path, text, message)
    assert said["state"] == "done", said["sentence"]
    ripples = [each[0] for each in said["designs"]]
    assert ripples == sorted(ripples)
    for number in range(1, len(ripples) + 1):
        assert "[motor.cam]" in analysis.design(number)

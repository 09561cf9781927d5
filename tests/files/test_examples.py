"""The examples in `examples/` run as they stand and say something true."""

import re
import runpy
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from camring.files.motor import read_motor_file
from camring.fitting.measurements.table import parse_measured_table, read_measured_table

EXAMPLES = Path(__file__).parents[2] / "examples"
README = (EXAMPLES.parent / "README.md").read_text()


@pytest.fixture
def run(capsys):
    """Runs an example here, where JAX and the programs are; what it prints."""

    def said(name):
        runpy.run_path(str(EXAMPLES / f"{name}.py"), run_name="__main__")
        return capsys.readouterr().out

    return said


def numbers(text, pattern):
    return [float(found) for found in re.findall(pattern, text)]


def test_simulate_a_motor(run):
    said = run("simulate_a_motor")
    assert numbers(said, r"ripple +([\d.]+) %") == [8.56, 7.98]
    assert all(88 < value < 92 for value in numbers(said, r"efficiency ([\d.]+) %"))


def test_compare_textbook_cams(run):
    ripples = numbers(run("compare_textbook_cams"), r"ripple +([\d.]+) %")
    assert len(ripples) == 4
    assert ripples[-1] == min(ripples)


def test_sweep_valve_timing(run):
    said = run("sweep_valve_timing")
    ripples, peaks = numbers(said, r"ripple +([\d.]+) %"), numbers(said, r"peak +(\d+) bar")
    assert len(ripples) == len(peaks) == 9
    # Opened too late, the port leaves the piston pressing on trapped oil.
    assert peaks[-1] > peaks[0]


def test_gradient_of_ripple(run):
    changes = numbers(run("gradient_of_ripple"), r"([+-][\d.]+) points")
    assert len(changes) == read_motor_file(EXAMPLES / "wheel_motor.toml").design_space.dimension
    assert abs(changes[0]) == max(map(abs, changes)) > 1


def test_change_weights_afterwards():
    """As a program of its own, which starts others."""
    said = subprocess.run(
        [sys.executable, str(EXAMPLES / "change_weights_afterwards.py")],
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    ).stdout
    quiet, frugal = numbers(said, r"efficiency ([\d.]+) %")
    assert frugal >= quiet
    assert "alidated" in said


def test_measure_a_made_up_motor(run):
    """What it prints is the table that ships beside it."""
    made = parse_measured_table(run("measure_a_made_up_motor"))
    shipped = read_measured_table(EXAMPLES / "wheel_motor_measured.csv")
    for name, values in shipped.values.items():
        # To the digits printed, of which the last may turn on another machine.
        np.testing.assert_allclose(made.values[name], values, rtol=2e-3)
    np.testing.assert_array_equal(made.conditions["shaft_speed"], shipped.conditions["shaft_speed"])


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.stem)
def test_every_example_is_short_and_in_the_readme(path):
    assert f"examples/{path.name}" in README
    assert len(path.read_text().splitlines()) <= 50


def test_the_python_of_the_readme_runs(monkeypatch, capsys):
    [program] = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)
    assert len(program.splitlines()) <= 6
    monkeypatch.chdir(EXAMPLES.parent)
    exec(program, {})
    assert numbers(capsys.readouterr().out, r"ripple ([\d.]+) %") == [8.56, 7.98]

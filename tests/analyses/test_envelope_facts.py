"""`camring check` holds a file to its envelope, and tells of the usual range of one without."""

import json
from dataclasses import replace

import numpy as np
import pytest
from motor_files import SOUND
from typer.testing import CliRunner

from camring.analyses.envelope_facts import EnvelopeFacts
from camring.cli.app import app
from camring.files.motor import parse_motor_file
from camring.studies.envelope_words import runs_in_words

RUN = CliRunner()
# One operating point, and an envelope close to it.
SIMPLE = (
    SOUND[: SOUND.index('[[operating_points]]\nspeed = "60 rpm"')]
    + SOUND[SOUND.index("# What is to become small") :]
)
NARROW = """
[envelope]
speed = ["250 rpm", "300 rpm"]
supply_pressure = ["200 bar", "250 bar"]
max_ripple_ratio = 0.5
"""


@pytest.fixture(scope="module")
def facts():
    return EnvelopeFacts.of(parse_motor_file(SIMPLE + NARROW))


@pytest.fixture
def run(tmp_path, monkeypatch):
    """The command on the simple motor, with an envelope's facts as given."""

    def command(stated, *options):
        path = tmp_path / "motor.toml"
        path.write_text(SIMPLE + NARROW)
        monkeypatch.setattr(EnvelopeFacts, "of", lambda file: stated)
        return RUN.invoke(app, ["check", str(path), *options])

    return command


def changed(facts, asked=True, **limits):
    """The same facts with other limits, each the same at every point but for its first."""
    count = facts.check.grid.count
    stated = {
        name: np.array([first, *[others] * (count - 1)]) for name, (first, others) in limits.items()
    }
    return EnvelopeFacts(replace(facts.check, asked=asked, limits=[stated]))


def test_a_motor_that_keeps_its_envelope_reads_where_it_is_tightest(facts, run):
    done = run(facts)
    assert done.exit_code == 0, done.output
    said = " ".join(done.stdout.split())
    assert "Every limit of the envelope holds at 108 points of it." in said
    assert "The motor runs without lift-off or cavitation from 200 to 250 bar, 250 to 300" in said
    document = json.loads(run(facts, "--json").stdout)
    assert document["feasible"] is True
    found = document["envelope"]
    assert (found["asked"], found["points"], found["broken"]) == (True, 108, [])
    stress = found["limits"]["max_contact_stress"]
    assert stress["g"] == max(facts.limits["max_contact_stress"])
    assert stress["supply_pressure"] == pytest.approx(250e5)


def test_a_limit_broken_in_the_envelope_is_exit_code_3(facts, run):
    lifted = changed(facts, min_contact_force=(0.25, -0.1), max_pressure=(-0.2, -0.2))
    done = run(lifted)
    assert done.exit_code == 3
    said = " ".join(done.stdout.split())
    assert "min_contact_force -25 % 250 rpm, 200 bar 1 of 108 points" in said
    assert "Broken in the envelope: min_contact_force." in said
    assert "at 1 of 108 points from 200 to 250 bar" in said
    done = run(lifted, "--json")
    assert done.exit_code == 3
    assert json.loads(done.stdout)["feasible"] is False


def test_a_point_without_result_does_not_hold(facts):
    given = replace(facts.check.given, faults=np.arange(108) // 107)
    holed = EnvelopeFacts(replace(facts.check, given=given))
    assert not holed.holds
    assert set(holed.broken) == set(holed.limits)


def test_a_file_is_not_held_against_its_own_ripple(facts):
    """Half of its own ripple is what its successors are asked for."""
    assert facts.check.limits[0]["max_ripple_ratio"] == pytest.approx(1.0)
    assert "max_ripple_ratio" not in facts.limits
    assert facts.holds


def test_a_file_without_limits_that_vary_still_says_where_it_runs(facts):
    free = changed(facts)
    assert free.holds
    assert free.limits == {}
    assert not free.check.broken().any()
    assert set(free.check.binding()) == {""}
    assert free.check.tightest() == 0
    assert runs_in_words(free.check) == runs_in_words(facts.check)


def test_without_an_envelope_the_usual_range_is_given_and_nothing_asked():
    stated = EnvelopeFacts.of(parse_motor_file(SIMPLE))
    assert not stated.check.asked
    assert stated.holds
    grid = stated.check.grid
    back = grid.return_pressure[0]
    assert min(grid.pressure_drop) == pytest.approx(0.1 * max(grid.pressure_drop))
    assert min(grid.shaft_speed) == pytest.approx(0.1 * max(grid.shaft_speed))
    assert (grid.return_pressure == back).all()


def test_what_nobody_asked_for_is_information(facts, run):
    done = run(changed(facts, asked=False, min_contact_force=(0.25, -0.1)))
    assert done.exit_code == 0
    said = " ".join(done.stdout.split())
    assert (
        "Without an [envelope] nothing is asked between operating points. The motor lifts" in said
    )
    assert "Broken" not in said

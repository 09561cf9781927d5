"""Numbers of somebody else's program are not believed in any unit."""

import json
import pickle
import sys
from pathlib import Path

import pytest
from motor_files import added
from typer.testing import CliRunner

import camring
from camring.cli.app import app
from camring.evaluation.user_programs.command import UserCommand
from camring.evaluation.user_programs.evaluator import from_fact, to_fact
from camring.evaluation.user_programs.numbers import (
    POSSIBLE,
    SMALL,
    UNITS,
    Impossible,
    NotBelieved,
    doubts_about,
    not_believed,
    require_possible,
)
from camring.files.errors import InputError
from camring.files.motor import parse_motor_file
from camring.files.named_units import factor_of, in_si, read_units, si_units
from camring.metrics.summary import Metrics
from camring.studies.coordinator import evaluate_or_fail
from camring.studies.study_choices import command_of

EXAMPLE = Path(__file__).parents[2] / "examples" / "derivation_motor.toml"
OURS = {
    "mean_torque": 1500.0,
    "torque_ripple": 0.083,
    "efficiency": 0.94,
    "max_pressure": 4.8e7,
    "max_contact_stress": 2.1e9,
    "displacement": 4e-4,
    "supply_flow": 3.5e-4,
    "stroke": 0.0122,
    "max_pressure_angle": 0.21,
    "min_pressure": 9e5,
    "leakage_loss": 12.0,
    "input_power": 1.6e4,
    "min_contact_force": 40.0,
    "l10_life": 3.6e7,
}


def seems_in(name, value, named=()):
    found = doubts_about([{name: value}], [OURS], named)
    return found[name][1] if name in found else None


@pytest.mark.parametrize(
    ("name", "value", "unit"),
    [
        ("max_pressure", 480, "bar"),
        ("max_pressure", 42.0, "MPa"),
        ("max_pressure", 7000, "psi"),
        ("max_pressure", 6.1e4, "kPa"),
        ("max_contact_stress", 2.1, "GPa"),
        ("max_contact_stress", 1650, "MPa"),
        ("torque_ripple", 9.4, "%"),
        ("efficiency", 94.0, "%"),
        ("displacement", 401.0, "cm3"),
        ("displacement", 0.4, "L"),
        ("supply_flow", 21.3, "L/min"),
        ("stroke", 12.2, "mm"),
        ("max_pressure_angle", 12.5, "deg"),
        ("mean_torque", 1.43, "kN.m"),
        ("input_power", 16.4, "kW"),
        ("min_pressure", 8.0, "bar"),
        ("l10_life", 9000.0, "h"),
        ("mean_torque", 150_000.0, ""),
        ("max_pressure", 4.0e7, None),
        ("mean_torque", 400.0, None),
        ("leakage_loss", 600.0, None),
        ("torque_ripple", 0.002, None),
        ("min_contact_force", -900.0, None),
        ("max_velocity", 3.0, None),
    ],
)
def test_a_factor_between_two_models_is_a_unit_or_a_question(name, value, unit):
    assert seems_in(name, value) == unit


def test_a_unit_that_its_user_names_is_not_questioned():
    assert seems_in("max_pressure", 480.0, (("max_pressure", "Pa"),)) is None
    (said, unit) = doubts_about([{}, {"max_pressure": 480.0}], [OURS, OURS])["max_pressure"]
    assert "max_pressure at operating point 2 is 480 where our simulation says 4.8e+07 Pa" in said
    assert "a factor of 1e-05 away; it looks like bar" in said
    error = not_believed([said], {"max_pressure": unit})
    assert 'units = { max_pressure = "bar" }' in str(error)
    assert "--unit max_pressure=bar" in str(error)
    assert str(pickle.loads(pickle.dumps(error))) == str(error)


@pytest.mark.parametrize(
    ("results", "words"),
    [
        ({"efficiency": 95.1}, "is 95.1, which can be at most 1.05 and looks like %"),
        ({"efficiency": 1.06}, "at most 1.05"),
        ({"volumetric_efficiency": 98.0}, "looks like %"),
        ({"torque_ripple": -0.01}, "at least 0"),
        ({"flow_ripple": -1e-9}, "at least 0"),
        ({"max_pressure": -4.0e7}, "at least 0 Pa"),
        ({"max_pressure_angle": 12.0}, "at most 1.5708 rad and looks like deg"),
        ({"share_below_vapour": 3.0}, "at most 1"),
    ],
)
def test_what_no_motor_has_is_refused(results, words):
    with pytest.raises(Impossible) as caught:
        require_possible([{}, results])
    assert words in str(caught.value)
    assert "at operating point 2" in str(caught.value)
    require_possible([OURS, {"efficiency": 1.04, "min_pressure": -1e5}])


def test_every_name_and_every_unit_there_is_one():
    assert list(si_units()) == list(Metrics.__dataclass_fields__)
    assert {*POSSIBLE, *SMALL} <= set(si_units())
    for si, units in UNITS.items():
        name = next(name for name, unit in si_units().items() if unit == si)
        factors = [factor_of(name, unit) for unit in units]
        assert all(factor != 1.0 for factor in factors)


def test_named_units_bring_results_to_si():
    units = read_units(
        {"max_pressure": "bar", "efficiency": "%", "displacement": "cm3/rev"}, "units"
    )
    found = in_si({"max_pressure": 480.0, "efficiency": 95.1, "displacement": 400.0,
                   "mean_torque": 7.0}, units)  # fmt: skip
    assert found == pytest.approx(
        {"max_pressure": 4.8e7, "efficiency": 0.951, "displacement": 4e-4, "mean_torque": 7.0}
    )
    gauges = read_units({"max_pressure": "barg", "min_pressure": "psig",
                         "pressure_overshoot": "barg", "vapour_margin": "bar g",
                         "case_temperature_rise": "degC", "displacement": "cc/r"},
                        "units")  # fmt: skip
    found_gauges = in_si({"max_pressure": 420.0, "min_pressure": 0.0, "pressure_overshoot": 5.0,
                          "vapour_margin": 2.0, "case_temperature_rise": 30.0,
                          "displacement": 400.0}, gauges)  # fmt: skip
    # What a gauge shows stands above the atmosphere; a difference is the same wherever it stands.
    assert found_gauges == pytest.approx(
        {"max_pressure": 421.01325e5, "min_pressure": 101325.0, "pressure_overshoot": 5e5,
         "vapour_margin": 2e5, "case_temperature_rise": 30.0, "displacement": 4e-4}
    )  # fmt: skip
    command = UserCommand(("a",), 1.0, "/", units)
    assert from_fact(to_fact(command)) == command
    for wrong in ("[]", "{", '{"command": "rm", "folder": 3}', '{"command": [], "folder": "/"}'):
        with pytest.raises(InputError, match="no command that can be read"):
            from_fact(wrong)


@pytest.mark.parametrize(
    ("units", "sentence"),
    [
        ('{ max_presure = "bar" }', r"evaluator.units.max_presure is no result.*max_pressure"),
        ('{ max_pressure = "L/min" }', r"evaluator.units.max_pressure is .*which has the unit"),
        ('{ max_pressure = "bahr" }', "evaluator.units.max_pressure is"),
        ("{ efficiency = 3 }", "evaluator.units.efficiency is 3"),
        ('"bar"', "evaluator.units is"),
    ],
)
def test_the_table_of_units_is_checked_like_any_other(units, sentence):
    with pytest.raises(InputError, match=sentence):
        parse_motor_file(added("[evaluator]", f'command = ["python"]\nunits = {units}'))


def test_units_come_from_the_file_or_the_caller(tmp_path):
    text = added("[evaluator]", 'command = ["python", "x.py"]\nunits = { max_pressure = "bar" }')
    file = parse_motor_file(text, tmp_path / "motor.toml")
    assert command_of(file, None, None).units == (("max_pressure", "bar"),)
    more = {"max_pressure": "MPa", "efficiency": "%"}
    assert dict(command_of(file, None, None, more).units) == more
    assert command_of(file, "python y.py", None).units == ()
    out = ["optimise", str(EXAMPLE), "--out", str(tmp_path / "out")]
    for words, sentence in (
        (["--unit", "max_pressure=bar"], "no effect without --evaluator"),
        (["--evaluator", "python x.py", "--unit", "bar"], "--unit max_pressure=bar"),
        (["--evaluator", "python x.py", "--unit", "max_presure=bar"], "max_pressure"),
    ):
        said = CliRunner().invoke(app, [*out, *words])
        assert (said.exit_code, sentence in said.stderr) == (2, True), said.stderr


def test_an_error_about_units_is_no_failed_design():
    def evaluate(point):
        raise not_believed(["efficiency is 95.1"], {"efficiency": "%"})

    with pytest.raises(NotBelieved):
        evaluate_or_fail(evaluate, (), None)


def test_a_study_in_wrong_units_ends_before_it_has_begun(tmp_path):
    """The issue's own case: 480 (bar) and 2.1 (GPa) passed their limits with margins of +1."""
    answer = {"results": [{"max_pressure": 480, "max_contact_stress": 2.1}] * 2}
    line = f"import sys; sys.stdin.read(); print({json.dumps(answer)!r})"
    with pytest.raises(NotBelieved) as caught:
        camring.optimise(
            EXAMPLE,
            tmp_path / "study",
            budget=9,
            theory=False,
            evaluator=[sys.executable, "-S", "-c", line],
        )
    assert '{ max_pressure = "bar", max_contact_stress = "GPa" }' in str(caught.value)
    assert not list(tmp_path.iterdir())

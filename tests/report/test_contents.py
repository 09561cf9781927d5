"""A report is gathered from a real study folder, and can be made again and again."""

import json
import re
import shutil
import sqlite3
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from camring.cli.report import report
from camring.evaluation.evaluator import MotorEvaluator
from camring.evaluation.outcome import failed
from camring.evaluation.record import Record
from camring.files.errors import InputError
from camring.files.motor import parse_motor_file, read_motor_file
from camring.objective.theory import theory_designs
from camring.presentation.envelope import read_envelope
from camring.report import (
    contents,
    gather,
    gather_comparison,
    gather_single,
    render,
    write_page,
    write_report,
)
from camring.report.verdicts import read_verdict, validated_trial, verdict_of
from camring.studies.study_folder import FOUND_BY, StudyFolder
from camring.studies.validation import Check, Validation

EXAMPLE = Path(__file__).parents[2] / "examples" / "derivation_motor.toml"
LEARNED = {"leave_one_out": {"plain": [0.31, 0.0], "rho = 1": [0.2, 1.0]}, "mean": "rho = 1"}
MEMORY = {"begun": 0, "notes": [], "memories": [{"learned": LEARNED}, {}]}
FACTS = {
    "seed": "7",
    "budget": "3",
    "stopped": "budget spent.",
    "given_name": "wheel_motor.toml",
    "theory": "true",
    "first_points": "[[0.5], [0.4]]",
}


@pytest.fixture(scope="module")
def study(tmp_path_factory) -> Path:
    """A study of three evaluations: the given motor, one from theory, one that failed."""
    folder = tmp_path_factory.mktemp("study") / "wheel"
    motor_file = read_motor_file(EXAMPLE)
    space, system = motor_file.design_space, motor_file.system
    points = [space.locate(system), theory_designs(system, space, motor_file.goal.constraints)[0]]
    evaluate = MotorEvaluator(motor_file.text)
    opened = StudyFolder.create(folder, EXAMPLE.read_bytes(), FACTS)
    try:
        for trial, point in enumerate(points):
            record = Record(trial, "initial", point, evaluate(point), 0.0, 0.01)
            opened.store.append(record, {})
        record = Record(2, "local", np.full(space.dimension, 0.1), failed("no convergence"))
        opened.store.append(record, MEMORY)
    finally:
        opened.close()
    return folder


@pytest.fixture(scope="module")
def data(study):
    return gather(study)


def test_where_no_design_keeps_the_limits_the_closest_stands_beside_the_given(study, tmp_path):
    opened = StudyFolder.open(study, write=False)
    try:
        records = opened.store.records()
    finally:
        opened.close()
    folder = tmp_path / "infeasible"
    opened = StudyFolder.create(folder, EXAMPLE.read_bytes(), FACTS)
    try:
        for record, excess in zip(records[:2], (0.5, 0.2), strict=True):
            broken = {**record.outcome.constraints, "max_pressure": excess}
            outcome = replace(record.outcome, constraints=broken)
            opened.store.append(replace(record, outcome=outcome), {})
    finally:
        opened.close()
    data = gather(folder)
    assert [design.label for design in data.designs] == ["given", "closest"]
    assert data.verdict is not None
    assert not data.verdict.validated
    assert data.search is not None
    assert data.search.best is None
    assert "Closest" in render(data)


def test_motors_at_hand_are_taken_for_the_study_that_they_are_of_alone(study, data, monkeypatch):
    """A study that ends has simulated them while its second solver worked."""
    fresh = contents.study_motors(*_motors_of(study))
    monkeypatch.setattr(contents, "study_motors", lambda *motors: pytest.fail("simulated anew"))
    at_hand = gather(study, fresh)
    assert at_hand.sensitivities == data.sensitivities
    assert render(at_hand) == render(data)
    other = replace(fresh, texts=(fresh.texts[0], fresh.texts[1] + "# another"))
    with pytest.raises(pytest.fail.Exception, match="simulated anew"):
        gather(study, other)


def _motors_of(study):
    opened = StudyFolder.open(study, write=False)
    try:
        point = opened.store.records()[1].point
    finally:
        opened.close()
    given = read_motor_file(opened.given_path)
    best = parse_motor_file(given.with_design(point.tolist(), FOUND_BY), opened.best_path)
    return given, best, "best", point


def test_before_and_after_are_the_given_and_the_best_motor(data):
    assert [design.label for design in data.designs] == ["given", "best"]
    given, best = (design.results[0].metrics for design in data.designs)
    assert given["torque_ripple"] == pytest.approx(0.08293857, rel=1e-4)
    assert best["torque_ripple"] < 0.3 * given["torque_ripple"]
    assert data.is_study
    assert "8 pistons on 6 lobes" in data.subtitle


def test_margins_are_those_of_the_study(data, study):
    opened = StudyFolder.open(study, write=False)
    outcome = opened.store.records()[0].outcome
    opened.close()
    assert {c.name for c in data.constraints} == set(outcome.constraints)
    for constraint in data.constraints:
        assert constraint.margins[0] == pytest.approx(
            -outcome.constraints[constraint.name], rel=1e-5, abs=1e-7
        )
        assert constraint.limit.startswith(("at most", "at least"))


def test_variables_are_in_the_units_of_the_file(data):
    by_name = {variable.name: variable for variable in data.variables}
    shift = by_name["motor.valve_plate.shift"]
    width = by_name["motor.valve_plate.supply_width"]
    assert width.unit == "deg"
    assert 20 < width.low < 28.4 < width.high < 31
    assert width.values[0] == pytest.approx(28.4)
    assert shift.unit == "deg"  # the file has no value for it, but its bounds have a unit
    assert shift.values[0] == pytest.approx(0.0, abs=1e-9)
    assert by_name["cam cos 2"].unit == "mm"


def test_the_search_is_reported_trial_by_trial(data):
    search = data.search
    assert [trial.failed for trial in search.trials] == [False, False, True]
    assert (search.given, search.best) == (0, 1)
    assert search.surrogate_used == "rho = 1"
    assert search.leave_one_out == {"plain": 0.31, "rho = 1": 0.2}
    assert search.stopped == "budget spent"
    assert search.notes[0].startswith("The search began from the given motor and 1 design")
    assert data.provenance.input_name == "wheel_motor.toml"
    assert data.provenance.settings["To repeat"].endswith("--seed 7 --budget 3")


def test_sensitivities_surround_the_best_design(data):
    names = {s.variable for s in data.sensitivities}
    assert names == {variable.name for variable in data.variables}
    centre = {s.centre for s in data.sensitivities if s.result == "efficiency"}
    assert len(centre) == 1
    moved = [abs(s.high - s.low) for s in data.sensitivities if s.result == "torque_ripple"]
    assert max(moved) > 1e-5


def test_a_study_without_validation_is_not_called_validated(data):
    assert data.verdict is not None
    assert not data.verdict.validated


def test_what_is_no_longer_as_the_study_wrote_it_is_neither_shown_nor_believed(
    study, data, tmp_path
):
    """best.toml and validation.json lie beside the database and have no checksums."""
    folder = Path(shutil.copytree(study, tmp_path / "copy"))
    (folder / "best.toml").write_text(
        EXAMPLE.read_text().replace('bore = "30 mm"', 'bore = "29 mm"')
    )
    (folder / "validation.json").write_text('{"trial": 1, "validated": true')
    found = gather(folder)
    assert found.designs[-1].results[0].metrics == data.designs[-1].results[0].metrics
    assert any("best.toml is no longer as the study wrote it" in each for each in found.warnings)
    assert not any("best.toml" in each for each in data.warnings)
    assert not found.verdict.validated
    assert "validation.json cannot be read: `camring resume " in found.verdict.sentence


@pytest.mark.parametrize(
    "text",
    ["", "[]", "3", "[" * 5000, '{"views": []}', '{"views": {"best": 3}}', '{"checks": 5}',
     '{"views": {"best": {"finer": {"results": 3}}}}', "\x00", '{"validated": true, "views": 1}'],
)  # fmt: skip
def test_a_validation_that_is_none_is_no_yes(tmp_path, text):
    place = tmp_path / "validation.json"
    place.write_text(text)
    found = read_verdict(place, [1.0])
    assert found is not None
    assert not found.validated
    assert "validation.json cannot be read" in found.sentence
    assert validated_trial(place) is read_envelope(place) is None
    assert read_verdict(tmp_path / "none.json", [1.0]) is None


def test_the_command_writes_the_page_and_says_where(study, tmp_path):
    folder = tmp_path / "copy"
    shutil.copytree(study, folder)
    with sqlite3.connect(folder / "study.sqlite") as connection:
        connection.execute("UPDATE evaluation SET seconds = 3.0 WHERE trial = 2")
    connection.close()
    report(folder)
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "left out: evaluation 2 does not match its checksum." in page
    assert page.startswith("<!DOCTYPE html>")
    assert "Wheel motor" in page
    assert len(page) < 2_000_000
    before = sorted(each.name for each in folder.iterdir() if "wal" not in each.name)
    write_report(folder)
    after = sorted(each.name for each in folder.iterdir() if "wal" not in each.name)
    assert before == after


def test_a_folder_without_a_study_is_refused_in_a_sentence(tmp_path):
    with pytest.raises(InputError, match="holds no study"):
        write_report(tmp_path)


def test_a_page_replaces_pages_only(tmp_path):
    data = gather_single(read_motor_file(EXAMPLE))
    place = tmp_path / "report.html"
    assert write_page(place, data) == place
    write_page(place, data)
    motor = tmp_path / "motor.toml"
    motor.write_text("[motor]\n")
    with pytest.raises(InputError, match="no report"):
        write_page(motor, data)
    assert motor.read_text() == "[motor]\n"
    with pytest.raises(InputError):
        write_page(tmp_path / "absent" / "report.html", data)


def test_motors_are_compared_by_the_names_of_their_files():
    file = read_motor_file(EXAMPLE)
    page = render(gather_comparison([file, file, file]))
    assert "comparison" in page
    assert re.search(r"<th[^>]*>Derivation motor 1</th>", page)


def test_only_what_runs_alike_is_compared():
    file = read_motor_file(EXAMPLE)
    one, _, rest = file.text.partition("[[operating_points]]")
    shorter = parse_motor_file(one + "[[operating_points]]" + rest.partition("[[")[0])
    with pytest.raises(InputError, match="operating points"):
        gather_comparison([file, shorter])
    with pytest.raises(InputError, match="at least two"):
        gather_comparison([file])


def test_warnings_stand_at_the_head_of_the_page():
    # A roller so large that it cuts into the ring.
    text = EXAMPLE.read_text().replace('radius = "12 mm"', 'radius = "60 mm"')
    text = text[: text.index("[constraints]")]
    data = gather_single(parse_motor_file(text))
    assert any("undercut" in sentence for sentence in data.warnings)
    page = render(data)
    assert page.index("undercuts the ring") < page.index("<nav")
    assert not re.search(r"\bnan\b", page[: page.index("<script>")], flags=re.IGNORECASE)


def test_the_verdict_of_a_validation_is_reported_in_words():
    results = [{"torque_ripple": 0.08, "efficiency": 0.96}, {"torque_ripple": 0.06}]
    seen = {"objective": 0.1, "constraints": {"stroke_low": -0.03, "x": -0.2}, "results": results}
    eyes = {"search": seen, "finer": {**seen, "failure": "no convergence"}}
    check = Check("max_contact_stress at finer resolution", True, "margin 0.02")
    name = "agreement of the best motor at finer resolution"  # which the page looks for
    checks = [check, Check(name, True, "largest difference 9.0e-07, in min_pressure")]
    document = json.loads(Validation(3, True, "Validated: all holds.", checks, {}).to_json())
    verdict = verdict_of({**document, "views": {"given": eyes}}, weights=[1, 3])
    assert verdict.validated
    assert verdict.sentence == "All holds."
    assert verdict.checks[0].name == "Highest contact stress at finer resolution"
    assert verdict.checks[1].name == "Agreement of the best motor at finer resolution"
    (view,) = verdict.views
    assert view.torque_ripple == pytest.approx(0.065)
    assert np.isnan(view.efficiency)
    assert view.margin == pytest.approx(0.03)


@pytest.mark.parametrize(
    ("document", "validated", "sentence"),
    [
        ({"validated": True, "sentence": "All holds."}, True, "All holds."),
        ({"validated": True}, True, "Every gain"),
        ({"validated": "yes"}, False, "not completed"),
        ({}, False, "not completed"),
        (
            {"checks": [{"name": "Finer", "passed": False, "detail": "gain gone"}]},
            False,
            "Finer: gain gone",
        ),
    ],
)
def test_only_a_plain_yes_is_a_validation(document, validated, sentence):
    verdict = verdict_of(json.loads(json.dumps(document)))
    assert verdict.validated is validated
    assert sentence in verdict.sentence

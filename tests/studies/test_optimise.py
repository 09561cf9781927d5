"""The whole chain on a real motor: found, validated, reported; killed, and gone on with."""

import json
import os
import shutil
import signal
import sqlite3
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from stopped_command import stopped

import camring
from camring.evaluation.outcome import SAFETY
from camring.studies import verified_rows as verified
from camring.studies.validation import Validation

EXAMPLE = Path(__file__).parents[2] / "examples" / "derivation_motor.toml"
CAMRING = [sys.executable, "-c", "from camring.cli.app import main; main()"]
BUDGET = 34  # 15 to begin with, the rest down the first slope


def start(*arguments):
    return subprocess.Popen(
        [*CAMRING, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """An uninterrupted run of the command: its folder, and what it printed."""
    folder = tmp_path_factory.mktemp("optimise") / "wheel_study"
    process = start("optimise", EXAMPLE, "--out", folder, "--budget", BUDGET, "--json")
    document, said = process.communicate()
    assert process.returncode == 0, said
    return folder, json.loads(document), said


def test_the_folder_holds_what_was_promised(finished):
    folder, _, _ = finished
    assert {path.name for path in folder.iterdir()} == {
        ".lock", "given.toml", "study.sqlite", "best.toml", "validation.json", "report.html",
    }  # fmt: skip
    assert (folder / "given.toml").read_bytes() == EXAMPLE.read_bytes()


def test_the_document_says_what_the_study_holds(finished):
    folder, document, said = finished
    study = camring.open_study(folder)
    assert document["evaluations"] == len(study.records) == BUDGET
    assert document["stopped"] == study.stopped
    assert document["best"]["trial"] == study.best.trial
    assert document["best"]["objective"] < document["given"]["objective"]
    assert document["validated"] is True
    assert document["leave_one_out"] is None  # slopes are exact: nothing is learned
    assert {record.phase for record in study.records} == {"initial", "descent 1"}
    assert "Torque ripple" in said
    assert str(folder / "report.html") in said
    assert "Traceback" not in said


def test_the_given_motor_comes_first_and_is_assessed_as_it_stands(finished):
    folder, _, _ = finished
    study = camring.open_study(folder)
    given = camring.evaluate(study.given.system, study.given.goal)
    np.testing.assert_allclose(
        study.records[0].outcome.objective, float(given.objective), rtol=1e-9
    )


def test_best_toml_is_a_complete_motor_file_of_the_best_design(finished):
    folder, document, _ = finished
    best = camring.read_motor_file(folder / "best.toml")
    assessment = camring.evaluate(best.system, best.goal)
    np.testing.assert_allclose(
        float(assessment.objective), document["best"]["objective"], rtol=1e-6
    )
    for name, value in document["best"]["constraints"].items():
        np.testing.assert_allclose(float(assessment.constraints[name]), value, atol=1e-6)


def test_every_claim_is_restated_by_both_other_eyes(finished):
    folder, document, _ = finished
    validation = Validation.from_json((folder / "validation.json").read_text())
    assert validation.validated
    assert validation.trial == document["best"]["trial"]
    for eye in ("search", "finer", "independent"):
        view = validation.views["best"][eye]
        assert set(view["constraints"]) == set(document["best"]["constraints"])
        assert max(view["constraints"].values()) <= 0
        assert view["objective"] < validation.views["given"][eye]["objective"]
    assert all(check.passed for check in validation.checks)


def test_weights_can_be_changed_without_simulating(finished):
    folder, _, _ = finished
    study = camring.open_study(folder)
    again = study.objectives(study.given.goal.weights)
    stored = [record.outcome.physical_objective for record in study.records]
    np.testing.assert_allclose(again, stored, rtol=1e-12)
    other = camring.Weights(torque_ripple=0.0, efficiency=3.0)
    changed = study.objectives(other)
    goal = camring.Goal(other, study.given.goal.constraints, study.given.goal.harmonics)
    simulated = camring.evaluate(study.given.system, goal)  # by the solver for one motor
    np.testing.assert_allclose(changed[0], float(simulated.physical_objective), rtol=1e-5)


def test_the_search_keeps_away_from_its_limits(finished):
    folder, _, _ = finished
    best = camring.open_study(folder).best
    assert max(best.outcome.constraints.values()) <= -SAFETY


def bits(folder):
    study = camring.open_study(folder)
    return [
        (record.trial, record.phase, record.point.tobytes(), repr(record.outcome))
        for record in study.records
    ], study.memory


def count_of(folder):
    return len(camring.open_study(folder).records)


def test_a_killed_and_interrupted_study_ends_with_the_same_bits(tmp_path, finished):
    whole, document, _ = finished
    folder = tmp_path / "study"
    arguments = ["optimise", EXAMPLE, "--out", folder, "--budget", BUDGET]
    for count in (1, 26, BUDGET - 2):
        killed = stopped(signal.SIGKILL, count, *arguments)
        assert killed.code == -signal.SIGKILL
        assert count_of(folder) == count
        arguments = ["resume", folder]
    # Ctrl-C while programs are loaded or compiled, which no Python code can cut short.
    interrupted = stopped(signal.SIGINT, "loading", *arguments)
    assert interrupted.code == 130
    assert interrupted.used_since < 1.5
    assert "Traceback" not in interrupted.said
    process = start("resume", folder, "--json")
    resumed, said = process.communicate()
    assert process.returncode == 0, said
    assert bits(folder) == bits(whole)
    assert (folder / "best.toml").read_bytes() == (whole / "best.toml").read_bytes()
    assert json.loads(resumed)["best"] == document["best"]


def test_ctrl_c_says_how_to_go_on(tmp_path, finished):
    whole, _, _ = finished
    folder = tmp_path / "study"
    shutil.copytree(whole, folder)
    interrupted = stopped(signal.SIGINT, BUDGET + 1, "resume", folder, "--budget", BUDGET + 100)
    assert interrupted.code == 130
    assert interrupted.used_since < 1.5
    said = f"Stopped with {count_of(folder)} evaluations kept; `camring resume {folder}` goes on."
    assert said in interrupted.said
    assert "Traceback" not in interrupted.said


def test_a_study_without_a_feasible_design_ends_with_exit_code_3(tmp_path):
    motor = tmp_path / "motor.toml"
    text = EXAMPLE.read_text()
    assert "[constraints]" in text
    lines = [line for line in text.splitlines() if not line.startswith("max_contact_stress")]
    text = "\n".join(lines).replace("[constraints]", '[constraints]\nmax_contact_stress = "1 MPa"')
    motor.write_text(text)
    folder = tmp_path / "study"
    process = start("optimise", motor, "--out", folder, "--budget", 3, "--no-theory", "--json")
    document, said = process.communicate()
    assert process.returncode == 3, said
    found = json.loads(document)
    assert found["best"] is None
    assert found["validated"] is False
    assert "max_contact_stress" in found["sentence"]
    assert not (folder / "best.toml").exists()
    assert (folder / "report.html").exists()


def test_a_search_that_learns_tells_of_its_surrogates_and_stays_what_it_is(tmp_path):
    """24 trials, then surrogates; a study from before there was a choice goes on with them."""
    folder = tmp_path / "study"
    finished = camring.optimise(EXAMPLE, folder, budget=34, method="bayesian", theory=False)
    study = camring.open_study(folder)
    assert len(study.records) == 34
    assert "initial" not in {record.phase for record in study.records[24:]}
    assert set(study.leave_one_out["errors"]) == {"plain", "rho = 1", "fitted rho"}
    assert finished.best is not None

    with sqlite3.connect(folder / "study.sqlite") as old:
        old.execute("DELETE FROM study WHERE key = 'method'")
        facts = old.execute("SELECT key, checksum FROM study ORDER BY key").fetchall()
        old.execute(
            "INSERT OR REPLACE INTO seal VALUES (?, ?, ?, ?)",
            verified.seal_row(len(study.records), facts),
        )
    old.close()
    camring.resume(folder, budget=35)
    assert "descent" not in camring.open_study(folder).records[-1].phase


def test_a_search_in_a_trust_region_goes_on_after_an_end(tmp_path):
    folder = tmp_path / "study"
    camring.optimise(EXAMPLE, folder, budget=16, method="scbo", theory=False)
    camring.resume(folder, budget=18)
    study = camring.open_study(folder)
    assert [record.phase for record in study.records][-4:] == ["scbo"] * 4
    assert set(study.leave_one_out["errors"]) == {"plain", "rho = 1", "fitted rho"}


def test_an_unknown_method_is_refused(tmp_path):
    with pytest.raises(camring.InputError, match=r"'slope'.*gradient, scbo, bayesian"):
        camring.optimise(EXAMPLE, tmp_path / "study", method="slope")
    assert not (tmp_path / "study").exists()


@pytest.mark.skipif(os.cpu_count() == 1, reason="a worker and the coordinator share the core")
def test_a_spawned_process_gives_the_same_design(tmp_path, finished):
    from camring.evaluation.executors import Workers

    whole, _, _ = finished
    with Workers(1) as executor:
        camring.optimise(EXAMPLE, tmp_path / "study", budget=3, executor=executor)
    ours, theirs = camring.open_study(tmp_path / "study"), camring.open_study(whole)
    for here, there in zip(ours.records, theirs.records, strict=False):
        assert here.point.tobytes() == there.point.tobytes()
        np.testing.assert_allclose(here.outcome.objective, there.outcome.objective, rtol=1e-12)

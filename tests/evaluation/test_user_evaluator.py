"""A user's own program as the evaluator of a study: believed, and survived."""

import json
import pickle
import sys
import time
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from motor_files import SOUND, added

import camring
from camring.evaluation.evaluator import MotorEvaluator
from camring.evaluation.outcome import failed
from camring.evaluation.user_programs import evaluator as user_evaluator
from camring.evaluation.user_programs.command import CommandFailed, UserCommand, read_answer
from camring.evaluation.user_programs.evaluator import (
    NAMES,
    UserEvaluator,
    from_fact,
    overlaid,
    to_fact,
)
from camring.files.errors import InputError
from camring.files.motor import parse_motor_file
from camring.objective.slopes import results_used
from camring.studies.validation import Validation

EXAMPLE = Path(__file__).parents[2] / "examples" / "derivation_motor.toml"
QUICK = [sys.executable, "-S", "-c"]  # a Python that starts at once


def program(line, timeout=20.0, folder="."):
    return UserCommand((*QUICK, line), timeout, str(folder))


def saying(text, **settings):
    return program(f"import sys; sys.stdin.read(); print({text!r})", **settings)


def reason_of(command):
    with pytest.raises(CommandFailed) as caught:
        command.results({}, NAMES, 2)
    return str(caught.value)


class TestTheAnswerOfAProgram:
    def test_is_read(self):
        said = saying('{"results": [{"efficiency": 0.9}, {"mean_torque": 100}]}')
        assert said.results({}, NAMES, 2) == [{"efficiency": 0.9}, {"mean_torque": 100.0}]

    @pytest.mark.parametrize(
        ("answer", "reason"),
        [
            ("", "nothing on stdout"),
            ("done", "not one JSON document; print anything else to stderr"),
            ("[1, 2]", 'no list "results"'),
            ('{"results": 3}', 'no list "results"'),
            ('{"results": [{}]}', "results of 1 operating points, but there are 2"),
            ('{"results": [{}, 3]}', "results[1] is 3"),
            ('{"results": [{}, {"eficiency": 1}]}', "you probably meant efficiency"),
            ('{"results": [{"efficiency": "high"}, {}]}', "results[0].efficiency is"),
            ('{"results": [{"efficiency": null}, {}]}', "no number"),
            ('{"results": [{"efficiency": true}, {}]}', "no number"),
            ('{"results": [{"efficiency": NaN}, {}]}', "efficiency is nan"),
            ('{"results": [{"efficiency": -Infinity}, {}]}', "efficiency is -inf"),
            ("[" * 100_000, "not one JSON document"),
        ],
    )
    def test_is_refused_with_a_reason(self, answer, reason):
        with pytest.raises(CommandFailed) as caught:
            read_answer(answer.encode(), NAMES, 2)
        assert reason in str(caught.value)

    def test_that_is_no_text_is_refused(self):
        with pytest.raises(CommandFailed, match="not one JSON"):
            read_answer(b"\xff\xfe\x00", NAMES, 2)

    def test_hears_the_question(self):
        echo = program(
            "import json, sys; q = json.load(sys.stdin);"
            "print(json.dumps({'results': [{'stroke': q['design']['stroke']}]}))"
        )
        question = {"design": {"stroke": 0.1 + 0.2}}
        assert echo.results(question, NAMES, 1) == [{"stroke": 0.1 + 0.2}]

    def test_may_come_without_hearing_it(self):
        deaf = program("print('{\"results\": [{}]}')")
        assert deaf.results({"design": "x" * 1_000_000}, NAMES, 1) == [{}]


class TestAProgramThatFails:
    def test_tells_its_exit_code_and_last_words(self):
        reason = reason_of(program("raise ValueError('mesh tangled')"))
        assert "exit code 1" in reason
        assert "mesh tangled" in reason

    def test_that_was_killed_tells_the_signal(self):
        assert "signal 9" in reason_of(program("import os; os.kill(os.getpid(), 9)"))

    def test_is_stopped_in_time_with_all_that_it_started(self, tmp_path):
        line = (
            "import subprocess, sys;"
            f"child = subprocess.Popen({[*QUICK, 'import time; time.sleep(60)']!r});"
            f"open({str(tmp_path / 'child')!r}, 'w').write(str(child.pid));"
            "child.wait()"
        )
        began = time.monotonic()
        assert "longer than 4 s" in reason_of(program(line, timeout=4.0))
        assert time.monotonic() - began < 30
        status = Path("/proc") / (tmp_path / "child").read_text() / "status"
        for _ in range(100):
            if not status.exists() or "State:\tZ" in status.read_text():
                return
            time.sleep(0.05)
        pytest.fail("what the program had started still runs")

    def test_that_is_none_is_refused_before_anything_begins(self, tmp_path):
        with pytest.raises(InputError, match="no program"):
            UserCommand(("no-such-program",), 1.0, str(tmp_path)).require_runnable()
        with pytest.raises(InputError, match="is gone"):
            program("", folder=tmp_path / "gone").require_runnable()


def test_a_command_survives_being_noted():
    command = program("print('ä \"quoted\"')", timeout=3.5)
    assert from_fact(to_fact(command)) == command
    assert pickle.loads(pickle.dumps(UserEvaluator("text", command))).command == command


class TestTheTableOfAFile:
    def test_is_read(self):
        text = added("[evaluator]", 'command = ["python", "my_model.py"]\ntimeout = "1 min"')
        table = parse_motor_file(text).evaluator
        assert (table.command, table.timeout) == (["python", "my_model.py"], 60.0)
        assert parse_motor_file(SOUND).evaluator is None

    @pytest.mark.parametrize(
        ("lines", "words"),
        [
            ('comand = ["python"]', "you probably meant"),
            ('timeout = "1 s"', "names neither of command and fmu"),
            ('fmu = "a.toml"\ncommand = ["a"]', "names both of command and fmu"),
            ("command = []", "evaluator.command has 0 items"),
            ('command = "python"', "must be a list"),
            ("command = [3]", r"evaluator.command, 1st value is 3"),
            ('command = ["python"]\ntimeout = "60 m"', "evaluator.timeout"),
            ('command = ["python"]\ntimeout = 0', "above zero"),
        ],
    )
    def test_is_checked_like_any_other(self, lines, words):
        with pytest.raises(InputError, match=words):
            parse_motor_file(added("[evaluator]", lines))

    def test_leaves_no_method_that_needs_slopes(self):
        text = added("[search]", 'method = "gradient"')
        with pytest.raises(InputError, match="needs slopes"):
            parse_motor_file(added("[evaluator]", 'command = ["python"]', text))


@pytest.fixture(scope="module")
def motor():
    """The wheel motor as its file gives it, and what our simulation says of it."""
    motor_file = camring.read_motor_file(EXAMPLE)
    point = motor_file.design_space.locate(motor_file.system)
    return motor_file, point, MotorEvaluator(motor_file.text)(point)


def test_a_program_that_says_nothing_leaves_our_simulation(motor):
    motor_file, point, ours = motor
    found = UserEvaluator(motor_file.text, saying('{"results": [{}, {}]}'))(point)
    assert found.results == ours.results
    assert found.constraints == ours.constraints
    assert found.objective == ours.objective
    assert found.approximation == ours.physical_objective


def test_its_results_enter_objective_and_limits(motor):
    motor_file, point, ours = motor
    lossy = saying(
        '{"results": [{"efficiency": 0.5, "max_contact_stress": 3.8e9}, {"efficiency": 0.5}]}'
    )
    found = UserEvaluator(motor_file.text, lossy)(point)
    shares = np.array([0.6, 0.4]) @ [each["efficiency"] - 0.5 for each in ours.results]
    assert found.physical_objective - ours.physical_objective == pytest.approx(shares)
    assert found.constraints["max_contact_stress"] == pytest.approx(1.0)  # 3.8 GPa of 1.9
    assert found.approximation == ours.physical_objective
    assert found.results[1]["efficiency"] == 0.5


def test_the_search_leans_only_where_our_simulation_stands(motor, monkeypatch):
    motor_file, point, _ = motor
    assessed = SimpleNamespace(
        faults=np.array([[0, 0], [0, 3]]), physical_objective=np.array([1.0, 2.0])
    )
    monkeypatch.setattr(user_evaluator, "evaluate_many", lambda *_, **__: assessed)
    found = UserEvaluator(motor_file.text, program("")).approximate(np.stack([point, point]))
    np.testing.assert_array_equal(found, [1.0, np.nan])


def test_our_failure_is_one_only_while_our_results_are_needed(motor):
    motor_file, _, ours = motor
    system, goal = motor_file.system, motor_file.goal
    blind = replace(ours, failure="no orbit", objective=np.nan, physical_objective=np.nan)
    assert "no orbit" in overlaid(system, goal, blind, [{}, {"efficiency": 0.9}]).failure
    everything = [{name: each[name] for name in results_used(goal)} for each in ours.results]
    found = overlaid(system, goal, blind, everything)
    assert found.failure is None
    assert found.objective == ours.objective
    assert np.isnan(found.approximation)


MOODS = """
import json, sys
from pathlib import Path
asked = json.load(sys.stdin)
assert "motor.valve_plate.shift" in asked["design"]
assert "control_radii" in Path(asked["motor_file"]).read_text()
counter = Path("counter")
count = int(counter.read_text()) if counter.exists() else 0
counter.write_text(str(count + 1))
if count == 1:
    sys.exit("licence server is down")
if count == 2:
    print("Iteration 1 ... converged")
    sys.exit()
print(json.dumps({"results": [{"efficiency": 0.9}] * asked["operating_points"]}))
"""


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    """A study that was stopped after three evaluations and taken up again for one more."""
    place = tmp_path_factory.mktemp("own")
    (place / "moods.py").write_text(MOODS)
    line = f'[evaluator]\ncommand = [{json.dumps(sys.executable)}, "-S", "moods.py"]\n'
    (place / "motor.toml").write_text(f"{EXAMPLE.read_text()}\n{line}")
    camring.optimise(
        place / "motor.toml", place / "study", budget=3, theory=False, allow_evaluator=True
    )
    return camring.resume(place / "study", budget=4)


def test_a_study_goes_on_past_failures_and_resumes(study):
    records = camring.open_study(study.folder).records
    assert [record.failed for record in records] == [False, True, True, False]
    assert "licence server is down" in records[1].outcome.failure
    assert "not one JSON document" in records[2].outcome.failure
    for record in (records[0], records[3]):
        assert [each["efficiency"] for each in record.outcome.results] == [0.9, 0.9]


def test_validation_asks_the_program_again_and_says_so(study):
    text = (study.folder / "validation.json").read_text()
    validation = Validation.from_json(text)
    assert "with efficiency from" in validation.sentence
    assert "checked by nothing else" in validation.sentence
    for eye in ("search", "finer", "independent"):
        assert validation.views["best"][eye]["results"][0]["efficiency"] == 0.9
    page = (study.folder / "report.html").read_text()
    assert "The designs were evaluated by" in page
    assert "90.00" in page  # its efficiency, not ours


def test_a_noisy_program_is_found_out(motor):
    from camring.studies.reference_processes import SecondSolver
    from camring.studies.validation import BEST, GIVEN, solve_again, validate

    motor_file, _, ours = motor
    with SecondSolver() as second:
        seen = solve_again(motor_file, second)
    again = {GIVEN: seen, BEST: seen}
    command = saying('{"results": [{"efficiency": 0.9}, {"efficiency": 0.9}]}')
    once = overlaid(motor_file.system, motor_file.goal, ours, [{"efficiency": 0.91}] * 2)
    found = validate(0, motor_file, motor_file, {GIVEN: once, BEST: once}, again, command)
    assert not found.validated
    assert "efficiency" in found.sentence
    claimed = {GIVEN: failed("timed out"), BEST: once}
    lost = validate(0, motor_file, motor_file, claimed, again, command)
    assert not lost.validated


def test_slopes_cannot_be_had_from_a_program(tmp_path):
    with pytest.raises(InputError, match="needs slopes"):
        camring.optimise(EXAMPLE, tmp_path / "a", method="gradient", evaluator="python x.py")
    with pytest.raises(InputError, match="without --evaluator"):
        camring.optimise(EXAMPLE, tmp_path / "b", timeout="5 s")
    with pytest.raises(InputError, match="quotation"):
        camring.optimise(EXAMPLE, tmp_path / "c", evaluator="python 'x.py")
    with pytest.raises(InputError, match="--timeout is"):
        camring.optimise(EXAMPLE, tmp_path / "d", evaluator="python x.py", timeout="5 parsec")
    with pytest.raises(InputError, match="one design after another"):
        camring.optimise(EXAMPLE, tmp_path / "e", batch=2)
    assert not list(tmp_path.iterdir())

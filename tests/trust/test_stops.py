"""Kills and Ctrl-C: nothing is left that looks complete, no process stays, and the end comes soon.

Instants drawn by the hundred, and every command, are those of `python -m benchmarks.trust`.
"""

import json
import random
import signal
import subprocess
import sys

import fake_study
import pytest
import working_command
from command_line import EXAMPLE
from processes import lives

from camring.evaluation.interrupt import EXIT_CODE
from camring.files.errors import InputError
from camring.files.new_file import whole_folder, write_new_file
from camring.files.whole_file import write_safely
from camring.report import contents
from camring.studies.study_folder import StudyFolder
from camring.workflows.layouts import _finished

SWEEP = ["sweep", EXAMPLE, "motor.valve_plate.shift=-1 deg..1 deg", "--points", 5, "--out"]
BUSY = """
import hashlib, threading
from camring.evaluation.interrupt import end_promptly
end_promptly()
threading.Timer(0.5, print, ["ready"], {"flush": True}).start()  # from within that step
hashlib.pbkdf2_hmac("sha256", b"a step of", b"half an hour", 10**9)
"""


def test_ctrl_c_ends_even_a_step_that_python_cannot_interrupt():
    """As a compilation is: it lets other threads run, and comes back when it has ended."""
    process = subprocess.Popen(
        [sys.executable, "-c", BUSY], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        assert process.stdout.readline() == "ready\n"
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=300)
    finally:
        process.kill()
    assert process.returncode == EXIT_CODE
    assert said == "camring: Interrupted.\n"


OUTSIDE = """
from camring.cli import app as cli
def interrupted():
    raise KeyboardInterrupt
cli.app = interrupted
cli.main()
"""
AT_THE_END = """
import atexit, os, signal
from camring.cli import app as cli
atexit.register(os.kill, os.getpid(), signal.SIGINT)
cli.app = lambda: None
cli.main()
"""


@pytest.mark.parametrize(
    ("program", "words"), [(OUTSIDE, "camring: Interrupted.\n"), (AT_THE_END, "")]
)
def test_ctrl_c_is_130_also_before_a_command_begins_and_after_it_has_ended(program, words):
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (EXIT_CODE, words)


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT])
def test_a_command_that_is_stopped_leaves_no_table_and_no_process(tmp_path, number):
    ended = working_command.run([*SWEEP, tmp_path / "out"], number, after=0.01)
    assert ended.code == (EXIT_CODE if number == signal.SIGINT else -number), ended.said
    assert ended.left == 0
    assert "Traceback" not in ended.said
    assert not (tmp_path / "out" / "sweep.csv").exists()


class Stop(BaseException):
    """What a kill is to the code below it, as near as Python comes."""


def fill(place, meanwhile, fault=None):
    with whole_folder(place) as draft:
        write_new_file(draft / "01.toml", "one")
        assert not place.exists()
        meanwhile()
        if fault is not None:
            raise fault


def test_a_folder_of_results_is_whole_or_not_there(tmp_path):
    place = tmp_path / "front"
    for fault, seen in ((Stop, Stop), (OSError, InputError), (InputError, InputError)):
        arguments = ("front", "is full", "make room") if fault is InputError else ()
        with pytest.raises(seen):
            fill(place, lambda: None, fault(*arguments))
        assert not list(tmp_path.iterdir())
    fill(place, lambda: None)
    assert [each.name for each in place.iterdir()] == ["01.toml"]
    with pytest.raises(InputError, match="exists"), whole_folder(place):
        pytest.fail("began beside another")
    assert (place / "01.toml").read_text() == "one"


def test_what_came_into_being_meanwhile_is_not_replaced(tmp_path):
    place = tmp_path / "front"

    def somebody_else():
        place.mkdir()
        (place / "other.toml").write_text("other")

    with pytest.raises(InputError, match="exists"):
        fill(place, somebody_else)
    assert [each.name for each in tmp_path.rglob("*.toml")] == ["other.toml"]


def test_a_study_that_goes_on_after_its_end_is_not_finished_until_it_ends_again(tmp_path):
    """`layouts` takes a finished study as it is: one that was killed while it went on is none."""
    study = tmp_path / "study"
    fake_study.run(study, budget=10)
    folder = StudyFolder.open(study, write=True)
    folder.store.note(budget="10", stopped="The budget of 10 evaluations is spent.")
    for path in (folder.validation_path, folder.report_path):
        write_safely(path, b"{}")
    folder.close()
    assert _finished(study, 10)
    assert not _finished(study, 20)
    folder = StudyFolder.open(study, write=True)
    folder.store.note(budget="20", stopped="")  # as `resume --budget 20` begins; then the kill
    folder.close()
    assert not _finished(study, 20)


@pytest.mark.parametrize("trial", [3, 7])
def test_a_validation_counts_for_the_design_that_it_looked_at_alone(tmp_path, trial):
    """Killed while it goes on, a study may have a better design than the one validated."""
    fake_study.run(tmp_path / "study", budget=10)
    folder = StudyFolder.open(tmp_path / "study", write=False)
    record = next(each for each in folder.store.records() if each.trial == 3)
    document = {"trial": trial, "validated": True, "sentence": "Validated.", "checks": []}
    write_safely(folder.validation_path, json.dumps(document).encode())
    found, overtaken = contents._verdict_on(folder, record, [1.0], damaged=False)
    folder.close()
    assert found.validated == (trial == 3) == (not overtaken)
    assert found.validated or found.sentence == contents.OVERTAKEN


def test_a_study_killed_at_drawn_instants_is_the_one_that_nobody_killed(tmp_path):
    from benchmarks.trust.study_kills import BUDGET, _killed

    fake_study.run(tmp_path / "whole", BUDGET)
    study, chance = tmp_path / "study", random.Random(7)
    for _ in range(3):
        _killed(study, chance)
    fake_study.run(study, BUDGET)
    assert fake_study.sequence(study) == fake_study.sequence(tmp_path / "whole")


def test_the_harness_sees_a_process_that_stays(tmp_path):
    """Or its zeros would show nothing."""
    token = "a token of this test"
    process = subprocess.Popen(
        [sys.executable, "-S", "-c", "import time; time.sleep(60)"],
        env={working_command.MARK: token},
    )
    try:
        assert lives(process.pid)
        assert working_command.living(token) == [process.pid]
    finally:
        process.kill()
        process.wait()
    assert working_command.living(token) == []

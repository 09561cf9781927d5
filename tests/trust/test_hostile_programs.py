"""A program that evaluates designs may do what it likes: it costs its time and nothing more."""

import os
import resource
import sys
import time

import pytest
from processes import lives, wait_for

from camring.evaluation.user_programs.bounded_program import (
    KEPT_WORDS,
    LONGEST_ANSWER,
    CommandFailed,
)
from camring.evaluation.user_programs.command import UserCommand
from camring.evaluation.user_programs.process import FunctionFailed, UserProcess

QUICK = (sys.executable, "-S", "-c")  # a Python that starts at once
ANSWER = 'print(\'{"results": [{"efficiency": 0.9}]}\', flush=True)'
ENDLESS = "import sys\nwhile True: sys.{stream}.write('x' * 65536)"
# Leaves a process that has no parent, no group and no terminal of ours, and keeps our pipes.
TO_THE_BACKGROUND = """
import os, sys, time
if os.fork() == 0:
    os.setsid()
    if os.fork() == 0:
        open(sys.argv[1], "w").write(str(os.getpid()))
        time.sleep(600)
    os._exit(0)
while not os.path.exists(sys.argv[1]) or not open(sys.argv[1]).read():
    time.sleep(0.01)
"""


def command(line, *words, timeout=30.0):
    return UserCommand((*QUICK, line, *map(str, words)), timeout, ".")


def answered(program):
    return program.results({}, ("efficiency",), 1)


def reason_of(program):
    with pytest.raises(CommandFailed) as caught:
        answered(program)
    return str(caught.value)


def largest_memory():
    """Of this process so far, bytes; macOS counts in bytes, Linux in 1024 of them."""
    unit = 1 if sys.platform == "darwin" else 1024
    return unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def test_what_prints_without_end_is_stopped_at_its_first_ten_megabytes():
    before, began = largest_memory(), time.monotonic()
    assert f"more than {LONGEST_ANSWER:,} bytes" in reason_of(
        command(ENDLESS.format(stream="stdout"), timeout=600.0)
    )
    assert time.monotonic() - began < 60
    assert largest_memory() - before < 10 * LONGEST_ANSWER


def test_what_complains_without_end_is_stopped_in_time_and_its_last_words_are_kept():
    before = largest_memory()
    said = reason_of(command(ENDLESS.format(stream="stderr"), timeout=1.0))
    assert "longer than 1 s" in said
    assert largest_memory() - before < 100 * KEPT_WORDS
    words = "import sys; sys.stderr.write('x' * 1_000_000 + '\\nmesh tangled\\n'); sys.exit(3)"
    assert reason_of(command(words)).endswith("exit code 3: mesh tangled")


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("import time; time.sleep(600)", "longer than 0.5 s"),
        ("import sys, os, time; os.close(1); os.close(2); time.sleep(600)", "longer than 0.5 s"),
        (f"{ANSWER}\nimport time; time.sleep(600)", "longer than 0.5 s"),
    ],
)
def test_what_never_ends_is_stopped_whatever_it_has_closed_or_answered(line, words):
    began = time.monotonic()
    assert words in reason_of(command(line, timeout=0.5))
    assert time.monotonic() - began < 20


@pytest.mark.parametrize(
    ("line", "words"),
    [
        (f"{ANSWER}\n{ANSWER}", "not one JSON document"),
        ('print(\'{"results": [{"efficiency": NaN}]}\')', "efficiency is nan"),
        ('print(\'{"results": [{"efficiency": 1e999}]}\')', "efficiency is inf"),
        ('print(\'{"results": [{"efficiency": 1\' + "0" * 400 + "}]}")', "beyond all others"),
        ('print(\'{"results": [{"efficiency": -1\' + "0" * 4000 + "}]}")', "beyond all others"),
        ("print('all is well')", "not one JSON document"),
        ("import os; os.write(1, bytes(range(256)))", "not one JSON document"),
        ("import os; os.abort()", "ended by signal 6"),
        ("import os; os._exit(0)", "nothing on stdout"),
    ],
)
def test_what_answers_twice_or_nonsense_or_dies_is_a_failed_evaluation(line, words):
    assert words in reason_of(command(line))


@pytest.mark.skipif(not os.path.isdir("/proc/self"), reason="processes are found in /proc")
@pytest.mark.parametrize("then", [ANSWER, "raise SystemExit(3)", "time.sleep(600)"])
def test_what_goes_to_the_background_ends_with_its_evaluation(tmp_path, then):
    """And its answer is taken at once, though the child still holds the pipe."""
    program = command(TO_THE_BACKGROUND + then, tmp_path / "child", timeout=20.0)
    began = time.monotonic()
    if then == ANSWER:
        assert answered(program) == [{"efficiency": 0.9}]
        assert time.monotonic() - began < 15
    else:
        program = UserCommand(program.words, 2.0, ".")
        reason_of(program)
    wait_for(lambda: not lives((tmp_path / "child").read_text()))


@pytest.mark.skipif(not os.path.isdir("/proc/self"), reason="processes are found in /proc")
def test_a_program_that_runs_camring_passes_the_mark_of_its_own_evaluation_on(monkeypatch):
    from camring.evaluation.child_processes import MARK, environment_with, new_mark

    monkeypatch.setenv(MARK, "1-a.0.")
    inner = new_mark()
    assert environment_with(inner)[MARK].split() == ["1-a.0.", inner]


def start_and_stay(path):
    """What a function with a timeout may do: start a process and wait for it."""
    import subprocess

    child = subprocess.Popen([*QUICK, "import time; time.sleep(600)"])
    with open(path, "w") as file:
        file.write(str(child.pid))
    child.wait()


def test_what_a_function_has_started_ends_with_its_time(tmp_path):
    process = UserProcess(start_and_stay, 5.0)
    with pytest.raises(FunctionFailed, match="longer than 5 s"):
        process(str(tmp_path / "child"))
    wait_for(lambda: not lives((tmp_path / "child").read_text()))

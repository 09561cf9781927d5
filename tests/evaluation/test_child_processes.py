"""Nothing that camring started outlives it, `kill -9` included."""

import subprocess
import sys

import pytest
from processes import PROCESSES, lives, wait_for

# Each notes its process and would stay for an hour.
MODEL = """
import os, subprocess, sys, time
def stay(path):
    with open(path + ".new", "w") as file:
        file.write(str(os.getpid()))
    os.rename(path + ".new", path)
    time.sleep(3600)
if __name__ == "__main__":
    if len(sys.argv) > 2:
        subprocess.run([sys.executable, "-S", __file__, sys.argv[1]])
    stay(sys.argv[1])
"""

UNKNOWN = "a command before it is known"
PROGRAM = """
import os, sys
from camring.evaluation.executors import Workers
from camring.evaluation.user_programs.command import UserCommand
from camring.evaluation.user_programs.process import UserProcess
from staying import stay

def command(*words):
    return UserCommand((sys.executable, "-S", "staying.py", "noted", *words), 3600.0, ".")

if __name__ == "__main__":
    kind = sys.argv[1]
    if kind == "a command":
        command().results({}, (), 0)
    elif kind == "a command before it is known":
        from camring.evaluation import child_processes

        def die(group):
            while not os.path.exists("noted"):
                pass
            os.kill(os.getpid(), 9)

        child_processes.tie = die
        command().results({}, (), 0)
    elif kind == "what a command has started":
        command("as a child").results({}, (), 0)
    elif kind == "a function with a timeout":
        UserProcess(stay, 3600.0)("noted")
    elif kind == "a worker":
        Workers(1).submit(stay, "noted").result()
    elif kind == "the command of a worker":
        Workers(1).submit(command().results, {}, (), 0).result()
"""


@pytest.mark.parametrize(
    "kind",
    [
        "a command",
        UNKNOWN,
        "what a command has started",
        "a function with a timeout",
        "a worker",
        "the command of a worker",
    ],
)
def test_a_kill_leaves_no_evaluation_behind(tmp_path, kind):
    if kind == UNKNOWN and not PROCESSES.exists():
        pytest.skip("only /proc says what a process has in its environment")
    (tmp_path / "staying.py").write_text(MODEL)
    (tmp_path / "program.py").write_text(PROGRAM)
    process = subprocess.Popen([sys.executable, "program.py", kind], cwd=tmp_path)
    try:
        wait_for((tmp_path / "noted").exists)
        staying = int((tmp_path / "noted").read_text())
        assert lives(staying) or kind == UNKNOWN  # whose parent has gone already
    finally:
        process.kill()
        process.wait()
    wait_for(lambda: not lives(staying))

"""A command of `camring` as a process of its own, from the text that is under the hand."""

import os
import subprocess
import sys
from pathlib import Path
from typing import IO

from camring.studio.memory import place_of

RUN = "from camring.cli.app import main; main()"


def given_file(text: str, motor: Path) -> Path:
    """The text as a file that a command can read, under the name of its motor file."""
    given = place_of(motor).with_suffix(".given") / motor.name
    given.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    given.write_text(text, encoding="utf-8")
    return given


def begun(words: list[str], folder: Path, out: IO[bytes], errors: IO[bytes]) -> subprocess.Popen:
    """The process, in a folder; without a terminal nobody can agree to a foreign evaluator."""
    return subprocess.Popen(
        [sys.executable, "-c", RUN, *words],
        stdin=subprocess.DEVNULL,
        stdout=out,
        stderr=errors,
        cwd=folder,
        start_new_session=True,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )


def complaint(said: str) -> str:
    """The last sentence in which a command says why it ended."""
    lines = [line for line in said.splitlines() if line.startswith("camring: ")]
    return (lines[-1].removeprefix("camring: ") if lines else said[-600:]).strip()

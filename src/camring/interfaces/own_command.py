"""A user's own program: one JSON document in, one out, never trusted, never waited for too long."""

import contextlib
import json
import math
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any

from camring.interfaces.errors import InputError, quote
from camring.interfaces.leash import tied

LONGEST_ANSWER = 10_000_000  # bytes
Results = list[dict[str, float]]


class CommandFailed(Exception):
    """The program gave no results; the text says why."""


@dataclass(frozen=True)
class OwnCommand:
    """How to run it; travels to other processes.

    Attributes
    ----------
    words
        Program and arguments.
    timeout
        Seconds after which it is stopped, with whatever it started.
    folder
        Where it runs, so that the names of files in the command mean what they meant.
    """

    words: tuple[str, ...]
    timeout: float
    folder: str

    def __str__(self) -> str:
        return " ".join(self.words)

    def require_runnable(self) -> None:
        """Raises `InputError` when there is no such program or folder."""
        if not os.path.isdir(self.folder):
            raise InputError(
                self.folder,
                f"is gone, where `{self}` was to run",
                "bring the folder back, or begin a new study with --evaluator",
            )
        if self._program() is None:
            raise InputError(
                "evaluator.command",
                f"begins with {quote(self.words[0])}, which is no program on the search path "
                f"or in {self.folder}",
                "name a program that can be run, as a full path if need be",
            )

    def results(self, document: Mapping[str, Any], names: Sequence[str], places: int) -> Results:
        """What the program answers to a document: results by name, for each operating point.

        Parameters
        ----------
        names
            Results that there are.

        Raises
        ------
        CommandFailed
            When it cannot be run, fails, takes too long, or answers with anything else.
        """
        return read_answer(self._answer(json.dumps(document)), names, places)

    def _program(self) -> str | None:
        first = self.words[0]
        if os.path.dirname(first):
            path = os.path.join(self.folder, first)
            return path if os.access(path, os.X_OK) and os.path.isfile(path) else None
        # Many systems have no `python` but the one that runs this.
        return shutil.which(first) or (sys.executable if first == "python" else None)

    def _answer(self, question: str) -> bytes:
        program = self._program()
        if program is None:
            raise CommandFailed(f"there is no program {quote(self.words[0])}")
        try:
            process = subprocess.Popen(
                [program, *self.words[1:]],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                cwd=self.folder,
                start_new_session=True,  # so that what it starts can be stopped with it
            )
        except OSError as error:
            raise CommandFailed(f"it cannot be started ({error.strerror})") from None
        try:
            with tied(process.pid):
                answer, said = process.communicate(question.encode(), timeout=self.timeout)
        except subprocess.TimeoutExpired:
            raise CommandFailed(f"it took longer than {self.timeout:g} s and was stopped") from None
        finally:
            _stop(process)
        if process.returncode != 0:
            how = (
                f"it was ended by signal {-process.returncode}"
                if process.returncode < 0
                else f"it ended with exit code {process.returncode}"
            )
            raise CommandFailed(how + _last_words(said))
        return answer


def _stop(process: subprocess.Popen) -> None:
    """Ends a program and everything that it started and left behind."""
    with contextlib.suppress(ProcessLookupError, PermissionError):
        if hasattr(os, "killpg"):
            os.killpg(process.pid, signal.SIGKILL)
        elif process.poll() is None:
            process.kill()
    process.wait()
    for stream in (process.stdin, process.stdout, process.stderr):
        if stream is not None:
            with contextlib.suppress(OSError):
                stream.close()


def _last_words(said: bytes) -> str:
    lines = [line.strip() for line in said.decode("utf-8", "replace").splitlines()]
    last = next((line for line in reversed(lines) if line), "")
    printed = "".join(c for c in last if c.isprintable())[:200]
    return f": {printed}" if printed else ""


def read_answer(answer: bytes, names: Sequence[str], places: int) -> Results:
    """Results by name for each operating point; see `OwnCommand.results`."""
    if len(answer) > LONGEST_ANSWER:
        raise CommandFailed(f"it answered with {len(answer):,} bytes, more than {LONGEST_ANSWER:,}")
    if not answer.strip():
        raise CommandFailed("it answered with nothing on stdout")
    try:
        document = json.loads(answer)
    except (ValueError, RecursionError):
        shown = quote(answer[:100].decode("utf-8", "replace"))
        raise CommandFailed(
            f"its answer {shown} is not one JSON document; print anything else to stderr"
        ) from None
    if not isinstance(document, dict) or not isinstance(document.get("results"), list):
        raise CommandFailed('its answer has no list "results"')
    results = document["results"]
    if len(results) != places:
        raise CommandFailed(
            f"it gave results of {len(results)} operating points, but there are {places}"
        )
    return [_record(each, names, place) for place, each in enumerate(results)]


def _record(given: Any, names: Sequence[str], place: int) -> dict[str, float]:
    where = f"results[{place}]"
    if not isinstance(given, dict):
        raise CommandFailed(f"{where} is {quote(given)}, not a table of names and numbers")
    for name, value in given.items():
        if name not in names:
            close = get_close_matches(name, names, n=1)
            hint = f"; you probably meant {close[0]}" if close else ""
            raise CommandFailed(f"{where} has {quote(name)}, which is no result{hint}")
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise CommandFailed(f"{where}.{name} is {quote(value)}, which is no number")
        if not math.isfinite(value):
            raise CommandFailed(f"{where}.{name} is {value}")
    return {name: float(value) for name, value in given.items()}

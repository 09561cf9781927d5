"""A user's own program: one JSON document in, one out, never trusted, never waited for too long."""

import json
import math
import os
import shlex
import shutil
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any

from camring.evaluation.user_programs.bounded_program import CommandFailed, run
from camring.files.errors import InputError, quote
from camring.files.named_units import Named, in_si
from camring.files.visible import visible

Results = list[dict[str, float]]


@dataclass(frozen=True)
class UserCommand:
    """How to run it; travels to other processes.

    Attributes
    ----------
    words
        Program and arguments.
    timeout
        Seconds after which it is stopped, with whatever it started.
    folder
        Where it runs, so that the names of files in the command mean what they meant.
    units
        Results that it gives in another unit than SI, and which.
    """

    words: tuple[str, ...]
    timeout: float
    folder: str
    units: Named = ()

    def __str__(self) -> str:
        return visible(" ".join(self.words))

    def shown(self) -> str:
        """Every word, quoted as a shell wants it, in signs that a terminal cannot be led by."""
        return visible(shlex.join(self.words))

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
        """What the program answers to a document: SI results by name, for each operating point.

        Parameters
        ----------
        names
            Results that there are.

        Raises
        ------
        CommandFailed
            When it cannot be run, fails, takes too long, or answers with anything else.
        """
        found = read_answer(self._answer(json.dumps(document)), names, places)
        return [in_si(each, self.units) for each in found]

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
        ended = run([program, *self.words[1:]], self.folder, question.encode(), self.timeout)
        if ended.code != 0:
            how = (
                f"it was ended by signal {-ended.code}"
                if ended.code < 0
                else f"it ended with exit code {ended.code}"
            )
            raise CommandFailed(how + _last_words(bytes(ended.said)))
        return bytes(ended.answer)


def _last_words(said: bytes) -> str:
    lines = [line.strip() for line in said.decode("utf-8", "replace").splitlines()]
    last = next((line for line in reversed(lines) if line), "")
    printed = "".join(c for c in last if c.isprintable())[:200]
    return f": {printed}" if printed else ""


def read_answer(answer: bytes, names: Sequence[str], places: int) -> Results:
    """Results by name for each operating point; see `UserCommand.results`."""
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
        if isinstance(value, int) and abs(value) > sys.float_info.max:
            raise CommandFailed(f"{where}.{name} is a whole number beyond all others")
        if not math.isfinite(value):
            raise CommandFailed(f"{where}.{name} is {value}")
    return {name: float(value) for name, value in given.items()}

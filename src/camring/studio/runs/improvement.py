""" "Improve this": `camring optimise` as a process of its own, followed through its database.

Pausing and stopping are Ctrl-C, which loses no evaluation; going on is `camring resume`. So a
study outlives the page and the server, and everything shown here can be had on the command
line.
"""

import contextlib
import math
import shlex
import signal
import subprocess
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from camring.evaluation.record import Record, best_of
from camring.files.errors import CamringError, InputError
from camring.files.motor import read_motor_file
from camring.studies.study_folder import StudyFolder
from camring.studio.runs.command_process import begun, complaint, given_file

EVERY = 0.4  # seconds between two reads of the database
LAST_WORDS = 600  # characters of what a process said before it failed
PATIENCE = 10.0  # seconds for a process that was asked to stop

Say = Callable[[dict[str, Any]], None]


@dataclass(eq=False)
class Improvement:
    """One study that runs, is paused or has ended; `say` is called from a thread of its own."""

    folder: Path
    say: Say
    budget: int
    state: str = "none"
    sentence: str = ""
    _child: subprocess.Popen | None = None
    _log: Path | None = None
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def begin(self, text: str, motor: Path, seed: int | None) -> None:
        """Starts the search from a text, under the name of its motor file."""
        if self.running:
            raise InputError("a study", "is running already", "stop it first")
        self._start(["optimise", str(given_file(text, motor)), *self._options(seed)])

    def go_on(self) -> None:
        """Resumes what was paused."""
        if not self.running:
            self._start(["resume", str(self.folder), "--budget", str(self.budget)])

    def stop(self, state: str = "stopped") -> None:
        """Asks the process to end as Ctrl-C does; what was evaluated stays."""
        with self._lock:
            child = self._child
            if child is None or child.poll() is not None:
                return
            self.state = state
            with contextlib.suppress(OSError):
                child.send_signal(signal.SIGINT)

    def end(self) -> None:
        """At the end of the server."""
        self.stop("paused")
        if self._child is not None:
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._child.wait(PATIENCE)

    @property
    def running(self) -> bool:
        return self._child is not None and self._child.poll() is None

    def command(self, motor: str, seed: int | None) -> str:
        """What does the same at a terminal."""
        return shlex.join(["camring", "optimise", motor, *self._options(seed)])

    def _options(self, seed: int | None) -> list[str]:
        options = ["--out", str(self.folder), "--budget", str(self.budget)]
        return options if seed is None else [*options, "--seed", str(seed)]

    def _start(self, words: list[str]) -> None:
        self._log = self.folder.parent / f".{self.folder.name}.log"
        with self._log.open("wb") as log:
            self._child = begun(words, self.folder.parent, log, log)
        self.state, self.sentence = "starting", ""
        threading.Thread(target=self._watch, name="camring-studio-study", daemon=True).start()

    def _watch(self) -> None:
        child, seen = self._child, -1
        assert child is not None
        while True:
            over = child.poll() is not None
            records = self.records()
            if records and self.state == "starting":
                self.state = "running"
            if over:
                self._ended(child.returncode)
            if over or len(records) != seen:
                seen = len(records)
                self.say(self.standing(records))
            if over:
                return
            time.sleep(EVERY)

    def _ended(self, code: int) -> None:
        said = ""
        with contextlib.suppress(OSError):
            if self._log is not None:
                said = self._log.read_text(encoding="utf-8", errors="replace")[-LAST_WORDS:]
                self._log.unlink()
        if self.state in ("paused", "stopped"):
            self.sentence = "Every evaluation is kept; it can go on at any time."
        elif code in (0, 3):
            self.state = "done"
            self.sentence = _verdict(said)
        else:
            self.state = "failed"
            self.sentence = complaint(said)

    def records(self) -> list[Record]:
        """Every evaluation so far."""
        try:
            study = StudyFolder.open(self.folder, write=False)
        except (CamringError, OSError):
            return []
        try:
            return study.store.records()
        except CamringError:
            return []
        finally:
            study.close()

    def standing(self, records: Sequence[Record]) -> dict[str, Any]:
        """How far it has come, for the page."""
        best = best_of(records)
        return {
            "type": "study",
            "state": self.state,
            "sentence": self.sentence,
            "folder": self.folder.name,
            "budget": self.budget,
            "trials": [_row(each) for each in records],
            "best": None if best is None else best.trial,
        }

    def design(self, trial: int | None) -> tuple[str, int]:
        """The motor file of a trial, or of the best so far, and which it is."""
        records = self.records()
        record = (
            best_of(records)
            if trial is None
            else next((each for each in records if each.trial == trial), None)
        )
        if record is None:
            raise InputError("the study", "has no such design yet", "wait for the next one")
        file = read_motor_file(self.folder / "given.toml")
        return file.with_design(record.point.tolist()), record.trial


def _row(record: Record) -> list[Any]:
    """Trial, objective, ripple and efficiency at the first operating point, whether it is kept."""
    results = record.outcome.results[0] if record.outcome.results else {}
    numbers = (
        record.outcome.physical_objective,
        results.get("torque_ripple", math.nan),
        results.get("efficiency", math.nan),
    )
    finite = [each if math.isfinite(each) else None for each in numbers]
    return [record.trial, *finite, record.feasible]


def _verdict(said: str) -> str:
    lines = [line.strip() for line in said.splitlines() if line.strip()]
    return next((line for line in lines if "alidated" in line), lines[-1] if lines else "")

"""`camring pareto` and `camring tolerance` of the design in the hand, each a process of its own."""

import contextlib
import json
import shlex
import signal
import subprocess
import tempfile
import threading
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from camring.files.errors import InputError
from camring.studio.runs.command_process import begun, complaint, given_file
from camring.studio.runs.improvement import PATIENCE, Say

POINTS, MOST_POINTS = 20, 200
SAMPLES, MOST_SAMPLES = 1024, 65_536


@dataclass(eq=False)
class Analysis:
    """One run; `say` is called from a thread of its own.

    Attributes
    ----------
    kind
        `pareto` or `tolerance`.
    of
        Of a front: the results that are traded, with commas between.
    count
        Of a front its designs, of tolerances the motors that are built.
    """

    folder: Path
    say: Say
    kind: str
    of: str
    count: int
    state: str = "running"
    sentence: str = ""
    found: dict[str, Any] = field(default_factory=dict)
    _child: subprocess.Popen | None = None

    @classmethod
    def of_message(cls, folder: Path, say: Say, message: Mapping[str, Any]) -> "Analysis":
        """As a page asks for it.

        Raises
        ------
        InputError
            For a kind that there is not.
        """
        kind = str(message.get("kind"))
        if kind not in ("pareto", "tolerance"):
            raise InputError(repr(kind), "is no analysis", "choose pareto or tolerance")
        usual, least, most = (
            (POINTS, 3, MOST_POINTS) if kind == "pareto" else (SAMPLES, 16, MOST_SAMPLES)
        )
        count = min(max(int(message.get("count") or usual), least), most)
        return cls(folder, say, kind, str(message.get("of") or "torque_ripple,efficiency"), count)

    def command(self, motor: str) -> str:
        """What does the same at a terminal."""
        return shlex.join(["camring", *self._words(motor, self.folder.name)])

    def _words(self, motor: str, folder: str) -> list[str]:
        if self.kind == "pareto":
            return ["pareto", motor, "--of", self.of, "--points", str(self.count), "--out", folder]
        return ["tolerance", motor, "--samples", str(self.count), "--out", folder]

    def begin(self, text: str, motor: Path) -> None:
        """Starts from a text, under the name of its motor file."""
        words = self._words(str(given_file(text, motor)), str(self.folder))
        with contextlib.ExitStack() as files:
            out, errors = (files.enter_context(tempfile.TemporaryFile()) for _ in range(2))
            more = ["--json"] if self.kind == "pareto" else []
            self._child = begun([*words, *more], self.folder.parent, out, errors)
            # The thread ends when the process has, and closes what the process wrote into.
            kept = files.pop_all()

        def watch() -> None:
            assert self._child is not None
            with kept:
                code = self._child.wait()
                out.seek(0)
                errors.seek(0)
                self._ended(code, *(each.read().decode(errors="replace") for each in (out, errors)))
            self.say(self.message())

        threading.Thread(target=watch, name="camring-analysis", daemon=True).start()

    def stop(self) -> None:
        """Asks the process to end as Ctrl-C does."""
        child = self._child
        if child is not None and child.poll() is None:
            self.state = "stopped"
            with contextlib.suppress(OSError):
                child.send_signal(signal.SIGINT)

    def end(self) -> None:
        """At the end of the server."""
        self.stop()
        if self._child is not None:
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._child.wait(PATIENCE)

    @property
    def running(self) -> bool:
        return self._child is not None and self._child.poll() is None

    def _ended(self, code: int, out: str, errors: str) -> None:
        if self.state == "stopped":
            return
        if code not in (0, 3) or not out.strip():
            self.state, self.sentence = "failed", complaint(errors)
        elif self.kind == "tolerance":
            self.state, self.found = "done", {"text": out}
        else:
            said = json.loads(out)
            values = [[each["values"][name] for name in said["of"]] for each in said["designs"]]
            given = [said["given"][name] for name in said["of"]]
            self.found = {"of": said["of"], "designs": values, "given": given}
            self.state = "done"
            self.sentence = (
                f"{len(values)} designs, none beaten by another, every limit kept"
                f"{'' if code == 0 else '; SciPy’s solver does not agree on all of them'}."
                " Results are means of the operating points, highest values those of the worst."
            )

    def message(self) -> dict[str, Any]:
        """How far it has come, for the page."""
        return {
            "type": "analysis",
            "kind": self.kind,
            "state": self.state,
            "sentence": self.sentence,
            "folder": self.folder.name,
            **self.found,
        }

    def design(self, number: int) -> str:
        """The motor file of a design of the front, counted from 1.

        Raises
        ------
        InputError
            Where there is none of that number.
        """
        from camring.presentation.pareto import DESIGNS  # brings SciPy, which a page can do without

        if self.state != "done" or not 1 <= number <= len(self.found.get("designs", ())):
            raise InputError(f"design {number}", "is not in this front", "choose one that is drawn")
        return (self.folder / DESIGNS / f"{number:02d}.toml").read_text(encoding="utf-8")

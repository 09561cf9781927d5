"""`kill -9` and Ctrl-C of whole commands, at instants drawn from their evaluations.

After each the output is either not there, or is byte for byte the one of a run that nobody
stopped; what can go on does so and ends as that one did. No process of the command's is left.
"""

import argparse
import random
import shutil
import signal
import statistics
import tempfile
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import working_command
from motor_files import with_line

from camring.evaluation.unfinished import place_of
from camring.studies.study_folder import StudyFolder

ROOT = Path(__file__).parents[2]
MOTOR = ROOT / "examples" / "derivation_motor.toml"
TOLERANCES = """
[tolerances]
"motor.valve_plate.shift" = "0.2 deg"
"motor.bore" = "20 um"
"""
COMMANDS: dict[str, list[object]] = {
    "optimise": ["optimise", "small.toml", "--budget", 34, "--out"],
    "layouts": ["layouts", "small.toml", "--pistons", 8, "--lobes", 6, "--budget", 8, "--out"],
    "pareto": ["pareto", "small.toml", "--of", "torque_ripple,efficiency", "--points", 3, "--out"],
    "robust": ["robust", "small.toml", "--samples", 8, "--checked", 64, "--budget", 40, "--out"],
    "tolerance": ["tolerance", "small.toml", "--samples", 40_000, "--out"],
    "map": ["map", MOTOR, "--points", "6x6", "--force", "--out"],
    "sweep": ["sweep", MOTOR, "motor.valve_plate.shift=-1 deg..1 deg", "--force", "--out"],
    "export": ["export", MOTOR, "--force", "--out"],
}
STUDIES = ("optimise", "layouts")
WITHIN = 1.0  # s from Ctrl-C to the end


@dataclass
class Tally:
    """What came of the runs of one command."""

    counts: Counter[str] = field(default_factory=Counter)
    took: list[float] = field(default_factory=list)
    wrong: int = 0

    def mark(self, words: str, number: int) -> None:
        print(f"  run {number}: {words}")
        self.wrong += 1


def kills(asked: argparse.Namespace) -> int:
    """So many kills of each command; how many left anything wrong."""
    return _measured(asked, signal.SIGKILL)


def interrupts(asked: argparse.Namespace) -> int:
    """So many times Ctrl-C to each command; how many left anything wrong."""
    return _measured(asked, signal.SIGINT)


def _measured(asked: argparse.Namespace, number: signal.Signals) -> int:
    wrong = 0
    for name in asked.of or COMMANDS:
        with tempfile.TemporaryDirectory() as folder:
            wrong += _of_one(name, Path(folder), asked, number)
    return wrong


def _of_one(name: str, folder: Path, asked: argparse.Namespace, number: signal.Signals) -> int:
    small = with_line('name = "small"', MOTOR.read_text()) + TOLERANCES
    (folder / "small.toml").write_text(small)
    words, chance, tally = COMMANDS[name], random.Random(f"{name} {asked.seed}"), Tally()
    working_command.run([*words, "warm"], cwd=folder)  # what has to be compiled is compiled here
    whole = working_command.run([*words, "whole"], cwd=folder)
    if whole.code not in (0, 3):
        print(f"{name}: ends with {whole.code} unstopped: {whole.said[-300:]}")
        return 1
    state = _state_of(name)
    expected = state(folder / "whole")
    if not expected:
        print(f"{name}: leaves nothing unstopped, so that a stop shows nothing")
        return 1
    if state(folder / "warm") != expected:
        print(f"{name}: two runs that nobody stopped differ, so that bytes show nothing")
        return 1
    for run in range(asked.count):
        place = folder / f"run{run}"
        after = chance.random() * whole.worked
        ended = working_command.run([*words, place.name], number, after, folder)
        if ended.code in (0, 3):
            tally.counts["ended before"] += 1
        _look(name, place, ended, number, tally, run, expected)
        again = [*words, place.name]
        if (name == "optimise" and place.exists()) or place_of(place).exists():
            again = ["resume", place.name]
        working_command.run(again, cwd=folder)
        if state(place) != expected:
            tally.mark("what it ends as when it goes on is another", run)
        if place_of(place).exists():
            tally.mark("what it computed stays beside what it has made", run)
        shutil.rmtree(place, ignore_errors=True)
    slowest = f"; ended within {max(tally.took):.2f} s, " if tally.took else ""
    middle = f"median {statistics.median(tally.took):.2f} s" if tally.took else ""
    print(f"{name}: {asked.count} runs, {dict(tally.counts)}; {tally.wrong} wrong{slowest}{middle}")
    return tally.wrong


def _look(
    name: str,
    place: Path,
    ended: working_command.Ended,
    number: signal.Signals,
    tally: Tally,
    run: int,
    expected: dict[str, bytes],
) -> None:
    """At what a stopped command has left."""
    if ended.left:
        tally.mark(f"{ended.left} processes are left", run)
    stopped = ended.code not in (0, 3)
    if stopped and number == signal.SIGINT:
        tally.took.append(ended.took)
        if ended.code != 130 or ended.took > WITHIN:
            tally.mark(f"exit code {ended.code} after {ended.took:.2f} s", run)
    if not stopped:
        return
    kept = "left what it had computed" if place_of(place).exists() else "left nothing"
    tally.counts["left a folder" if place.exists() else kept] += 1
    if name in STUDIES or not place.exists():
        return
    for path, content in _files(place).items():
        if content != expected.get(path):
            tally.mark(f"{path} is there and is not what it should be", run)


def _state_of(name: str) -> Callable[[Path], dict[str, bytes]]:
    return _designs if name in STUDIES else _files


def _designs(folder: Path) -> dict[str, bytes]:
    """Every evaluation of the studies in a folder, and their best motors, to the bit."""
    found = {}
    for path in sorted(folder.rglob("study.sqlite")):
        study = StudyFolder.open(path.parent, write=False)
        records = study.store.records()
        study.close()
        rows = [
            (each.trial, each.phase, each.point.tobytes(), repr(each.outcome)) for each in records
        ]
        where = str(path.parent.relative_to(folder))
        found[where] = repr(rows).encode()
        best = path.parent / "best.toml"
        found[f"{where}/best.toml"] = best.read_bytes() if best.exists() else b""
    return found


def _files(folder: Path) -> dict[str, bytes]:
    """Every file by its path; hidden ones are drafts, which nobody takes for results."""
    return {
        str(path.relative_to(folder)): _lasting(path)
        for path in sorted(folder.rglob("*"))
        if path.is_file() and not any(part.startswith(".") for part in path.parts[-2:])
    }


def _lasting(path: Path) -> bytes:
    """What of a file is the same in every run: a DXF notes its second, and ends with a word."""
    content = path.read_bytes()
    if path.suffix == ".dxf" and content.rstrip().endswith(b"EOF"):
        return b"whole"
    return content

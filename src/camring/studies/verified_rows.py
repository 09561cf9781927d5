"""What a study's database holds, each part compared with its checksum as it is read.

Whatever does not match is left out and named; nothing that was altered is ever handed on.
"""

import json
import math
import sqlite3
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from camring.evaluation.outcome import EnvelopeNumbers, Outcome
from camring.evaluation.record import Record
from camring.files.checksums import Cell, checksum

COLUMNS = "trial, phase, state, point, outcome, started, seconds, checksum"
UNVERIFIED = "unverified"
"""The fact that says how many evaluations were kept by a camring without checksums."""
_INFINITE = "\u0000infinite"


@dataclass(frozen=True)
class Kept:
    """All of a study that is sound, at one instant.

    Attributes
    ----------
    damage
        What is not, a clause each: `evaluation 17 does not match its checksum`.
    unverified
        The first so many evaluations were kept without checksums.
    """

    records: list[Record] = field(default_factory=list)
    facts: dict[str, str] = field(default_factory=dict)
    memory: dict[str, Any] = field(default_factory=dict)
    damage: tuple[str, ...] = ()
    unverified: int = 0

    def remarks(self) -> list[str]:
        """What a reader must know of it, a sentence each; nothing when all is sound."""
        found = []
        if self.damage:
            found.append(f"The study is damaged, and this left out: {'; '.join(self.damage)}.")
        if self.unverified:
            found.append(
                f"The first {self.unverified} evaluations were kept by an older camring without "
                "checksums: whether they are as they were written cannot be verified."
            )
        return found


def row_of(record: Record) -> tuple[Cell, ...]:
    """An evaluation as the database keeps it, its checksum last."""
    cells: tuple[Cell, ...] = (
        record.trial,
        record.phase,
        "failed" if record.failed else "complete",
        np.asarray(record.point, dtype="<f8").tobytes(),
        _json_of(_document(record.outcome)),
        float(record.started),
        float(record.seconds),
    )
    return (*cells, checksum(*cells))


def record_of(row: Sequence[Any]) -> Record:
    """The inverse of `row_of`, of a row whose checksum has been compared.

    Raises
    ------
    ValueError, TypeError, KeyError
        When its content is not what a camring of this version writes.
    """
    trial, phase, _, point, outcome, started, seconds, _ = row
    found = json.loads(outcome)
    return Record(
        trial=trial,
        phase=phase.decode(),
        point=np.frombuffer(point, dtype="<f8").astype(float),
        outcome=Outcome(
            objective=_number(found["objective"]),
            constraints=_numbers(found["constraints"]),
            physical_objective=_number(found["physical_objective"]),
            approximation=_number(found["approximation"]),
            terms=tuple(map(_numbers, found["terms"])),
            results=tuple(map(_numbers, found["results"])),
            design=found["design"],
            failure=found["failure"],
            envelope=_envelope(found.get("envelope")),
        ),
        started=started,
        seconds=seconds,
    )


def read(connection: sqlite3.Connection) -> Kept:
    """Everything, from within one transaction."""
    rows, damage = verified_rows(connection)
    records = []
    for row in rows:
        try:
            records.append(record_of(row))
        except (ValueError, TypeError, KeyError, AttributeError):
            damage.append(f"evaluation {row[0]} cannot be read")
    facts, of_facts = read_facts(connection)
    memory, of_memory = read_memory(connection)
    unverified = facts.get(UNVERIFIED, "0")
    return Kept(
        records,
        facts,
        memory,
        (*damage, *of_facts, *of_memory),
        int(unverified) if unverified.isdecimal() else len(records),
    )


def damage_in(connection: sqlite3.Connection) -> list[str]:
    """What is not as it was kept, without making anything of it."""
    _, damage = verified_rows(connection)
    return [*damage, *read_facts(connection)[1], *read_memory(connection)[1]]


def verified_rows(connection: sqlite3.Connection) -> tuple[list[Sequence[Any]], list[str]]:
    """Rows of evaluations that match their checksums, and what is damaged or missing."""
    count, damage = _count(connection)
    query = f"SELECT {COLUMNS} FROM evaluation"
    try:
        found = connection.execute(f"{query} ORDER BY trial").fetchall()
    except sqlite3.DatabaseError:
        # A page that cannot be read ends a whole reading: one by one, the others can be had.
        found = []
        for trial in range(count):
            try:
                found += connection.execute(f"{query} WHERE trial = ?", (trial,)).fetchall()
            except sqlite3.DatabaseError:
                continue
        if not found:
            raise
    sound = {row[0]: row for row in found if checksum(*row[:-1]) == row[-1]}
    seen = {row[0] for row in found}
    damage += _mismatched([trial for trial in seen if trial not in sound])
    missing = sorted(set(range(count)) - seen)
    if missing:
        verb = "is" if len(missing) == 1 else "are"
        damage.append(f"{_listed(missing)} {verb} missing")
    if not damage and len(sound) != count:
        damage.append(f"there are {len(sound)} evaluations where {count} were kept")
    return [sound[trial] for trial in sorted(sound)], damage


def read_facts(connection: sqlite3.Connection) -> tuple[dict[str, str], list[str]]:
    """Facts that match their checksums, and what is damaged or missing."""
    rows = connection.execute("SELECT key, value, checksum FROM study ORDER BY key").fetchall()
    facts: dict[str, str] = {}
    damage: list[str] = []
    for key, value, kept in rows:
        if checksum(key, value) == kept:
            facts[key.decode()] = value.decode()
        else:
            damage.append(f"the fact {_printable(key)} does not match its checksum")
    seal = _seal(connection)
    if not damage and seal is not None and seal[1] != seal_of_facts(rows):
        damage.append("a fact about the study is missing")
    return facts, damage


def read_memory(connection: sqlite3.Connection) -> tuple[dict[str, Any], list[str]]:
    """What the search remembered with the last evaluation, and whether that is damaged."""
    row = connection.execute("SELECT trial, content, checksum FROM memory").fetchone()
    seal = _seal(connection)
    count = 0 if seal is None else seal[0]
    if row is None:
        return {}, ["what the search remembers is missing"] if count else []
    trial, content, kept = row
    if checksum(trial, content) != kept:
        return {}, ["what the search remembers does not match its checksum"]
    if seal is not None and trial != count - 1:
        return {}, [f"what the search remembers belongs to evaluation {trial}"]
    return json.loads(content), []


def memory_row(trial: int, memory: Mapping[str, Any]) -> tuple[Cell, ...]:
    """What a search remembers as the database keeps it, its checksum last."""
    content = json.dumps(memory)
    return 0, trial, content, checksum(trial, content)


def fact_row(key: str, value: str) -> tuple[Cell, ...]:
    return key, value, checksum(key, value)


def seal_row(count: int, facts: Iterable[Sequence[Any]]) -> tuple[Cell, ...]:
    """How many evaluations there are and which facts, its checksum last."""
    of_facts = seal_of_facts(facts)
    return 0, count, of_facts, checksum(count, of_facts)


def seal_of_facts(rows: Iterable[Sequence[Any]]) -> bytes:
    """Of all facts together, in order of their keys, so that one that is missing shows."""
    return checksum(*(row[-1] for row in rows))


def _seal(connection: sqlite3.Connection) -> tuple[int, bytes] | None:
    """Count and facts; None when they cannot be believed."""
    row = connection.execute("SELECT evaluations, facts, checksum FROM seal").fetchone()
    if row is None or checksum(*row[:-1]) != row[-1]:
        return None
    return row[0], row[1]


def _count(connection: sqlite3.Connection) -> tuple[int, list[str]]:
    seal = _seal(connection)
    if seal is not None:
        return seal[0], []
    row = connection.execute("SELECT count(*), max(trial) FROM evaluation").fetchone()
    rows, last = row[0], -1 if row[1] is None else row[1]
    # A last trial far beyond the number of rows is itself damaged.
    count = last + 1 if last < 10 * rows + 100 else rows
    return count, ["the count of evaluations does not match its checksum"]


def _mismatched(trials: Sequence[Any]) -> list[str]:
    if not trials:
        return []
    if len(trials) == 1:
        return [f"{_listed(trials)} does not match its checksum"]
    return [f"{_listed(trials)} do not match their checksums"]


def _listed(trials: Sequence[Any]) -> str:
    """`evaluation 17`, `evaluations 3, 5 to 9`."""
    numbers = sorted(trial for trial in trials if isinstance(trial, int))
    runs: list[list[int]] = []
    for number in numbers:
        if runs and number == runs[-1][1] + 1:
            runs[-1][1] = number
        else:
            runs.append([number, number])
    words = [str(a) if a == b else f"{a} to {b}" for a, b in runs]
    return f"evaluation{'s' * (len(trials) != 1)} {', '.join(words)}"


def _printable(key: Any) -> str:
    text = key.decode("utf-8", "replace") if isinstance(key, bytes) else str(key)
    return '"' + "".join(each if each.isprintable() else "?" for each in text)[:40] + '"'


def _document(outcome: Outcome) -> dict[str, Any]:
    """Its fields; `dataclasses.asdict` would copy every number first."""
    envelope = None if outcome.envelope is None else vars(outcome.envelope)
    return {**vars(outcome), "envelope": envelope}


def _json_of(document: Mapping[str, Any]) -> str:
    try:
        return json.dumps(document, allow_nan=False)
    except (ValueError, TypeError):  # not a number, or an infinite one; a mapping of another kind
        text = json.dumps(_plain(document), allow_nan=False)
    # JSON has no infinity, but a number beyond every float is read as one, by SQLite too.
    quoted = json.dumps(_INFINITE)[:-1]
    return text.replace(f'{quoted}"', "9e999").replace(f'{quoted}-"', "-9e999")


def _plain(value: Any) -> Any:
    if isinstance(value, float) and not math.isfinite(value):
        if math.isnan(value):
            return None
        return _INFINITE if value > 0 else f"{_INFINITE}-"
    if isinstance(value, Mapping):
        return {key: _plain(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    return value


def _envelope(given: Mapping[str, Any] | None) -> EnvelopeNumbers | None:
    if given is None:
        return None
    limits, results = (
        {name: [_number(each) for each in values] for name, values in given[part].items()}
        for part in ("limits", "results")
    )
    return EnvelopeNumbers(limits, results, _number(given["share"]), _numbers(given["operating"]))


def _number(value: float | None) -> float:
    return math.nan if value is None else float(value)


def _numbers(given: Mapping[str, float | None]) -> dict[str, float]:
    return {name: _number(value) for name, value in given.items()}

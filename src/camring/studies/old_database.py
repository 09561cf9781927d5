"""Studies of the first camrings, which kept no checksums: read, and renewed when gone on with."""

import json
import math
import sqlite3
from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from camring.evaluation.outcome import Outcome
from camring.evaluation.record import Record
from camring.studies import verified_rows as verified
from camring.studies.database import SCHEMA, VERSION

_Groups = dict[int, dict[int, dict[str, float]]]


def read(connection: sqlite3.Connection) -> verified.Kept:
    """Everything, from within one transaction; what cannot be read is named and left out."""
    damage: list[str] = []
    constraints: dict[int, dict[str, float]] = defaultdict(dict)
    for trial, name, value in connection.execute(
        "SELECT trial, name, value FROM constraint_value ORDER BY rowid"
    ):
        constraints[trial][_text(name)] = _number(value)
    terms, results = _grouped(connection, "term"), _grouped(connection, "result")
    rows = connection.execute(
        "SELECT trial, phase, point, design, objective, physical_objective, approximation,"
        " failure, started, seconds FROM evaluation ORDER BY trial"
    ).fetchall()
    records = []
    for row in rows:
        try:
            records.append(_record(row, constraints, terms, results))
        except (ValueError, TypeError, AttributeError):
            damage.append(f"evaluation {row[0]} cannot be read")
    facts = {
        _text(key): _text(value)
        for key, value in connection.execute("SELECT key, value FROM study")
    }
    memory: dict[str, Any] = {}
    last = len(rows) - 1
    kept = connection.execute("SELECT trial, content FROM memory").fetchone()
    try:
        if kept is not None:
            memory, last = json.loads(kept[1]), kept[0]
    except (ValueError, TypeError):
        damage.append("what the search remembers cannot be read")
    if [row[0] for row in rows] != list(range(len(rows))) or last != len(rows) - 1:
        damage.append(f"evaluations are missing beside the {len(rows)} that are there")
    return verified.Kept(records, facts, memory, tuple(damage), len(records))


def renew(connection: sqlite3.Connection, kept: verified.Kept) -> None:
    """Makes the database one of this version, from within a transaction."""
    for table in ("constraint_value", "term", "result", "evaluation", "memory", "study"):
        connection.execute(f"DROP TABLE {table}")
    for statement in SCHEMA.split(";\n"):
        if statement.strip():
            connection.execute(statement)
    connection.executemany(
        "INSERT INTO evaluation VALUES (?, ?, ?, ?, ?, ?, ?, ?)", map(verified.row_of, kept.records)
    )
    if kept.records:
        connection.execute(
            "INSERT INTO memory VALUES (?, ?, ?, ?)",
            verified.memory_row(kept.records[-1].trial, kept.memory),
        )
    facts = {**kept.facts, verified.UNVERIFIED: str(len(kept.records))}
    rows = [verified.fact_row(key, facts[key]) for key in sorted(facts, key=str.encode)]
    connection.executemany("INSERT INTO study VALUES (?, ?, ?)", rows)
    connection.execute(
        "INSERT INTO seal VALUES (?, ?, ?, ?)", verified.seal_row(len(kept.records), rows)
    )
    connection.execute(f"PRAGMA user_version = {VERSION}")


def _record(
    row: Sequence[Any],
    constraints: Mapping[int, dict[str, float]],
    terms: _Groups,
    results: _Groups,
) -> Record:
    (
        trial, phase, point, design, objective, physical, approximation, failure, started, seconds,
    ) = row  # fmt: skip
    return Record(
        trial=trial,
        phase=phase.decode(),
        point=np.frombuffer(point, dtype="<f8").astype(float),
        outcome=Outcome(
            objective=_number(objective),
            constraints=constraints.get(trial, {}),
            physical_objective=_number(physical),
            approximation=_number(approximation),
            terms=_in_order(terms.get(trial, {})),
            results=_in_order(results.get(trial, {})),
            design=json.loads(design),
            failure=None if failure is None else failure.decode(),
        ),
        started=float(started),
        seconds=float(seconds),
    )


def _grouped(connection: sqlite3.Connection, table: str) -> _Groups:
    groups: _Groups = defaultdict(lambda: defaultdict(dict))
    for trial, place, name, value in connection.execute(
        f"SELECT trial, operating_point, name, value FROM {table} ORDER BY rowid"
    ):
        groups[trial][place][_text(name)] = _number(value)
    return groups


def _text(value: Any) -> str:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def _number(value: Any) -> float:
    return math.nan if not isinstance(value, int | float) else float(value)


def _in_order(groups: Mapping[int, dict[str, float]]) -> Sequence[dict[str, float]]:
    return tuple(groups[place] for place in sorted(groups))

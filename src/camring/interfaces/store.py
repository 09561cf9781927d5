"""The study's database: every evaluation and the search's memory, one transaction each.

SQLite in write-ahead mode with `synchronous = FULL`: when `append` has returned,
the evaluation and the memory that goes with it survive `kill -9` and the loss of
power alike, and whoever opens the file next sees both or neither.
"""

import json
import math
import sqlite3
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from camring.interfaces import database
from camring.interfaces.record import Outcome, Record


class Store:
    """One open database; use it from one thread.

    Every method raises `StudyError` or `InputError` when the file cannot be
    read or written, with the reason in words.
    """

    def __init__(self, folder: Path, connection: sqlite3.Connection) -> None:
        self.folder = folder
        self._connection = connection

    @classmethod
    def create(cls, folder: Path, study: Mapping[str, str]) -> "Store":
        """A new database that holds what the study is about and no evaluation."""
        with database.errors_in_words(folder):
            store = cls(folder, database.create(folder))
        store.note(**study)
        return store

    @classmethod
    def open(cls, folder: Path, *, write: bool) -> "Store":
        """The database of an existing study.

        Raises
        ------
        InputError
            When it is no study's database, or a version this program does not know.
        """
        with database.errors_in_words(folder):
            return cls(folder, database.open_existing(folder, write=write))

    def append(
        self, record: Record, memory: Mapping[str, Any], facts: Mapping[str, str] | None = None
    ) -> None:
        """Keeps one evaluation, the memory that goes with it and new facts; all or nothing."""
        trial, outcome = record.trial, record.outcome
        row = (
            trial,
            record.phase,
            "failed" if record.failed else "complete",
            np.asarray(record.point, dtype="<f8").tobytes(),
            json.dumps(dict(outcome.design)),
            outcome.objective,
            outcome.physical_objective,
            outcome.approximation,
            outcome.failure,
            record.started,
            record.seconds,
        )
        with (
            database.errors_in_words(self.folder),
            database.transaction(self._connection) as connection,
        ):
            connection.execute(f"INSERT INTO evaluation VALUES ({', '.join('?' * len(row))})", row)
            connection.executemany(
                "INSERT INTO constraint_value VALUES (?, ?, ?)",
                [(trial, name, value) for name, value in outcome.constraints.items()],
            )
            for table, numbers in (("term", outcome.terms), ("result", outcome.results)):
                connection.executemany(
                    f"INSERT INTO {table} VALUES (?, ?, ?, ?)",
                    [
                        (trial, place, name, value)
                        for place, group in enumerate(numbers)
                        for name, value in group.items()
                    ],
                )
            connection.execute(
                "INSERT OR REPLACE INTO memory VALUES (0, ?, ?)", (trial, json.dumps(memory))
            )
            connection.executemany(
                "INSERT OR REPLACE INTO study VALUES (?, ?)", (facts or {}).items()
            )

    def records(self) -> list[Record]:
        """Every evaluation in order of trial, bit for bit as it was appended."""
        # One transaction, so that a reader beside a running study sees one instant.
        with database.errors_in_words(self.folder), database.snapshot(self._connection):
            constraints: dict[int, dict[str, float]] = defaultdict(dict)
            for trial, name, value in self._connection.execute(
                "SELECT trial, name, value FROM constraint_value ORDER BY rowid"
            ):
                constraints[trial][name] = _number(value)
            terms, results = self._grouped("term"), self._grouped("result")
            rows = self._connection.execute(
                "SELECT trial, phase, point, design, objective, physical_objective, approximation,"
                " failure, started, seconds FROM evaluation ORDER BY trial"
            ).fetchall()
        return [
            Record(
                trial=trial,
                phase=phase,
                point=np.frombuffer(point, dtype="<f8").astype(float),
                outcome=Outcome(
                    objective=_number(objective),
                    constraints=constraints[trial],
                    physical_objective=_number(physical),
                    approximation=_number(approximation),
                    terms=_in_order(terms[trial]),
                    results=_in_order(results[trial]),
                    design=json.loads(design),
                    failure=failure,
                ),
                started=started,
                seconds=seconds,
            )
            for (
                trial, phase, point, design, objective, physical, approximation,
                failure, started, seconds,
            ) in rows
        ]  # fmt: skip

    def memory(self) -> dict[str, Any]:
        """What the search remembered with the last evaluation; empty before the first."""
        with database.errors_in_words(self.folder):
            row = self._connection.execute("SELECT content FROM memory").fetchone()
        return json.loads(row[0]) if row else {}

    def note(self, **facts: str) -> None:
        """Writes facts about the study itself, replacing those of the same name."""
        with (
            database.errors_in_words(self.folder),
            database.transaction(self._connection) as connection,
        ):
            connection.executemany("INSERT OR REPLACE INTO study VALUES (?, ?)", facts.items())

    def facts(self) -> dict[str, str]:
        """What is noted about the study itself."""
        with database.errors_in_words(self.folder):
            return dict(self._connection.execute("SELECT key, value FROM study"))

    def close(self) -> None:
        """Folds the write-ahead log into the one file and lets go of it."""
        with database.errors_in_words(self.folder):
            self._connection.close()

    @contextmanager
    def _writing(self) -> Iterator[sqlite3.Connection]:
        with (
            database.errors_in_words(self.folder),
            database.transaction(self._connection) as connection,
        ):
            yield connection

    def _grouped(self, table: str) -> dict[int, dict[int, dict[str, float]]]:
        groups: dict[int, dict[int, dict[str, float]]] = defaultdict(lambda: defaultdict(dict))
        for trial, place, name, value in self._connection.execute(
            f"SELECT trial, operating_point, name, value FROM {table} ORDER BY rowid"
        ):
            groups[trial][place][name] = _number(value)
        return groups


def _number(value: float | None) -> float:
    return math.nan if value is None else value


def _in_order(groups: Mapping[int, dict[str, float]]) -> Sequence[dict[str, float]]:
    places: Iterable[int] = sorted(groups)
    return tuple(groups[place] for place in places)

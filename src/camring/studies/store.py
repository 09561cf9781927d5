"""The study's database: every evaluation and the search's memory, one transaction each.

SQLite in write-ahead mode with `synchronous = FULL`: when `append` has returned,
the evaluation and the memory that goes with it survive `kill -9` and the loss of
power alike, and whoever opens the file next sees both or neither. Every evaluation, fact
and memory stands beside its checksum, and how many there are is kept as well: what a disk
or a copy has damaged or cut off is named and never taken for what was kept.
"""

import sqlite3
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from camring.evaluation.record import Record
from camring.studies import database, old_database
from camring.studies import verified_rows as verified
from camring.studies.database import StudyDamaged, StudyError
from camring.studies.verified_rows import Kept


class Store:
    """One open database; use it from one thread.

    Every method raises `StudyError` or `InputError` when the file cannot be
    read or written, with the reason in words; all but `sound` raise `StudyDamaged` when
    what they would give does not match its checksum.
    """

    def __init__(self, folder: Path, connection: sqlite3.Connection) -> None:
        self.folder = folder
        self._connection = connection
        self._identity = database.identity(folder)

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

        To be written, it must be sound in every part; one without checksums gets them.

        Raises
        ------
        InputError
            When it is no study's database, or a version this program does not know.
        StudyDamaged
            When it is to be written and any part of it is not what was kept.
        """
        with database.errors_in_words(folder):
            store = cls(folder, database.open_existing(folder, write=write))
            if write:
                try:
                    store._make_ready()
                except BaseException:
                    store._connection.close()
                    raise
            return store

    def append(
        self, record: Record, memory: Mapping[str, Any], facts: Mapping[str, str] | None = None
    ) -> None:
        """Keeps one evaluation, the memory that goes with it and new facts; all or nothing."""
        self.require_in_place()
        with self._writing() as connection:
            row = verified.row_of(record)
            connection.execute(f"INSERT INTO evaluation VALUES ({', '.join('?' * len(row))})", row)
            connection.execute(
                "INSERT OR REPLACE INTO memory VALUES (?, ?, ?, ?)",
                verified.memory_row(record.trial, memory),
            )
            _note(connection, facts or {}, more=1)

    def require_in_place(self) -> None:
        """Refuses to go on where the database at the study's path is no longer the open one.

        What is written into a file that was removed is lost when it is closed.

        Raises
        ------
        StudyError
            When the folder was removed, moved, or replaced by another or by a link to another.
        """
        if database.identity(self.folder) != self._identity:
            raise StudyError(
                f"The folder {self.folder} was removed, moved or replaced while the study ran: "
                f"what was kept before is where the folder is now; bring it back, then "
                f"`camring resume {self.folder}` goes on."
            )

    def records(self) -> list[Record]:
        """Every evaluation in order of trial, bit for bit as it was appended."""
        found = self.sound()
        self._require_sound(found.damage)
        return found.records

    def sound(self) -> Kept:
        """All that matches its checksum, and what does not in words."""
        # One transaction, so that a reader beside a running study sees one instant.
        with database.errors_in_words(self.folder), database.snapshot(self._connection):
            if database.version_of(self._connection) == database.WITHOUT_CHECKSUMS:
                return old_database.read(self._connection)
            return verified.read(self._connection)

    def memory(self) -> dict[str, Any]:
        """What the search remembered with the last evaluation; empty before the first."""
        with database.errors_in_words(self.folder), database.snapshot(self._connection):
            if database.version_of(self._connection) == database.WITHOUT_CHECKSUMS:
                return old_database.read(self._connection).memory
            memory, damage = verified.read_memory(self._connection)
        self._require_sound(damage)
        return memory

    def note(self, **facts: str) -> None:
        """Writes facts about the study itself, replacing those of the same name."""
        with self._writing() as connection:
            _note(connection, facts)

    def facts(self) -> dict[str, str]:
        """What is noted about the study itself."""
        facts, damage = self.sound_facts()
        self._require_sound(damage)
        return facts

    def sound_facts(self) -> tuple[dict[str, str], list[str]]:
        """Facts that match their checksums, and what does not in words."""
        with database.errors_in_words(self.folder), database.snapshot(self._connection):
            if database.version_of(self._connection) == database.WITHOUT_CHECKSUMS:
                return old_database.read(self._connection).facts, []
            return verified.read_facts(self._connection)

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

    def _make_ready(self) -> None:
        """Sound to its last page, and of this version."""
        (structure,) = self._connection.execute("PRAGMA quick_check(1)").fetchone()
        if structure != b"ok":
            self._require_sound([structure.decode("utf-8", "replace").splitlines()[-1]])
        if database.version_of(self._connection) == database.WITHOUT_CHECKSUMS:
            with database.transaction(self._connection) as connection:
                kept = old_database.read(connection)
                self._require_sound(kept.damage)
                old_database.renew(connection, kept)
            return
        with database.snapshot(self._connection):
            damage = verified.damage_in(self._connection)
        self._require_sound(damage)

    def _require_sound(self, damage: list[str] | tuple[str, ...]) -> None:
        if damage:
            raise StudyDamaged(self.folder, damage)


def _note(connection: sqlite3.Connection, facts: Mapping[str, str], more: int = 0) -> None:
    connection.executemany(
        "INSERT OR REPLACE INTO study VALUES (?, ?, ?)",
        [verified.fact_row(*each) for each in facts.items()],
    )
    kept = connection.execute("SELECT evaluations FROM seal").fetchone()
    rows = connection.execute("SELECT key, checksum FROM study ORDER BY key").fetchall()
    connection.execute(
        "INSERT OR REPLACE INTO seal VALUES (?, ?, ?, ?)",
        verified.seal_row((kept[0] if kept else 0) + more, rows),
    )

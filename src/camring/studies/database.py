"""The study's SQLite file: its tables, how it is opened, and its errors in words."""

import os
import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from camring.files.errors import CamringError, InputError

DATABASE_NAME = "study.sqlite"
APPLICATION = int.from_bytes(b"camr", "big")
VERSION = 2
WITHOUT_CHECKSUMS = 1
"""The version of the first camrings; `old_database` reads and renews it."""

SCHEMA = """
CREATE TABLE study (
    key TEXT PRIMARY KEY, value TEXT NOT NULL, checksum BLOB NOT NULL
) WITHOUT ROWID;
CREATE TABLE evaluation (
    trial INTEGER PRIMARY KEY,
    phase TEXT NOT NULL,
    state TEXT NOT NULL CHECK (state IN ('complete', 'failed')),
    point BLOB NOT NULL,            -- little-endian float64, unit box
    outcome TEXT NOT NULL,          -- JSON, SI; null stands for "not a number" throughout
    started REAL NOT NULL,          -- seconds since 1970, UTC
    seconds REAL NOT NULL,
    checksum BLOB NOT NULL          -- of all that stands before it
);
CREATE TABLE envelope (             -- JSON: limits and results at every point of the envelope
    trial INTEGER PRIMARY KEY, content TEXT NOT NULL
);
CREATE TABLE memory (               -- one row: what the search remembers after that trial
    only INTEGER PRIMARY KEY CHECK (only = 0), trial INTEGER NOT NULL, content TEXT NOT NULL,
    checksum BLOB NOT NULL
);
CREATE TABLE seal (                 -- one row: how many evaluations there are, and which facts
    only INTEGER PRIMARY KEY CHECK (only = 0), evaluations INTEGER NOT NULL,
    facts BLOB NOT NULL, checksum BLOB NOT NULL
);
CREATE VIEW objective AS            -- the views are for people with an SQL prompt
    SELECT trial, json_extract(outcome, '$.objective') AS objective,
           json_extract(outcome, '$.physical_objective') AS physical_objective,
           json_extract(outcome, '$.approximation') AS approximation,
           json_extract(outcome, '$.failure') AS failure FROM evaluation;
CREATE VIEW constraint_value AS     -- kept when at most 0
    SELECT trial, each.key AS name, each.value AS value
    FROM evaluation, json_each(outcome, '$.constraints') AS each;
CREATE VIEW term AS                 -- raw terms of the objective, before any weight
    SELECT trial, place.key AS operating_point, each.key AS name, each.value AS value
    FROM evaluation, json_each(outcome, '$.terms') AS place, json_each(place.value) AS each;
CREATE VIEW result AS               -- results of docs/theory.md section 10, SI
    SELECT trial, place.key AS operating_point, each.key AS name, each.value AS value
    FROM evaluation, json_each(outcome, '$.results') AS place, json_each(place.value) AS each;
"""


class StudyError(CamringError):
    """The study cannot go on; what is in it is safe."""


class StudyDamaged(InputError):
    """Something in the database is not what was kept there.

    Parameters
    ----------
    damage
        What is damaged, a clause each: `evaluation 17 does not match its checksum`.
    """

    def __init__(self, folder: Path, damage: Sequence[str]) -> None:
        self.damage = tuple(damage)
        super().__init__(
            str(folder / DATABASE_NAME),
            f"is damaged: {'; '.join(damage)}",
            f"bring it back from a copy, or begin a new study; `camring report {folder}` shows "
            "what is sound",
        )

    def __reduce__(self) -> tuple:
        return type(self), (Path(self.field).parent, self.damage)


def create(folder: Path) -> sqlite3.Connection:
    """A new database with empty tables, write-ahead and safe against loss of power."""
    connection = sqlite3.connect(folder / DATABASE_NAME, isolation_level=None)
    connection.text_factory = bytes
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("PRAGMA synchronous = FULL")
    connection.executescript(
        f"BEGIN; PRAGMA application_id = {APPLICATION}; PRAGMA user_version = {VERSION};"
        f"{SCHEMA} COMMIT;"
    )
    return connection


def open_existing(folder: Path, *, write: bool) -> sqlite3.Connection:
    """The database of an existing study; its version is one that this program knows.

    Text comes as bytes, which whoever reads compares with a checksum before decoding it.
    """
    path = folder / DATABASE_NAME
    if write:
        connection = _connect(f"{path.absolute().as_uri()}?mode=rw")
        connection.execute("PRAGMA synchronous = FULL")
    else:
        connection = _read_only(path)
    _require_known(connection, path)
    connection.text_factory = bytes
    return connection


def identity(folder: Path) -> tuple[int, int] | None:
    """Which file the database of a folder is, whatever its name; None where there is none."""
    try:
        status = os.stat(folder / DATABASE_NAME)
    except OSError:
        return None
    return status.st_dev, status.st_ino


def version_of(connection: sqlite3.Connection) -> int:
    (version,) = connection.execute("PRAGMA user_version").fetchone()
    return int(version)


@contextmanager
def transaction(connection: sqlite3.Connection) -> Iterator[sqlite3.Connection]:
    """Commits when its block ends well, rolls back when it does not."""
    connection.execute("BEGIN IMMEDIATE")
    try:
        yield connection
        connection.execute("COMMIT")
    except BaseException:
        if connection.in_transaction:
            connection.execute("ROLLBACK")
        raise


@contextmanager
def snapshot(connection: sqlite3.Connection) -> Iterator[None]:
    """All reading in its block sees the database at one instant."""
    connection.execute("BEGIN DEFERRED")
    try:
        yield
    finally:
        if connection.in_transaction:
            connection.execute("COMMIT")


@contextmanager
def errors_in_words(folder: Path) -> Iterator[None]:
    """Turns SQLite's errors into `StudyError` or `InputError`, each one sentence."""
    try:
        yield
    except sqlite3.Error as error:
        raise _in_words(error, folder) from error
    except UnicodeDecodeError as error:
        # SQLite quotes what it cannot read, and Python cannot decode the quotation.
        raise _unreadable(folder, "it holds text that is none") from error


def _in_words(error: sqlite3.Error, folder: Path) -> CamringError:
    name = getattr(error, "sqlite_errorname", None) or ""
    where = str(folder / DATABASE_NAME)
    # The log's index cannot grow (SHMSIZE) where nothing can.
    full = ("SQLITE_FULL", "SQLITE_IOERR_WRITE", "SQLITE_IOERR_FSYNC", "SQLITE_IOERR_SHMSIZE")
    if name in full:
        return StudyError(
            f"The disk of {folder} takes no more ({error}): every evaluation completed "
            f"before is kept; make room, then `camring resume {folder}` goes on."
        )
    if name.startswith(("SQLITE_READONLY", "SQLITE_CANTOPEN", "SQLITE_PERM")):
        return InputError(
            where,
            f"cannot be written ({error})",
            "get the right to write there, or copy the folder to where you have it",
        )
    if name.startswith(("SQLITE_BUSY", "SQLITE_LOCKED")):
        return InputError(where, "is in use by another program", "close that program and try again")
    if name.startswith(("SQLITE_IOERR_SHM", "SQLITE_IOERR_LOCK", "SQLITE_PROTOCOL")):
        return InputError(
            where,
            f"lies on a disk that keeps no locks ({error}), as some network disks do",
            "choose a place on a disk of this machine, and copy the study afterwards",
        )
    return _unreadable(folder, str(error))


def _unreadable(folder: Path, reason: str) -> InputError:
    printed = "".join(each if each.isprintable() else "?" for each in reason)
    return InputError(
        str(folder / DATABASE_NAME),
        f"is no readable study database ({printed})",
        "bring it back from a copy, or start a new study with `camring optimise`",
    )


def _connect(uri: str) -> sqlite3.Connection:
    return sqlite3.connect(uri, uri=True, isolation_level=None)


def _read_only(path: Path) -> sqlite3.Connection:
    uri = path.absolute().as_uri()
    connection = _connect(f"{uri}?mode=ro")
    try:
        connection.execute("SELECT count(*) FROM sqlite_master")
    except sqlite3.OperationalError:
        # On a disk that cannot be written there is no room for the log's index;
        # without a log the file alone is the whole truth.
        connection.close()
        if path.with_name(path.name + "-wal").exists():
            raise
        connection = _connect(f"{uri}?immutable=1")
    return connection


def _require_known(connection: sqlite3.Connection, path: Path) -> None:
    (application,) = connection.execute("PRAGMA application_id").fetchone()
    version = version_of(connection)
    if application != APPLICATION:
        raise InputError(
            str(path),
            "is a database of some other program",
            "name the folder of a camring study",
        )
    if version not in (WITHOUT_CHECKSUMS, VERSION):
        raise InputError(
            str(path),
            f"has version {version} but this camring knows versions {WITHOUT_CHECKSUMS} to "
            f"{VERSION} only",
            "use the camring that wrote it, or start a new study",
        )

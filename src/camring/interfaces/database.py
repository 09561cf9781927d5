"""The study's SQLite file: its tables, how it is opened, and its errors in words."""

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from camring.interfaces.errors import CamringError, InputError

DATABASE_NAME = "study.sqlite"
APPLICATION = int.from_bytes(b"camr", "big")
VERSION = 1

SCHEMA = """
CREATE TABLE study (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE evaluation (
    trial INTEGER PRIMARY KEY,
    phase TEXT NOT NULL,
    state TEXT NOT NULL CHECK (state IN ('complete', 'failed')),
    point BLOB NOT NULL,            -- little-endian float64, unit box
    design TEXT NOT NULL,           -- JSON: path in the motor file -> SI value
    objective REAL,                 -- NULL stands for "not a number" throughout
    physical_objective REAL,
    approximation REAL,
    failure TEXT,
    started REAL NOT NULL,          -- seconds since 1970, UTC
    seconds REAL NOT NULL
);
CREATE TABLE constraint_value (
    trial INTEGER NOT NULL, name TEXT NOT NULL, value REAL,  -- kept when at most 0
    PRIMARY KEY (trial, name)
);
CREATE TABLE term (                 -- raw terms of the objective, before any weight
    trial INTEGER NOT NULL, operating_point INTEGER NOT NULL, name TEXT NOT NULL, value REAL,
    PRIMARY KEY (trial, operating_point, name)
);
CREATE TABLE result (               -- results of model.md section 10, SI
    trial INTEGER NOT NULL, operating_point INTEGER NOT NULL, name TEXT NOT NULL, value REAL,
    PRIMARY KEY (trial, operating_point, name)
);
CREATE TABLE memory (               -- one row: what the search remembers after that trial
    only INTEGER PRIMARY KEY CHECK (only = 0), trial INTEGER NOT NULL, content TEXT NOT NULL
);
"""


class StudyError(CamringError):
    """The study cannot go on; what is in it is safe."""


def create(folder: Path) -> sqlite3.Connection:
    """A new database with empty tables, write-ahead and safe against loss of power."""
    connection = sqlite3.connect(folder / DATABASE_NAME, isolation_level=None)
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("PRAGMA synchronous = FULL")
    connection.executescript(
        f"BEGIN; PRAGMA application_id = {APPLICATION}; PRAGMA user_version = {VERSION};"
        f"{SCHEMA} COMMIT;"
    )
    return connection


def open_existing(folder: Path, *, write: bool) -> sqlite3.Connection:
    """The database of an existing study; its version is one that this program knows."""
    path = folder / DATABASE_NAME
    if write:
        connection = _connect(f"{path.absolute().as_uri()}?mode=rw")
        connection.execute("PRAGMA synchronous = FULL")
    else:
        connection = _read_only(path)
    _require_known(connection, path)
    return connection


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


def _in_words(error: sqlite3.Error, folder: Path) -> CamringError:
    name = getattr(error, "sqlite_errorname", None) or ""
    where = str(folder / DATABASE_NAME)
    if name in ("SQLITE_FULL", "SQLITE_IOERR_WRITE", "SQLITE_IOERR_FSYNC"):
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
    return InputError(
        where,
        f"is no readable study database ({error})",
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
    (version,) = connection.execute("PRAGMA user_version").fetchone()
    if application != APPLICATION:
        raise InputError(
            str(path),
            "is a database of some other program",
            "name the folder of a camring study",
        )
    if version != VERSION:
        raise InputError(
            str(path),
            f"has version {version} but this camring knows version {VERSION} only",
            "use the camring that wrote it, or start a new study",
        )

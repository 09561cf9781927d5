"""What a command has computed before it was stopped, in a file beside the folder that it fills.

`camring pareto --out front` keeps its answers in `front.unfinished` until `front` stands whole. The
same command again, or `camring resume front`, takes from there what it would compute again, and so
comes to the same designs, bit for bit. The first answer makes the file; the whole folder ends it.
"""

import contextlib
import io
import json
import os
import sqlite3
import threading
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np

from camring.evaluation.answers import Answer, Arrays
from camring.evaluation.interrupt import Interrupted
from camring.files.checksums import checksum
from camring.files.errors import CamringError, InputError
from camring.files.motor.document import printable
from camring.files.whole_file import draft_beside, settle, sync_names
from camring.version import __version__

SUFFIX = ".unfinished"
COMMANDS = ("pareto", "robust", "tolerance")
APPLICATION = int.from_bytes(b"camw", "big")
SCHEMA = """
CREATE TABLE request (only_one INTEGER PRIMARY KEY CHECK (only_one = 0), content TEXT NOT NULL);
CREATE TABLE answer (
    question BLOB PRIMARY KEY,      -- checksum of what was asked, and of which function
    content BLOB NOT NULL,          -- arrays as NumPy's .npz
    checksum BLOB NOT NULL          -- of both
) WITHOUT ROWID;
"""


@dataclass(frozen=True)
class Request:
    """A command as it was given: what it does follows from this alone.

    Attributes
    ----------
    motor, path
        Text of the motor file, and where it stood.
    options
        By their names in the command's function, as JSON has them.
    """

    command: str
    motor: str
    path: str
    options: Mapping[str, Any]
    version: str = __version__


class Unfinished:
    """The answers of one command, a context for the time in which it computes.

    What it has computed is kept, by Ctrl-C, a kill or the end of the block, until `done`; but an
    error that tells the user what is wrong with the request would come again, so then nothing is.

    Parameters
    ----------
    out
        The folder that the command fills; the file lies beside it.

    Raises
    ------
    InputError
        When the file is of another request, in use, or none of ours.
    """

    def __init__(self, out: Path, request: Request) -> None:
        self._out, self._request, self.place = out, request, place_of(out)
        self._connection: sqlite3.Connection | None = None
        self._busy = threading.Lock()
        self.known = 0
        if self.place.exists():
            if _request_in(self.place) != request:
                raise InputError(
                    printable(self.place),
                    "holds the work of another command, or of this motor file before it changed",
                    f"go on with that by `camring resume {out}`, give another --out, or remove it",
                )
            with self._in_words():
                self._connection = _opened(self.place)
                [[self.known]] = self._connection.execute("SELECT count(*) FROM answer")

    def __enter__(self) -> "Unfinished":
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: object) -> None:
        if self._connection is None:
            return  # what may lie there is another's
        self._connection.close()
        self._connection = None
        if isinstance(error, CamringError) and not isinstance(error, Interrupted):
            done(self._out)
        if isinstance(error, KeyboardInterrupt):
            raise Interrupted(
                f"Stopped, with what was computed kept in {printable(self.place)}; "
                f"`camring resume {self._out}` goes on."
            ) from error

    def remember(
        self, name: str, function: Callable[[np.ndarray], Answer]
    ) -> Callable[[np.ndarray], Answer]:
        """The function, of which every answer is kept; as `evaluation.answers.Remember`."""

        def asked(at: np.ndarray) -> Answer:
            question = checksum(name, str((at.dtype, at.shape)), at.tobytes())
            with self._busy:  # searches ask from threads of their own
                known = cast(Answer | None, self._answer(question))  # arrays as they were kept
            if known is None:
                known = function(at)
                with self._busy:
                    self._keep(question, known)
            return known

        return asked

    def _answer(self, question: bytes) -> Arrays | None:
        """None where there is none, or none that is what was kept."""
        if self._connection is None:
            return None
        with contextlib.suppress(sqlite3.Error, ValueError, OSError, KeyError):
            found = self._connection.execute(
                "SELECT content, checksum FROM answer WHERE question = ?", (question,)
            ).fetchone()
            if found and checksum(question, found[0]) == found[1]:
                with np.load(io.BytesIO(found[0]), allow_pickle=False) as arrays:
                    return tuple(arrays[f"arr_{k}"] for k in range(len(arrays.files)))
        return None

    def _keep(self, question: bytes, answer: Arrays) -> None:
        """A disk that takes no more costs the memory, not the work."""
        with self._in_words(), contextlib.suppress(sqlite3.OperationalError, OSError):
            if self._connection is None:
                self._connection = _made(self.place, self._request)
            file = io.BytesIO()
            np.savez(file, *answer)
            content = file.getvalue()
            self._connection.execute(
                "INSERT OR REPLACE INTO answer VALUES (?, ?, ?)",
                (question, content, checksum(question, content)),
            )

    @contextlib.contextmanager
    def _in_words(self) -> Iterator[None]:
        try:
            yield
        except sqlite3.DatabaseError as error:
            if self._connection is not None:
                self._connection.close()
                self._connection = None
            raise _unreadable(self.place, error) from error


def place_of(out: Path) -> Path:
    """Where the answers of a command that fills a folder are kept."""
    return out.with_name(out.name + SUFFIX)


def out_of(place: Path) -> Path:
    """The folder, of itself or of the file beside it."""
    return place.with_name(place.name.removesuffix(SUFFIX))


def done(out: Path) -> None:
    """The folder stands whole, and what was kept for it is in the way."""
    place_of(out).unlink(missing_ok=True)


def request_of(out: Path) -> Request | None:
    """The command that has not ended at a place; None where there is none.

    Raises
    ------
    InputError
        When the file there cannot be read, or is of another camring.
    """
    return _request_in(place_of(out)) if place_of(out).is_file() else None


def _request_in(place: Path) -> Request:
    try:
        with contextlib.closing(_opened(place)) as connection:
            [[content]] = connection.execute("SELECT content FROM request")
        found = Request(**json.loads(content))
    except (sqlite3.DatabaseError, ValueError, TypeError) as error:
        raise _unreadable(place, error) from error
    if found.command not in COMMANDS:
        raise _unreadable(place, ValueError(f"of a command {found.command!r}"))
    if found.version != __version__:
        raise InputError(
            printable(place),
            f"was begun by camring {found.version}, and this is {__version__}, which may answer "
            "otherwise",
            "use that version, or remove the file to begin anew",
        )
    return found


def _opened(place: Path) -> sqlite3.Connection:
    connection = sqlite3.connect(
        f"{place.absolute().as_uri()}?mode=rw",
        uri=True,
        isolation_level=None,
        timeout=1.0,
        check_same_thread=False,
    )
    try:
        connection.execute("PRAGMA locking_mode = EXCLUSIVE")
        connection.execute("BEGIN IMMEDIATE")  # nobody else is at it
        [[application]] = connection.execute("PRAGMA application_id")
        if application != APPLICATION:
            raise sqlite3.DatabaseError("of some other program")
        connection.execute("COMMIT")
    except BaseException:
        connection.close()
        raise
    return connection


def _made(place: Path, request: Request) -> sqlite3.Connection:
    """A file that is there with its request, or not at all."""
    with draft_beside(place) as draft:
        with contextlib.closing(sqlite3.connect(draft)) as connection:
            connection.executescript(f"PRAGMA application_id = {APPLICATION}; {SCHEMA}")
            connection.execute("INSERT INTO request VALUES (0, ?)", (json.dumps(asdict(request)),))
            connection.commit()
        settle(draft)
        try:
            os.link(draft, place)
        except FileExistsError:
            raise _in_use(place) from None
    sync_names(place.parent)
    return _opened(place)


def _unreadable(place: Path, error: Exception) -> InputError:
    if getattr(error, "sqlite_errorname", "") in ("SQLITE_BUSY", "SQLITE_LOCKED"):
        return _in_use(place)
    reason = "".join(each if each.isprintable() else "?" for each in str(error))
    return InputError(
        printable(place),
        f"holds no work of camring that can be read ({reason})",
        "remove it to begin anew",
    )


def _in_use(place: Path) -> InputError:
    return InputError(
        printable(place), "is in use by another process", "wait for it, or give another --out"
    )


__all__ = ["Request", "Unfinished", "done", "out_of", "place_of", "request_of"]

"""What camring starts ends with it, also when camring is killed with `kill -9`.

A process that is killed so cannot clean up, and its children live on: they would hold
licences and cores for an answer that nobody waits for. Hence two leashes. A process of
ours watches for the end of the one that spawned it. A program of the user's knows
nothing of us; its group of processes is known to a keeper, a small process that lives
until the pipe from us is closed, by whatever end, and then ends all groups it knows.

A program may also leave its group, as one does that goes to the background by a second fork.
On Linux such a process is known by a word in the environment that it has from us.
"""

import contextlib
import ctypes
import itertools
import multiprocessing
import os
import secrets
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping
from multiprocessing.connection import wait
from pathlib import Path

from camring.evaluation.keeper import end_group

MARK = "CAMRING_EVALUATION"
KEEPER = Path(__file__).with_name("keeper.py")
PR_SET_PDEATHSIG = 1


def end_with_parent() -> None:
    """Ends this process when the one that spawned it by `multiprocessing` is no more.

    On Linux by the kernel, even while foreign code holds the interpreter's lock; it takes
    the end of the thread that spawned for the end of the process, so that thread must last.
    """
    parent = multiprocessing.parent_process()
    if parent is None:
        return

    def watch() -> None:
        wait([parent.sentinel])
        os._exit(1)

    threading.Thread(target=watch, name="camring-leash", daemon=True).start()
    if sys.platform == "linux":
        with contextlib.suppress(OSError, AttributeError):
            ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)


@contextlib.contextmanager
def tied(group: int) -> Iterator[None]:
    """While its block runs, the end of this process is that of a group of processes."""
    tie(group)
    try:
        yield
    finally:
        untie(group)


def begin_to_keep() -> None:
    """Before a program is started: if this process ends before it has tied the program's group, the
    word in its environment is all that it is known by, and somebody must be there who looks for it.
    """
    _keeper.begin()


def tie(group: int) -> None:
    """From now on the end of this process is that of a group of processes."""
    _keeper.tell("tie", group)


def untie(group: int) -> None:
    """The group has ended."""
    _keeper.tell("untie", group)


def new_mark() -> str:
    """A word by which one program and whatever it starts can be found."""
    return f"{_run()}.{next(_numbers)}."


def environment_with(mark: str) -> Mapping[str, str]:
    """This process's, and the mark; behind those of evaluations that this one is part of."""
    return {**os.environ, MARK: f"{os.environ.get(MARK, '')} {mark}".strip()}


_numbers = itertools.count()
_run_of: dict[int, str] = {}


def _run() -> str:
    """A word for this process alone, another one after a fork."""
    return _run_of.setdefault(os.getpid(), f"{os.getpid()}-{secrets.token_hex(8)}")


def end_those_of(thread: int) -> None:
    """Ends the groups of processes that a thread has tied, given its `threading.get_ident()`."""
    for group in _keeper.groups_of(thread):
        end_group(group)


class _Keeper:
    """Started when it is first needed, and again should somebody have ended it."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._groups: dict[int, int] = {}  # and the thread that tied each

    def groups_of(self, thread: int) -> list[int]:
        with self._lock:
            return [group for group, tied_by in self._groups.items() if tied_by == thread]

    def begin(self) -> None:
        with self._lock:
            if not self._lives():
                self._start()

    def _lives(self) -> bool:
        return self._process is not None and self._process.poll() is None

    def tell(self, word: str, group: int) -> None:
        with self._lock:
            if word == "tie":
                self._groups[group] = threading.get_ident()
            else:
                self._groups.pop(group, None)
            lines = [f"{word} {group}\n"]
            if not self._lives():
                self._start()
                lines = [f"tie {each}\n" for each in self._groups]
            assert self._process is not None
            assert self._process.stdin is not None
            with contextlib.suppress(BrokenPipeError):
                self._process.stdin.write("".join(lines).encode())

    def _start(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-I", "-S", str(KEEPER), f"{_run()}."],
            bufsize=0,
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,  # out of the reach of Ctrl-C
        )


_keeper = _Keeper()

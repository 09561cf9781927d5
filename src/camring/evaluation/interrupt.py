"""Ctrl-C during long work: noticed at once, acted on at a safe place."""

import os
import signal
import threading
import time
from collections.abc import Callable
from concurrent.futures import Executor, Future, wait
from types import FrameType, TracebackType
from typing import Any, TypeVar

from camring.files.errors import CamringError

Result = TypeVar("Result")

EXIT_CODE = 130
PATIENCE = 0.1  # seconds between two polls
GRACE = 0.4
"""Seconds in which Python itself raises `KeyboardInterrupt`, unless it is deep in a compilation."""


def end_promptly() -> None:
    """From now on Ctrl-C ends this process within a second, whatever its main thread is at.

    Python acts on a signal between two of its own steps, and one step may be a compilation
    of half a minute. Hence a thread that learns of the signal from the interpreter at once.
    Where somebody takes care of Ctrl-C, as a study does, this does nothing. Files are put in
    place whole or not at all, so nothing is left by half.
    """
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    signal.set_wakeup_fd(writing, warn_on_full_buffer=False)
    threading.Thread(target=_watch, args=(reading,), name="camring-ctrl-c", daemon=True).start()


_came = threading.Event()
HEARD = 0.05  # seconds in which the thread that learns of a signal has run


def was_interrupted() -> bool:
    """Whether Ctrl-C came to a process that ends promptly, whatever became of the exception.

    A library may take `KeyboardInterrupt` for a failure of its own.
    """
    return _came.wait(HEARD)


def end_at_once() -> None:
    """From now on, when all work is done, Ctrl-C ends this process where it is."""
    signal.signal(signal.SIGINT, lambda number, frame: os._exit(EXIT_CODE))


def _watch(reading: int) -> None:
    while number := os.read(reading, 1):
        ours = signal.getsignal(signal.SIGINT) is signal.default_int_handler
        if number[0] == signal.SIGINT and ours:
            _came.set()
            time.sleep(GRACE)
            os.write(2, b"camring: Interrupted.\n")
            os._exit(EXIT_CODE)


class Interrupted(CamringError):
    """The user, or the system, asked the program to stop; nothing was lost."""

    exit_code = EXIT_CODE


class Interruption:
    """While its block runs, SIGINT and SIGTERM set a flag instead of raising anywhere.

    A second signal ends the process on the spot, which loses nothing either.
    Outside the main thread it does nothing, as signals cannot be had there.
    """

    def __init__(self) -> None:
        self._requested = threading.Event()
        self._former: dict[int, Any] = {}

    def __enter__(self) -> "Interruption":
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGINT, signal.SIGTERM):
                self._former[number] = signal.signal(number, self._notice)
        return self

    def __exit__(
        self, _: type[BaseException] | None, __: BaseException | None, ___: TracebackType | None
    ) -> None:
        for number, handler in self._former.items():
            signal.signal(number, handler)

    def run(self, executor: Executor, function: Callable[..., Result], *arguments: Any) -> Result:
        """What the function returns; `Interrupted` when a signal comes first."""
        self.check()
        return self.wait_for(executor.submit(function, *arguments))

    def wait_for(self, future: Future[Result]) -> Result:
        """What comes of it; `Interrupted` when a signal comes first."""
        self.check()
        while not wait([future], timeout=PATIENCE).done:
            self.check()
        return future.result()

    def check(self) -> None:
        """Raises `Interrupted` when a signal has come."""
        if self._requested.is_set():
            raise Interrupted("Stopped.")

    def _notice(self, _: int, __: FrameType | None) -> None:
        if self._requested.is_set():
            os._exit(EXIT_CODE)
        self._requested.set()

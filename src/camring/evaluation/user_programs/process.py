"""A function in a process of its own, which can be stopped when its time is up.

A thread cannot be stopped, and a function that crashes its process would take the
search along. One process serves every call and is replaced when it had to be killed.
"""

import atexit
import os
import pickle
import signal
from collections.abc import Callable
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import Any

from camring.evaluation.child_processes import end_with_parent, tie, untie
from camring.evaluation.keeper import end_group
from camring.files.errors import InputError

PATIENCE = 120.0  # seconds for a new process to import what the function needs
READY = "ready"


class FunctionFailed(Exception):
    """The function gave no answer; the text says why."""


class ProcessEnded(FunctionFailed):
    """Its process ended before it gave an answer."""


def nothing() -> None:
    """What most processes need before their first call."""


class UserProcess:
    """Calls a function elsewhere, each call for at most so many seconds.

    Parameters
    ----------
    timeout
        Seconds; None waits for ever.
    prepare
        Called in the process before anything else.

    Raises
    ------
    InputError
        When the function cannot travel to another process.
    """

    def __init__(
        self,
        function: Callable[..., Any],
        timeout: float | None,
        prepare: Callable[[], None] = nothing,
    ) -> None:
        try:
            pickle.dumps(function)
        except Exception:
            raise InputError(
                "function",
                "cannot be sent to a process of its own, which a timeout needs",
                "define it with `def` at the top of a file, or leave timeout out",
            ) from None
        self._function, self._timeout, self._prepare = function, timeout, prepare
        self._process: Any = None
        self._line: Connection | None = None

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        """What the function returns.

        Raises
        ------
        FunctionFailed
            When it raised, took too long, or its process ended.
        """
        call = pickle.dumps((arguments, named))
        line = self._connected()
        try:
            line.send_bytes(call)
            if not line.poll(self._timeout):
                self.close()
                raise FunctionFailed(f"it took longer than {self._timeout:g} s and was stopped")
            failure, answer = line.recv()
        except (EOFError, OSError):
            raise ProcessEnded(self._ended()) from None
        if failure:
            raise FunctionFailed(failure)
        return answer

    def kill(self) -> None:
        """Ends a call under way, from another thread; the call then raises `ProcessEnded`."""
        if (process := self._process) is not None:
            _end(process)

    def close(self) -> None:
        """Ends the process; the next call starts another."""
        if self._process is not None:
            _end(self._process)
            self._process.join()
            untie(self._process.pid)
            atexit.unregister(self._at_exit)
            self._process = None
        if self._line is not None:
            self._line.close()
            self._line = None

    def _at_exit(self) -> None:
        if self._process is not None:
            _end(self._process)

    def _connected(self) -> Connection:
        if self._line is not None:
            return self._line
        context = get_context("spawn")  # a fork of a process with JAX's threads may hang
        ours, theirs = context.Pipe()
        # No daemon, which could have no processes of its own; hence killed at exit by hand.
        process = context.Process(
            target=_serve, args=(theirs, self._function, self._prepare), daemon=False
        )
        process.start()
        assert process.pid is not None
        tie(process.pid)
        atexit.register(self._at_exit)
        self._process = process
        theirs.close()
        self._line = ours
        try:
            started = ours.poll(PATIENCE) and ours.recv() == READY
        except (EOFError, OSError):
            started = False
        if not started:
            self.close()
            raise InputError(
                "function",
                "could not be started in a process of its own",
                'put what your script does below `if __name__ == "__main__":`',
            )
        return ours

    def _ended(self) -> str:
        self._process.join(1.0)
        code = self._process.exitcode
        self.close()
        if code is not None and code < 0:
            return f"its process was ended by signal {-code}"
        return f"its process ended with exit code {code}"


def _end(process: Any) -> None:
    """The process with whatever the function has started in it."""
    end_group(process.pid)
    process.kill()  # one that has no group of its own yet


def _serve(line: Connection, function: Callable[..., Any], prepare: Callable[[], None]) -> None:
    os.setsid()  # so that what the function starts can be ended with it
    end_with_parent()
    # Ctrl-C comes to every process of a terminal; whoever started this one decides.
    signal.signal(signal.SIGINT, lambda number, frame: None)
    prepare()
    line.send(READY)
    while True:
        try:
            call = line.recv_bytes()
        except EOFError:
            return
        try:
            arguments, named = pickle.loads(call)
            answer: tuple[str | None, Any] = (None, function(*arguments, **named))
        except Exception as error:
            answer = (f"{type(error).__name__}: {error}", None)
        try:
            line.send(answer)
        except Exception as error:
            line.send((f"its answer cannot be sent back: {error}", None))

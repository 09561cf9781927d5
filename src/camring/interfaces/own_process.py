"""A user's function in a process of its own, which can be stopped when its time is up.

A thread cannot be stopped, and a function that crashes its process would take the
search along. One process serves every call and is replaced when it had to be killed.
"""

import pickle
from collections.abc import Callable, Mapping
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import Any

from camring.interfaces.errors import InputError

PATIENCE = 120.0  # seconds for a new process to import what the function needs
READY = "ready"


class FunctionFailed(Exception):
    """The function gave no answer; the text says why."""


class OwnProcess:
    """Calls `function(**values)` elsewhere, each call for at most so many seconds.

    Raises
    ------
    InputError
        When the function cannot travel to another process.
    """

    def __init__(self, function: Callable[..., Any], timeout: float) -> None:
        try:
            pickle.dumps(function)
        except Exception:
            raise InputError(
                "function",
                "cannot be sent to a process of its own, which a timeout needs",
                "define it with `def` at the top of a file, or leave timeout out",
            ) from None
        self._function, self._timeout = function, timeout
        self._process: Any = None
        self._line: Connection | None = None

    def __call__(self, values: Mapping[str, float]) -> Any:
        """What the function returns.

        Raises
        ------
        FunctionFailed
            When it raised, took too long, or its process ended.
        """
        line = self._connected()
        try:
            line.send(dict(values))
            if not line.poll(self._timeout):
                self.close()
                raise FunctionFailed(f"it took longer than {self._timeout:g} s and was stopped")
            failure, answer = line.recv()
        except (EOFError, OSError):
            raise FunctionFailed(self._ended()) from None
        if failure:
            raise FunctionFailed(failure)
        return answer

    def close(self) -> None:
        """Ends the process; the next call starts another."""
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._process = None
        if self._line is not None:
            self._line.close()
            self._line = None

    def _connected(self) -> Connection:
        if self._line is not None:
            return self._line
        context = get_context("spawn")  # a fork of a process with JAX's threads may hang
        ours, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs, self._function), daemon=True)
        self._process.start()
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
        return f"its process ended with exit code {code}"


def _serve(line: Connection, function: Callable[..., Any]) -> None:
    line.send(READY)
    while True:
        try:
            values = line.recv()
        except EOFError:
            return
        try:
            answer: tuple[str | None, Any] = (None, function(**values))
        except Exception as error:
            answer = (f"{type(error).__name__}: {error}", None)
        try:
            line.send(answer)
        except Exception as error:
            line.send((f"its answer cannot be sent back: {error}", None))

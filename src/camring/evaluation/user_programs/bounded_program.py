"""One run of a program that nobody vouches for: bounded in time, in memory and in what it leaves.

It may print without end, never end, end and leave a child that holds its pipes, or go to the
background: what is kept of its output is bounded, and nothing that it started outlives the run.
"""

import contextlib
import os
import selectors
import subprocess
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import IO

from camring.evaluation.child_processes import begin_to_keep, environment_with, new_mark, tied
from camring.evaluation.keeper import end_group, end_marked

__all__ = ["LONGEST_ANSWER", "CommandFailed", "Ended", "run"]

LONGEST_ANSWER = 10_000_000  # bytes
KEPT_WORDS = 100_000
"""Bytes of what a program says on stderr: the last ones."""
PIECE = 65_536  # bytes, what a pipe holds
PATIENCE = 0.1  # seconds between two polls


class CommandFailed(Exception):
    """The program gave no results; the text says why."""


@dataclass
class Ended:
    """Exit code (minus a signal's number), what stood on stdout, the end of stderr."""

    code: int = 0
    answer: bytearray = field(default_factory=bytearray)
    said: bytearray = field(default_factory=bytearray)


def run(words: Sequence[str], folder: str, question: bytes, timeout: float) -> Ended:
    """The whole life of a program.

    Parameters
    ----------
    words
        Program and arguments.
    folder
        Where it runs.
    question
        What it reads on stdin, if it reads.
    timeout
        Seconds after which it is ended.

    Raises
    ------
    CommandFailed
        When it cannot be started, prints more than `LONGEST_ANSWER`, or is not done in time.
    """
    mark = new_mark()
    begin_to_keep()
    try:
        process = subprocess.Popen(
            list(words),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            cwd=folder,
            env=environment_with(mark),
            bufsize=0,
            start_new_session=True,  # so that what it starts can be ended with it
        )
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise CommandFailed(f"it cannot be started ({reason})") from None
    try:
        with tied(process.pid):
            return _talk(process, question, timeout)
    finally:
        _end(process, mark)


def _talk(process: subprocess.Popen, question: bytes, timeout: float) -> Ended:
    deadline, found = time.monotonic() + timeout, Ended()
    late = f"it took longer than {timeout:g} s and was stopped"
    left = memoryview(question)
    stdin, stdout, stderr = process.stdin, process.stdout, process.stderr
    assert stdin is not None
    assert stdout is not None
    assert stderr is not None
    with selectors.DefaultSelector() as pipes:
        for stream, kind in ((stdout, "answer"), (stderr, "said")):
            os.set_blocking(stream.fileno(), False)
            pipes.register(stream, selectors.EVENT_READ, kind)
        os.set_blocking(stdin.fileno(), False)
        pipes.register(stdin, selectors.EVENT_WRITE)
        while len(pipes.get_map()) > (not stdin.closed):
            gone = process.poll() is not None
            ready = pipes.select(0 if gone else PATIENCE)
            for key, _ in ready:
                if key.fileobj is stdin:
                    left = _written(stdin, pipes, left)
                elif not (piece := os.read(key.fd, PIECE)):
                    pipes.unregister(key.fileobj)
                else:
                    _keep(found, key.data, piece)
            outputs = [key for key, _ in ready if key.fileobj is not stdin]
            if gone and not outputs:
                break  # a child of its own still holds the pipes, and has nothing to say
            if time.monotonic() > deadline:
                raise CommandFailed(late)
    try:
        found.code = process.wait(max(0.0, deadline - time.monotonic()))
    except subprocess.TimeoutExpired:
        raise CommandFailed(late) from None
    return found


def _written(stdin: IO[bytes], pipes: selectors.BaseSelector, left: memoryview) -> memoryview:
    """What of the question is still to be sent; a program need not read it."""
    with contextlib.suppress(BrokenPipeError):
        left = left[os.write(stdin.fileno(), left[:PIECE]) :]
        if left:
            return left
    pipes.unregister(stdin)
    stdin.close()
    return left


def _keep(found: Ended, kind: str, piece: bytes) -> None:
    if kind == "answer":
        found.answer += piece
        if len(found.answer) > LONGEST_ANSWER:
            raise CommandFailed(
                f"it printed more than {LONGEST_ANSWER:,} bytes on stdout and was stopped"
            )
        return
    found.said += piece
    del found.said[:-KEPT_WORDS]


def _end(process: subprocess.Popen, mark: str) -> None:
    """Ends the program and everything that it started and left behind."""
    end_group(process.pid)
    process.wait()
    end_marked(mark)
    for stream in (process.stdin, process.stdout, process.stderr):
        if stream is not None:
            with contextlib.suppress(OSError):
                stream.close()

"""A `camring` command that says when its evaluations begin, and a way to end it after that.

A program: `python working_command.py ARGUMENTS...` is `camring ARGUMENTS...` that writes `WORKING`
to stderr when the first compiled program has answered, so that an instant after it is one of the
evaluations and none of the start. Whatever it starts carries `MARK` in its environment.
"""

import os
import secrets
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

WORKING = "evaluations begin"
MARK = "CAMRING_TRUST_RUN"
PATIENCE = 600.0


@dataclass(frozen=True)
class Ended:
    """How a command ended.

    Attributes
    ----------
    code
        Of its exit, minus the signal's number where it was killed.
    worked
        Seconds from its first evaluation to the signal, or to its end.
    took
        Seconds from the signal to its end.
    left
        Processes of its own that still lived two seconds after it.
    said
        On stderr.
    """

    code: int
    worked: float
    took: float
    left: int
    said: str


def run(words, number=None, after=0.0, cwd=None):
    """Runs a command, with a signal that many seconds after its first evaluation."""
    token = secrets.token_hex(8)
    process = subprocess.Popen(
        [sys.executable, __file__, *map(str, words)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        cwd=cwd,
        env={**os.environ, MARK: token},
    )
    said = ""
    for line in process.stderr:
        said += line
        if WORKING in line:
            break
    began = time.monotonic()
    if number is not None:
        try:
            process.wait(after)
        except subprocess.TimeoutExpired:
            process.send_signal(number)
    sent = time.monotonic()
    said += process.stderr.read()  # until all that hold the pipe have ended
    process.wait(PATIENCE)
    ended = time.monotonic()
    while living(token) and time.monotonic() < ended + 2:
        time.sleep(0.02)
    process.stderr.close()
    whole = number is None
    return Ended(
        process.returncode,
        (ended if whole else sent) - began,
        0.0 if whole else ended - sent,
        len(living(token)),
        said,
    )


def living(token):
    """Processes that carry a token, as far as the system tells."""
    found = []
    for place in Path("/proc").glob("[0-9]*"):
        try:
            if token.encode() in (place / "environ").read_bytes():
                found.append(int(place.name))
        except OSError:
            continue
    return found


def main() -> None:
    from camring.cli import app as cli
    from camring.programs import batch_program, kept_program

    for kind in (kept_program.KeptProgram, batch_program.BatchProgram):
        _announce(kind)
    sys.argv = ["camring", *sys.argv[1:]]
    cli.main()


def _announce(kind) -> None:
    called, said = kind.__call__, []

    def announced(self, *given, **named):
        found = called(self, *given, **named)
        if not said:
            said.append(True)
            print(WORKING, file=sys.stderr, flush=True)
        return found

    kind.__call__ = announced


__all__ = ["Ended", "run", "signal"]

if __name__ == "__main__":
    main()

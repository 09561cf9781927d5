"""A `camring` command that gets a signal at a known instant of its study, however slow the machine.

A program: `python stopped_command.py SIGNAL INSTANT ARGUMENTS...`. The instant is a count of
evaluations kept, or `loading`: when the first compiled program is asked for. What the process had
used of the processor by then goes to stderr.
"""

import os
import re
import signal
import subprocess
import sys
import time
from dataclasses import dataclass

SAID = "signalled after {} s"


@dataclass(frozen=True)
class Stopped:
    """How it ended: exit code (minus the signal's number when killed), stderr, seconds."""

    code: int
    said: str
    used_since: float
    """Processor time from the signal to the end; the machine's other work is not in it."""


def stopped(number: signal.Signals, instant: int | str, *arguments) -> Stopped:
    """Runs the command with a signal on its way."""
    command = [sys.executable, __file__, number.name, instant, *arguments]
    process = subprocess.Popen(
        list(map(str, command)), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    )
    said = process.stderr.read()
    process.stderr.close()
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    before = re.search(SAID.format(r"([\d.]+)"), said)
    assert before, f"ended with {process.returncode} and without a signal: {said}"
    since = used.ru_utime + used.ru_stime - float(before[1])
    return Stopped(process.returncode, said, since)


def main() -> None:
    from camring.cli import app as cli
    from camring.programs import kept_program
    from camring.studies import store

    number, instant = signal.Signals[sys.argv[1]], sys.argv[2]

    def send() -> None:
        print(SAID.format(time.process_time()), file=sys.stderr, flush=True)
        os.kill(os.getpid(), number)

    append, found = store.Store.append, kept_program.KeptProgram._found

    def appended(self, record, *rest):
        append(self, record, *rest)
        if instant == str(record.trial + 1):
            send()

    def loading(self, *rest):
        kept_program.KeptProgram._found = found
        send()
        return found(self, *rest)

    store.Store.append = appended
    if instant == "loading":
        kept_program.KeptProgram._found = loading
    sys.argv = ["camring", *sys.argv[3:]]
    cli.main()


if __name__ == "__main__":
    main()

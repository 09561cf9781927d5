"""The second solver as a process: machines come in by a pipe, their results go out by another.

It begins without JAX and ends with the process that started it, whose end closes the pipe, in
the middle of a machine too. `python -m camring.reference.child` starts it;
`camring.studies.reference_processes` speaks to it.
"""

import os
import pickle
import queue
import sys
import threading
from typing import IO, Any

from camring.reference import Machine, solve_machine


def serve(machines: IO[bytes], answers: IO[bytes]) -> None:
    """Answers each pickled `(machine, harmonics, tolerance)` by its results or an exception."""
    problems: queue.SimpleQueue[tuple[Machine, int, float]] = queue.SimpleQueue()
    threading.Thread(target=_read, args=(machines, problems), daemon=True).start()
    while True:
        answer: Any
        try:
            answer = solve_machine(*problems.get()).results
        except Exception as error:
            answer = error
        pickle.dump(answer, answers)
        answers.flush()


def _read(machines: IO[bytes], problems: "queue.SimpleQueue[tuple[Machine, int, float]]") -> None:
    while True:
        try:
            problems.put(pickle.load(machines))
        except Exception:  # the pipe's end, or a law that this process does not know
            os._exit(0)


if __name__ == "__main__":
    # LSODA's own complaints go to standard output, where answers are expected.
    ours = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    serve(sys.stdin.buffer, ours)

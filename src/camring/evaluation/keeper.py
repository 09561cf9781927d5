"""Ends what outlives its evaluation: programs known by their group, or by a word they were given.

Also a program by itself, `python -I -S keeper.py WORD`, with nothing but Python's own: it lives
until the pipe on its stdin is closed, by whatever end of the process that started it, and then
ends the groups that were named to it and whatever has the word in its environment.
"""

import contextlib
import os
import signal
import sys
from collections.abc import Iterator

PROCESSES = "/proc"
ROUNDS = 20
"""Of asking for marked processes: one that forks at that instant has a child in the next."""


def end_group(group: int) -> None:
    """Kills every process of a group, if there is any."""
    with contextlib.suppress(OSError):
        os.killpg(group, signal.SIGKILL)


def end_marked(word: str) -> None:
    """Kills every process that has a word in its environment but this one; where the system tells
    of it, as Linux does."""
    for _ in range(ROUNDS):
        found = list(_marked(word.encode()))
        for process in found:
            with contextlib.suppress(OSError):
                os.kill(process, signal.SIGKILL)
        if not found:
            return


def _marked(word: bytes) -> Iterator[int]:
    try:
        names = [name for name in os.listdir(PROCESSES) if name.isdigit()]
    except OSError:
        return
    for name in names:
        with contextlib.suppress(OSError), open(f"{PROCESSES}/{name}/environ", "rb") as file:
            if word in file.read() and int(name) != os.getpid():
                yield int(name)


def main(word: str) -> None:
    groups: set[int] = set()
    for line in sys.stdin:
        verb, group = line.split()
        (groups.add if verb == "tie" else groups.discard)(int(group))
    for each in groups:
        end_group(each)
    end_marked(word)


if __name__ == "__main__":
    main(sys.argv[1])

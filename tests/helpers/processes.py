"""Waiting for processes, with much patience and no further; and their notes of themselves."""

import os
import subprocess
import time
from pathlib import Path

PROCESSES = Path("/proc/self/stat")  # where there is none there is `ps`


def wait_for(found, patience=60.0):
    """Until it is so."""
    deadline = time.monotonic() + patience
    while not found():
        assert time.monotonic() < deadline, f"not within {patience} s"
        time.sleep(0.01)


def lives(process):
    """Whether a process is more than an entry that nobody has collected."""
    if PROCESSES.exists():
        try:
            stat = Path(f"/proc/{process}/stat").read_text()
        except (FileNotFoundError, ProcessLookupError):
            return False
        return stat.rpartition(")")[2].split()[0] != "Z"
    shown = subprocess.run(
        ["ps", "-o", "stat=", "-p", str(process)], capture_output=True, text=True, check=False
    ).stdout.strip()
    return bool(shown) and not shown.startswith("Z")


def note_process(path):
    """Writes which process this is, whole or not at all."""
    path.with_suffix(".new").write_text(str(os.getpid()))
    path.with_suffix(".new").rename(path)


def note_first_then(folder, number, seconds):
    """Whoever comes first to a call leaves its process; who comes again answers at once."""
    try:
        (folder / str(number)).touch(exist_ok=False)
    except FileExistsError:
        return number, os.getpid()
    note_process(folder / f"{number}.process")
    time.sleep(seconds)
    return number, os.getpid()

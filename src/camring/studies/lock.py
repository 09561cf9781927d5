"""One process at a time in a study folder.

The lock belongs to the kernel's file table, not to the file: whoever holds it
loses it at the instant of death, `kill -9` included, and a file left behind
locks nobody out. What the file says (host and process) is for people.
"""

import fcntl
import os
import socket
from pathlib import Path

LOCK_NAME = ".lock"


class FolderInUse(Exception):
    """Another process holds the folder; the message says which."""


class FolderLock:
    """Held from construction until `release` or the end of the process.

    Raises
    ------
    FolderInUse
        When another process holds the lock.
    OSError
        When the lock file cannot be written.
    """

    def __init__(self, folder: Path) -> None:
        # Not inherited by spawned workers (PEP 446), so a worker that outlives
        # the coordinator does not keep the folder locked.
        self._descriptor = os.open(folder / LOCK_NAME, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            fcntl.flock(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            holder = os.read(self._descriptor, 200).decode("utf-8", "replace").strip()
            os.close(self._descriptor)
            raise FolderInUse(holder or "another process") from None
        os.ftruncate(self._descriptor, 0)
        os.pwrite(self._descriptor, f"process {os.getpid()} on {socket.gethostname()}".encode(), 0)

    def release(self) -> None:
        if self._descriptor >= 0:
            os.close(self._descriptor)
            self._descriptor = -1

"""Files that stand at their place whole or not at all: written beside it, then put there."""

import contextlib
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

__all__ = ["draft_beside", "put_in_place", "settle", "sync_names", "usual_mode", "write_safely"]


@contextlib.contextmanager
def draft_beside(path: Path) -> Iterator[Path]:
    """An empty file in the folder of a place, to be filled; gone when its block ends.

    Raises
    ------
    OSError
        When none can be made there.
    """
    handle, name = tempfile.mkstemp(prefix=f".{path.name[:100]}.", dir=path.parent)
    os.close(handle)
    draft = Path(name)
    try:
        yield draft
    finally:
        with contextlib.suppress(OSError):
            draft.unlink(missing_ok=True)


def put_in_place(draft: Path, path: Path) -> None:
    """The draft becomes the file, on the disk and readable as any other; an old one is replaced."""
    settle(draft)
    os.replace(draft, path)
    sync_names(path.parent)


def write_safely(path: Path, content: bytes) -> None:
    """Writes a file that is, at any instant, the old one or the new one and whole.

    Raises
    ------
    OSError
        When the disk is full or not writable; the old file is then untouched.
    """
    with draft_beside(path) as draft:
        draft.write_bytes(content)
        put_in_place(draft, path)


def settle(draft: Path) -> None:
    """What was written is on the disk, and its mode that of other files."""
    with open(draft, "rb") as file:
        os.fsync(file.fileno())
    draft.chmod(usual_mode())


def usual_mode(folder: bool = False) -> int:
    """What this user's new files have, where a temporary one is its owner's alone."""
    mask = os.umask(0)
    os.umask(mask)
    return (0o777 if folder else 0o666) & ~mask


def sync_names(folder: Path) -> None:
    """After a loss of power a file has the name that it was given last."""
    with contextlib.suppress(OSError):  # some disks cannot, and keep names anyway
        descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)

"""Files that stand at their place whole or not at all: written beside it, then put there."""

import contextlib
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

__all__ = [
    "draft_beside",
    "make_folder",
    "put_in_place",
    "settle",
    "sync_folder",
    "sync_names",
    "usual_mode",
    "write_privately",
    "write_safely",
]


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


def write_privately(path: Path, content: bytes, *, replace: bool = True) -> None:
    """As `write_safely`, readable by its owner alone; an old file stays without `replace`.

    Raises
    ------
    OSError
        When it cannot be written; `FileExistsError` when it must stay.
    """
    with draft_beside(path) as draft:  # whose mode is 0600
        draft.write_bytes(content)
        _sync(draft)
        if replace:
            os.replace(draft, path)
        else:
            os.link(draft, path)
        sync_names(path.parent)


def settle(draft: Path) -> None:
    """What was written is on the disk, and its mode that of other files."""
    _sync(draft)
    draft.chmod(usual_mode())


def make_folder(path: Path, mode: int = 0o777) -> None:
    """A folder, with those above it, that a loss of power does not take away; one may be there.

    Raises
    ------
    OSError
        When it cannot be made, or a file is there.
    """
    missing = [each for each in (path, *path.parents) if not each.exists()]
    path.mkdir(mode=mode, parents=True, exist_ok=True)
    for each in missing:
        sync_names(each.parent)


def sync_folder(folder: Path) -> None:
    """All that a folder holds is on the disk, by its name."""
    for where, _, names in os.walk(folder):
        for name in names:
            _sync(Path(where, name))
        sync_names(Path(where))


def _sync(path: Path) -> None:
    with open(path, "rb") as file:
        os.fsync(file.fileno())


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

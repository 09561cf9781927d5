"""Paths that stay in the folder that is open."""

from pathlib import Path

from camring.files.errors import InputError


def inside(folder: Path, name: str) -> Path:
    """A path in the folder or below it.

    Raises
    ------
    InputError
        For one that leads out of it, by its name or by a link.
    """
    path = (folder / name).resolve()
    if not path.is_relative_to(folder.resolve()) or path == folder.resolve():
        raise InputError(
            f"{name!r}", f"lies outside {folder}, which is open here", "name a file in it"
        )
    return path

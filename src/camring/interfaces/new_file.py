"""Writing a file that was not there, whole or not at all."""

import contextlib
import os
import tempfile
from pathlib import Path

from camring.interfaces.config.document import printable
from camring.interfaces.errors import InputError


def require_new(path: Path, *, replace: bool = False) -> None:
    """Refuse what `write_new_file` would, before long work begins.

    Raises
    ------
    InputError
        When something is there, or the folder is not.
    """
    shown = printable(path)
    if path.is_dir():
        raise InputError(shown, "is a directory", "name a file in it")
    if path.exists() and not replace:
        raise InputError(shown, "exists", "choose another name, or replace it with --force")
    if not path.parent.is_dir():
        folder = printable(path.parent)
        raise InputError(shown, f"lies in {folder}, which does not exist", f"make {folder} first")


def write_new_file(path: Path, text: str, *, replace: bool = False) -> None:
    """Write a text; an existing file is only touched with `replace`, and then at one stroke.

    Raises
    ------
    InputError
        When something is there, or the place cannot be written.
    """
    shown = printable(path)
    try:
        if path.is_dir():
            raise InputError(shown, "is a directory", "name a file in it")
        if replace:
            _replace(path, text)
        else:
            _create(path, text)
    except FileExistsError:
        raise InputError(
            shown, "exists", "choose another name, or replace it with --force"
        ) from None
    except FileNotFoundError:
        folder = printable(path.parent)
        raise InputError(
            shown, f"lies in {folder}, which does not exist", f"make {folder} first"
        ) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(
            shown, f"cannot be written ({reason.lower()})", "choose another place"
        ) from None


def make_new_folder(path: Path) -> None:
    """A folder where none is.

    Raises
    ------
    InputError
        When something is there, or none can be made.
    """
    shown = printable(path)
    try:
        path.mkdir(parents=True)
    except FileExistsError:
        raise InputError(shown, "exists", "choose another name") from None
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise InputError(shown, f"cannot be made ({reason})", "choose another place") from None


def _create(path: Path, text: str) -> None:
    with open(path, "x", encoding="utf-8") as file:
        try:
            file.write(text)
            file.flush()
        except OSError:
            path.unlink(missing_ok=True)
            raise


def _replace(path: Path, text: str) -> None:
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=".camring-")
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
        # A temporary file is its owner's alone; a motor file is like any other.
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(temporary, 0o666 & ~mask)
        os.replace(temporary, path)
    finally:
        with contextlib.suppress(OSError):
            os.unlink(temporary)

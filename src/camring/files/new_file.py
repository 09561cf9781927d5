"""Writing a file that was not there, whole or not at all."""

import contextlib
import errno
import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

from camring.files.errors import InputError
from camring.files.motor.document import printable
from camring.files.whole_file import (
    draft_beside,
    make_folder,
    settle,
    sync_folder,
    sync_names,
    usual_mode,
    write_safely,
)

NO_LINKS = (errno.EPERM, errno.ENOTSUP, errno.EOPNOTSUPP, errno.ENOSYS, errno.EMLINK, errno.EINVAL)
"""What a file system says that knows one name for each file."""


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
            write_safely(path, text.encode())
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


@contextlib.contextmanager
def whole_folder(path: Path) -> Iterator[Path]:
    """A folder to fill, which stands at its place when its block has ended well, or not at all.

    Raises
    ------
    InputError
        When something is there, or none can be made.
    """
    shown, unfinished = printable(path), None
    try:
        if os.path.lexists(path):
            raise FileExistsError
        make_folder(path.parent)
        unfinished = Path(tempfile.mkdtemp(prefix=f".{path.name[:100]}.", dir=path.parent))
        yield unfinished
        unfinished.chmod(usual_mode(folder=True))
        sync_folder(unfinished)
        unfinished.rename(path)
        sync_names(path.parent)
    except FileExistsError:
        raise InputError(shown, "exists", "choose another name") from None
    except OSError as error:
        if error.errno in (errno.ENOTEMPTY, errno.ENOTDIR):
            raise InputError(shown, "exists", "choose another name") from None
        reason = (error.strerror or str(error)).lower()
        raise InputError(shown, f"cannot be made ({reason})", "choose another place") from None
    finally:
        if unfinished is not None:
            shutil.rmtree(unfinished, ignore_errors=True)


def _create(path: Path, text: str) -> None:
    with draft_beside(path) as draft:
        draft.write_text(text, encoding="utf-8", newline="")
        settle(draft)
        try:
            os.link(draft, path)
        except FileExistsError:
            raise
        except OSError as error:
            if error.errno not in NO_LINKS:
                raise
            _create_in_place(path, text)
    sync_names(path.parent)


def _create_in_place(path: Path, text: str) -> None:
    """Where files have one name only, as on memory sticks: a kill may leave a part of it."""
    with open(path, "x", encoding="utf-8") as file:
        try:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        except BaseException:
            path.unlink(missing_ok=True)
            raise

"""The file of a kept program: machine code that will be run, so it is looked at before it is.

Whoever could write the file could have written any program. Hence owner and mode are read
from the opened file itself, links are not followed, and a digest over the content and the
file's own name says that it is whole and the one that was asked for: a file that was cut,
flipped, or put under the name of another program or of another version is made anew.
"""

import contextlib
import hashlib
import hmac
import os
import pickle
import stat
import threading
import time
import zlib
from pathlib import Path
from typing import Any

from camring.programs.compilation_cache import PROGRAM_SUFFIX as SUFFIX

__all__ = ["SUFFIX", "UNUSED_SECONDS", "content_of", "sealed", "write"]

HEAD = b"camring program, version 2\n"
UNUSED_SECONDS = 90 * 86_400.0
"""After these a file is thrown away; whoever needs it again compiles once more."""
OTHERS = stat.S_IWGRP | stat.S_IWOTH


class Untrusted(Exception):
    """A file that somebody else may have written, or that is not what was written."""


def sealed(name: str, content: Any) -> bytes:
    """What a file of this name holds."""
    packed = zlib.compress(pickle.dumps(content), 1)
    return HEAD + _seal(name, packed) + packed


def write(path: Path, content: Any) -> None:
    """Writes a program under its name at once or not at all; a full disk is no error."""
    draft = path.with_suffix(f".{os.getpid()}{threading.get_ident()}")
    try:
        whole = sealed(path.name, content)
        with contextlib.suppress(FileNotFoundError):
            draft.unlink()
        flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW
        with os.fdopen(os.open(draft, flags, 0o600), "wb") as file:
            file.write(whole)
        draft.replace(path)
        for each in path.parent.glob(f"*{SUFFIX}"):
            if time.time() - each.lstat().st_mtime > UNUSED_SECONDS:
                each.unlink(missing_ok=True)
    except Exception:  # whatever could not be kept is compiled once more
        with contextlib.suppress(OSError):
            draft.unlink(missing_ok=True)


def content_of(path: Path) -> Any:
    """What was kept under a name.

    Raises
    ------
    Untrusted
        When anybody else could have written it, or it is not whole, or another program's.
    OSError
        When there is none that can be read.
    """
    descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    with os.fdopen(descriptor, "rb") as file:
        status = os.fstat(file.fileno())
        ours = stat.S_ISREG(status.st_mode) and status.st_uid == os.getuid()
        if not ours or status.st_mode & OTHERS:
            raise Untrusted(path)
        head, seal = file.read(len(HEAD)), file.read(hashlib.sha256().digest_size)
        packed = file.read()
        if head != HEAD or not hmac.compare_digest(seal, _seal(path.name, packed)):
            raise Untrusted(path)
        os.utime(file.fileno())
    return pickle.loads(zlib.decompress(packed))


def _seal(name: str, packed: bytes) -> bytes:
    return hashlib.sha256(f"{name}\0".encode() + packed).digest()

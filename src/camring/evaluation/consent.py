"""Whether a program that somebody else named may run here, and the memory of having agreed.

A motor file or a study from a stranger can name any command, so none of them runs before
its user has said yes: on the command line, by a keyword, or at a terminal that shows it. A
study remembers that as a mark which only this user's own key can make, over the command and
the content of what it runs. The key stays out of every study: in a folder that came from
elsewhere, or whose program has changed, the mark does not fit, and the user is asked again.
"""

import contextlib
import hashlib
import hmac
import json
import os
import secrets
import stat
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

from camring.evaluation.user_programs.command import UserCommand
from camring.evaluation.user_programs.fmu import Mapped
from camring.files.errors import InputError
from camring.files.motor.document import printable
from camring.files.whole_file import make_folder, write_privately

Allow: TypeAlias = bool | Callable[[UserCommand], bool]
"""Whether a named program may run; or who is asked."""

KEY_NAME = "consent.key"
KEY_SIZE = 32  # bytes


def require_consent(command: UserCommand, allow: Allow, where: str, noted: str = "") -> str:
    """The mark of a consent, to be noted in the study; empty where no key can be kept.

    Parameters
    ----------
    where
        What names the command: `motor.toml [evaluator]`.
    noted
        The mark that the study holds.

    Raises
    ------
    InputError
        When nobody has agreed to run it.
    """
    mark = mark_of(command)
    if mark and hmac.compare_digest(noted.encode(), mark.encode()):
        return mark
    if allow is True or (callable(allow) and allow(command)):
        return mark
    since = " since it, its files or the place of the study have changed" if noted else ""
    raise InputError(
        where,
        f"names a program that is to run for every design, and nobody has agreed to that{since}: "
        f"`{command.shown()}` in {printable(Path(command.folder))}",
        "look at what it does, then allow it with --allow-evaluator (from Python "
        "allow_evaluator=True), or name a program of your own with --evaluator",
    )


def ask_at_terminal(command: UserCommand) -> bool:
    """The user's answer to the exact command and its folder; no where there is no terminal."""
    if not (sys.stdin.isatty() and sys.stderr.isatty()):
        return False
    import typer

    typer.echo(
        "For every design this program is to run, which can do whatever you can:\n"
        f"    {command.shown()}\n"
        f"in the folder\n    {printable(Path(command.folder))}",
        err=True,
    )
    return typer.confirm("Run it?", default=False, err=True)


def mark_of(command: UserCommand) -> str:
    """What only this user can write under a command; empty where no key can be kept."""
    key = _key()
    if key is None:
        return ""
    return hmac.new(key, digest_of(command).encode(), hashlib.sha256).hexdigest()


def digest_of(command: UserCommand) -> str:
    """Of the words, the folder, and the content of every file that the words name.

    What such a file brings in turn, a script its modules, is not looked into.
    """
    found = hashlib.sha256(
        json.dumps([list(command.words), os.path.realpath(command.folder)]).encode()
    )
    for path in files_of(command):
        with contextlib.suppress(OSError), path.open("rb") as file:
            found.update(f"\0{path}\0{hashlib.file_digest(file, 'sha256').hexdigest()}".encode())
    return found.hexdigest()


def files_of(command: UserCommand) -> list[Path]:
    """Files that the words name: scripts, settings, a module of `-m`, an FMU and its mapping."""
    folder = Path(command.folder)
    named = []
    for place, word in enumerate(command.words):
        if place == 0 and (word == sys.executable or not os.path.dirname(word)):
            continue  # this Python, or a program of the system
        candidates = [word, word.partition("=")[2]]
        if place and command.words[place - 1] == "-m":
            module = word.replace(".", "/")
            candidates += [f"{module}.py", f"{module}/__main__.py"]
        named += [folder / each for each in candidates if each]
        if Mapped.__module__ in command.words[:place]:
            with contextlib.suppress(InputError):
                named.append(Mapped.read(folder / word).fmu)
    return list(dict.fromkeys(path for path in named if _is_file(path)))


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):  # a word need not be any path at all
        return False


def _key() -> bytes | None:
    """This user's own; made when there is none."""
    try:
        path = state_folder() / KEY_NAME
        damaged = path.exists() and path.stat().st_size != KEY_SIZE  # no mark can fit it
        if damaged or not path.exists():
            make_folder(path.parent, 0o700)
            with contextlib.suppress(FileExistsError):  # never in place of another
                write_privately(path, secrets.token_bytes(KEY_SIZE), replace=damaged)
        status = path.lstat()
        key = path.read_bytes()
    except (OSError, RuntimeError):  # the second when there is no home at all
        return None
    private = stat.S_ISREG(status.st_mode) and status.st_uid == os.getuid()
    others = status.st_mode & (stat.S_IRWXG | stat.S_IRWXO)
    return key if private and not others and len(key) == KEY_SIZE else None


def state_folder() -> Path:
    """This user's own folder for what outlives a run and is no cache."""
    home = os.environ.get("XDG_STATE_HOME", "")
    # The specification: a relative one is to be ignored.
    base = Path(home) if os.path.isabs(home) else Path.home() / ".local" / "state"
    return base / "camring"


__all__ = ["Allow", "ask_at_terminal", "digest_of", "files_of", "mark_of", "require_consent"]

"""From a path to a TOML document: everything that can be wrong with a file as a file."""

import contextlib
import os
import re
import stat
import tomllib
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from camring.files.errors import InputError

LARGEST_FILE = 200_000  # bytes; a motor with 720 control points has 40,000
INLET = "inlet_temperature"  # a key of [thermal]

# A key of twenty parts, a.b.c...; time and memory of the parser grow with their square.
_DECLARED_TWICE = re.compile(r"Cannot declare \((?P<path>[^)]*)\) twice \(at line (?P<line>\d+)")
_OVERWRITTEN = re.compile(r"Cannot overwrite a value \(at line (?P<line>\d+)")
_TABLE_TWICE = re.compile(r"declare \('(operating_points)',\) twice")
_LONG_KEY = re.compile(
    r"""(?<![\w-])(?:(?:[\w-]+|"[^"\n]*"|'[^'\n]*')[ \t]*\.[ \t]*){20}""", re.ASCII
)


def read_text(path: Path) -> str:
    """The text of a motor file.

    Raises
    ------
    InputError
        When there is none, or it is no UTF-8 text of a sensible size.
    """
    shown = printable(path)
    try:
        status = os.stat(path)
        if stat.S_ISDIR(status.st_mode):
            raise InputError(shown, "is a directory", f"name a motor file in it{_first_of(path)}")
        if not stat.S_ISREG(status.st_mode):
            raise InputError(shown, "is not a regular file", "name a motor file")
        if status.st_size > LARGEST_FILE:
            raise InputError(
                shown,
                f"has {status.st_size:,} bytes, more than the {LARGEST_FILE:,} "
                "that a motor file may have",
                "name a motor file; `camring new` writes one",
            )
        with open(path, "rb") as file:
            content = file.read(LARGEST_FILE + 1)
    except FileNotFoundError:
        raise InputError(shown, "does not exist", _way_to(path)) from None
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise InputError(
            shown, f"cannot be read ({reason.lower()})", "name a file that you may read"
        ) from None
    return decode(content, shown)


def _first_of(folder: Path) -> str:
    """Which of its motor files, where a folder has some: of a study the best."""
    with contextlib.suppress(OSError):
        names = sorted(each.name for each in folder.glob("*.toml"))
        if names:
            name = "best.toml" if "best.toml" in names else names[0]
            return f", such as {printable(folder / name)}"
    return ""


def decode(content: bytes, shown: str) -> str:
    """UTF-8 text, a byte order mark in front taken off."""
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        raise InputError(
            shown,
            f"is not UTF-8 text: line {line} holds the byte 0x{content[error.start]:02x}",
            "save it with the encoding UTF-8",
        ) from None


def parse(text: str, shown: str) -> dict[str, Any]:
    """The TOML document in a text.

    Raises
    ------
    InputError
        With the line of the fault in the syntax.
    """
    found = _LONG_KEY.search(text)
    if found is not None:
        line = text[: found.start()].count("\n") + 1
        raise InputError(shown, f"has a key of more than twenty parts in line {line}", "shorten it")
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        twice = _TABLE_TWICE.search(str(error))
        if not twice and (fault := _stands_twice(str(error), text)) is not None:
            raise InputError(shown, *fault) from None
        raise InputError(
            shown,
            f"is not valid TOML: {_lowered(str(error))}",
            f"write [[{twice[1]}]], in double brackets, for each of them"
            if twice
            else 'write keys as `bore = "30 mm"` under a [table]',
        ) from None
    except RecursionError:
        raise InputError(shown, "is nested too deeply", "write plain tables") from None
    except ValueError as error:  # numbers and dates that are spelt well and mean nothing
        raise InputError(shown, f"holds a value out of range: {error}", "correct it") from None


def _lowered(sentence: str) -> str:
    printed = " ".join(sentence.encode("ascii", "backslashreplace").decode().split())
    return (printed[:1].lower() + printed[1:])[:200].rstrip(".")


def _way_to(path: Path) -> str:
    try:
        names = [each.name for each in path.parent.iterdir() if each.suffix == path.suffix]
    except (OSError, ValueError):
        names = []
    close = get_close_matches(path.name, names[:1000], n=1)
    if close:
        return f"you probably meant {printable(path.parent / close[0])}"
    return "name an existing file, or write one with `camring new`"


def printable(path: Path) -> str:
    """A path as text that every terminal can show on one line."""
    text = str(path).encode("utf-8", "backslashreplace").decode()
    text = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
    return text if len(text) <= 300 else "..." + text[-297:]


def _stands_twice(error: str, text: str) -> tuple[str, str] | None:
    """What stands twice in a file, and the way out, where that is the fault."""
    if (table := _DECLARED_TWICE.search(error)) is not None:
        name = ".".join(re.findall(r"'([^']*)'", table["path"]))
        return f"has the table [{name}] twice, again in line {table['line']}", "keep one of them"
    if (key := _OVERWRITTEN.search(error)) is not None:
        line = text.splitlines()[int(key["line"]) - 1]
        name = line.partition("=")[0].strip()
        return f"has the key {name!r} twice in one table, again in line {key['line']}", "keep one"
    return None


def at_temperature(document: dict[str, Any], temperature: float | str) -> dict[str, Any]:
    """The document with its oil at another temperature."""
    there = {**document, "fluid": {**document.get("fluid", {}), "temperature": temperature}}
    thermal = document.get("thermal")
    if isinstance(thermal, dict):
        there["thermal"] = {key: value for key, value in thermal.items() if key != INLET}
    return there

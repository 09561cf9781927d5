"""A motor file's text with single keys set or taken out, as a person would write them.

Comments, order and layout stay. A place is a tuple of the names down to the key, with a
number where a table is one of several: `("operating_points", 1, "speed")`,
`("design_space", "motor.bore")`.
"""

import re
import tomllib
from collections.abc import Mapping
from copy import deepcopy
from typing import Any, TypeAlias

from camring.files.motor.writer import end_of_value, literal, toml_key, whole_text

Place: TypeAlias = tuple[str | int, ...]

_HEADER = re.compile(r"\s*(?P<open>\[\[?)(?P<table>[^\[\]]+)\]\]?\s*(#.*)?")


def with_raw_values(text: str, changes: Mapping[Place, Any]) -> str:
    """The text with these TOML values at their places; None takes a key out.

    A table that is missing is written at the end. Where a place stands in an inline or dotted
    table the whole document is written anew, without its comments.
    """
    wanted = deepcopy(tomllib.loads(text))
    for place, value in changes.items():
        _put(wanted, place, value)
        text = _edited(text, place, value)
    try:
        if tomllib.loads(text) == wanted:
            return text
    except tomllib.TOMLDecodeError:
        pass
    return whole_text(wanted)


def raw_value(document: Any, place: Place) -> Any:
    """What stands at a place; None for nothing."""
    for part in place:
        listed = isinstance(document, list) and isinstance(part, int) and part < len(document)
        if not listed and not (isinstance(document, dict) and part in document):
            return None
        document = document[part]
    return document


def _put(document: dict[str, Any], place: Place, value: Any) -> None:
    *tables, key = place
    here: Any = document
    for part in tables:
        here = here[part] if isinstance(part, int) else here.setdefault(part, {})
    if value is None:
        here.pop(key, None)
    else:
        here[key] = value


def _edited(text: str, place: Place, value: Any) -> str:
    *tables, key = place
    lines = text.split("\n")
    start = _header_line(lines, tuple(tables))
    assignment = re.compile(
        rf"(\s*(?:{re.escape(str(key))}|{re.escape(literal(str(key)))})\s*=\s*)"
    )
    if start is None:
        if value is None:
            return text
        header = ".".join(toml_key(str(part)) for part in tables)
        line = f"{toml_key(str(key))} = {literal(value)}"
        return text.rstrip("\n") + f"\n\n[{header}]\n{line}\n"
    last = start
    for at in range(start + 1, len(lines)):
        if _HEADER.fullmatch(lines[at].rstrip("\r")):
            break
        found = assignment.match(lines[at])
        if found is not None:
            end, comment = end_of_value(lines, at)
            lines[at : end + 1] = [] if value is None else [found[1] + literal(value) + comment]
            return "\n".join(lines)
        if lines[at].strip() and not lines[at].lstrip().startswith("#"):
            last = at
    if value is not None:
        lines.insert(last + 1, f"{toml_key(str(key))} = {literal(value)}")
    return "\n".join(lines)


def _header_line(lines: list[str], tables: Place) -> int | None:
    """Where a table begins; of several tables of one name the one that is numbered."""
    names = ".".join(str(part) for part in tables if isinstance(part, str))
    wanted = next((part for part in tables if isinstance(part, int)), None)
    seen = -1
    for at, line in enumerate(lines):
        found = _HEADER.fullmatch(line.rstrip("\r"))
        if found is None or found["table"].replace(" ", "") != names:
            continue
        seen += 1
        if wanted is None or seen == wanted:
            return at
    return None

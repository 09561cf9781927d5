"""A motor file's text with other numbers in it; comments and layout stay."""

import re
import tomllib
from typing import Any

from camring.files.motor.entries import Entry, Number, Numbers
from camring.files.motor.keys import Choices, key_map
from camring.files.units import UnitError, from_si, split_quantity, to_si

_FOUND = re.compile(r"\A# A design found by `.*\n# what they say of numbers .*\n")
_HEADER = re.compile(r"\s*\[(?P<table>[^\[\]]+)\]\s*(#.*)?")


def changed_text(
    text: str, document: dict[str, Any], values: dict[str, Any], choices: Choices
) -> str:
    """The text with these SI values in place of the given ones.

    Each value is written in the unit the file uses for it, with all its digits.
    """
    entries = key_map(choices)
    written: dict[str, Any] = {}
    for path, value in values.items():
        given = _look_up(document, path)
        written[path] = _in_units_of(given, value, entries[path])
    wanted = _with_values(document, written)
    for path, value in written.items():
        text = _replaced(text, path, literal(value))
    try:
        if tomllib.loads(text) == wanted:
            return text
    except tomllib.TOMLDecodeError:
        pass
    # Inline tables or dotted keys: say the same without the layout.
    return whole_text(wanted)


def found_text(text: str, command: str) -> str:
    """The text of a design below a remark that says where it comes from, and only one such."""
    remark = (
        f"# A design found by `{command}`. Remarks below are of the motor file it began with:\n"
        "# what they say of numbers may be true no longer.\n"
    )
    return remark + _FOUND.sub("", text)


def _look_up(document: Any, path: str) -> Any:
    for part in path.split("."):
        document = document.get(part) if isinstance(document, dict) else None
    return document


def _with_values(document: dict[str, Any], written: dict[str, Any]) -> dict[str, Any]:
    changed = tomllib.loads(whole_text(document))  # a copy that shares nothing
    for path, value in written.items():
        here = changed
        *tables, key = path.split(".")
        for table in tables:
            here = here.setdefault(table, {})
        here[key] = value
    return changed


def _in_units_of(given: Any, value: Any, entry: Entry) -> Any:
    """An SI value as the file would write it: text with the unit of the given one."""
    if isinstance(entry, Numbers):
        like = given if isinstance(given, list) and given else [None]
        return [
            _in_units_of(like[place % len(like)], item, entry.item)
            for place, item in enumerate(value)
        ]
    assert isinstance(entry, Number)
    if isinstance(given, str):
        unit = split_quantity(given)[1]
        return _exact(value, unit, entry.unit) if unit else value
    if given is not None:
        return value
    try:
        unit = split_quantity(entry.example.strip('"'))[1]
    except UnitError:
        unit = ""
    return _exact(value, unit, entry.unit) if unit else value


def _exact(value: float, unit: str, si_unit: str) -> str:
    """The shortest text in this unit that reads back as the value, or as near as it can."""
    number = from_si(value, unit, si_unit)
    for digits in range(6, 18):
        text = f"{number:.{digits}g} {unit}"
        if to_si(text, si_unit) == value:
            return text
    return f"{number!r} {unit}"


def _replaced(text: str, path: str, value: str) -> str:
    """The text with `key = value` in its table, or a line added below the table's header."""
    table, key = path.rsplit(".", 1)
    lines = text.split("\n")
    start = _header_line(lines, table)
    if start is None:
        return text
    assignment = re.compile(rf"(\s*{re.escape(key)}\s*=\s*)")
    for place in range(start + 1, len(lines)):
        if lines[place].lstrip().startswith("["):
            break
        found = assignment.match(lines[place])
        if found is not None:
            last, comment = end_of_value(lines, place)
            lines[place : last + 1] = [found[1] + value + comment]
            return "\n".join(lines)
    lines.insert(start + 1, f"{key} = {value}")
    return "\n".join(lines)


def _header_line(lines: list[str], table: str) -> int | None:
    for place, line in enumerate(lines):
        found = _HEADER.fullmatch(line.rstrip("\r"))
        if found is not None and found["table"].replace(" ", "") == table:
            return place
    return None


def end_of_value(lines: list[str], place: int) -> tuple[int, str]:
    """The line on which the value begun here ends, and the comment behind it."""
    for last in range(place, len(lines)):
        try:
            tomllib.loads("\n".join(lines[place : last + 1]))
        except tomllib.TOMLDecodeError:
            continue
        return last, _comment_of(lines[last])
    return place, ""


def _comment_of(line: str) -> str:
    """A comment at the end of a line, found as the tail without which the line still ends."""
    outside = re.sub(r'"(\\.|[^"\\])*"|\'[^\']*\'', lambda text: "x" * len(text[0]), line)
    place = outside.find("#")
    return "  " + line[place:].rstrip() if place >= 0 else ""


def whole_text(document: dict[str, Any]) -> str:
    """A TOML document from scratch."""
    return "\n".join(_table_lines(document, ())).strip("\n") + "\n"


def _table_lines(table: dict[str, Any], path: tuple[str, ...]) -> list[str]:
    lines = [f"{toml_key(k)} = {literal(v)}" for k, v in table.items() if not _is_tables(v)]
    for name, value in table.items():
        header = ".".join(toml_key(part) for part in (*path, name))
        if isinstance(value, dict):
            lines += ["", f"[{header}]", *_table_lines(value, (*path, name))]
        elif _is_tables(value):
            for each in value:
                lines += ["", f"[[{header}]]", *_table_lines(each, (*path, name))]
    return lines


def _is_tables(value: Any) -> bool:
    several = isinstance(value, list) and value and all(isinstance(each, dict) for each in value)
    return isinstance(value, dict) or bool(several)


def toml_key(name: str) -> str:
    """A name as TOML's key: bare where it can be."""
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else literal(name)


def literal(value: Any) -> str:
    """A value in TOML."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        escaped = value.replace("\\", "\\\\").replace('"', '\\"')
        return '"' + "".join(c if c.isprintable() else f"\\U{ord(c):08x}" for c in escaped) + '"'
    if isinstance(value, list):
        return "[" + ", ".join(literal(each) for each in value) + "]"
    if isinstance(value, dict):
        inside = ", ".join(f"{toml_key(k)} = {literal(v)}" for k, v in value.items())
        return "{ " + inside + " }" if inside else "{}"
    return repr(value) if isinstance(value, int | float) else str(value)

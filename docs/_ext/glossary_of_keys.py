"""The directive `keys`: every key of the motor file, read off the reader's own tables.

Meaning, unit, default and limits of sanity come from the code; typical ranges and their sources
from `docs/typical.toml`. A key without an entry there, or an entry without a key, is an error.
"""

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from docutils import nodes
from docutils.statemachine import StringList
from pydantic import BaseModel
from sphinx.util.docutils import SphinxDirective

from camring.files.motor.design_cam import CamModesTable
from camring.files.motor.entries import Entry, Number, Word
from camring.files.motor.keys import CAMS, Choices, file_tables, inner_table
from camring.files.motor.laws import SLOTS, laws_of
from camring.files.starting.library import library
from camring.files.units import from_si, split_quantity

TYPICAL = Path(__file__).parents[1] / "typical.toml"


class Row(NamedTuple):
    entry: Entry
    default: Any
    needed: bool
    law: str
    """The choice that brings the key; empty for keys that are always there."""


def every_key() -> dict[str, Row]:
    """Every key a file can hold, whatever laws it chooses, by its path."""
    found: dict[str, Row] = {}
    usual = Choices().laws
    choices = [Choices(usual, cam) for cam in CAMS]
    brought = {choices[1]: 'representation = "planar"'}
    for place, slot in enumerate(SLOTS):
        for name in laws_of(slot):
            choice = Choices((*usual[:place], name, *usual[place + 1 :]))
            brought.setdefault(choice, f'{slot.chooser} = "{name}"')
            choices.append(choice)
    brought[choices[0]] = ""
    for choice in choices:
        for path, entry, field in _walk(file_tables(choice), ""):
            row = Row(entry, field.default, field.is_required(), brought[choice])
            found.setdefault(path, row)
    for path, entry, field in _walk(CamModesTable, "design_space.cam."):
        found[path] = Row(entry, field.default, field.is_required(), "")
    return found


def _walk(table: type[BaseModel], prefix: str) -> Iterator[tuple[str, Entry, Any]]:
    for name, field in table.model_fields.items():
        entries = [item for item in field.metadata if isinstance(item, Entry)]
        if entries:
            yield prefix + name, entries[0], field
        elif (inner := inner_table(field.annotation)) is not None:
            yield from _walk(inner, f"{prefix}{name}.")


def typical() -> dict[str, tuple[str, str]]:
    """Typical range and source by path."""
    return {
        path: (said[0], said[1])
        for path, said in flat(tomllib.loads(TYPICAL.read_text(encoding="utf-8")))
    }


def flat(table: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Values of nested tables by their path; lists of tables as if each were there."""
    for key, value in table.items():
        inner = value if isinstance(value, list) else [value]
        if inner and all(isinstance(each, dict) for each in inner):
            for each in inner:
                yield from flat(each, f"{prefix}{key}.")
        else:
            yield prefix + key, value


def unlisted(keys: dict[str, Row], said: dict[str, tuple[str, str]]) -> list[str]:
    """What is missing in one of the two, in words."""
    return [f"{path} has no typical range" for path in keys if path not in said] + [
        f"{path} is no key" for path in said if path not in keys
    ]


def in_library(entry: Entry, values: list[Any]) -> str:
    """The range over the library's motors, in the unit of the entry's example."""
    if not isinstance(entry, Number):
        low, high, unit = min(values), max(values), ""
    else:
        read = [entry.read(value) for value in values]
        text = next((value for value in values if isinstance(value, str)), "")
        unit = split_quantity(text)[1] if text else ""
        ends = min(read), max(read)
        low, high = (from_si(each, unit, entry.unit) if unit else each for each in ends)
    span = f"{low:.3g}" if f"{low:.3g}" == f"{high:.3g}" else f"{low:.3g} to {high:.3g}"
    return f"{span} {unit}".strip()


class Keys(SphinxDirective):
    """The whole glossary, a table of each table of the file."""

    def run(self) -> list[nodes.Node]:
        self.env.note_dependency(str(TYPICAL))
        keys, said = every_key(), typical()
        if faults := unlisted(keys, said):
            raise self.error("typical.toml: " + "; ".join(faults))
        values: dict[str, list[Any]] = {}
        for text in library().values():
            for path, value in flat(tomllib.loads(text)):
                values.setdefault(path, []).append(value)
        lines: list[str] = []
        for table in dict.fromkeys(path.rpartition(".")[0] for path in keys):
            header = f"[[{table}]]" if table == "operating_points" else f"[{table}]"
            lines += ["", f"## `{header}`", ""]
            lines += ["| key | meaning | default | typical | source |", "|---|---|---|---|---|"]
            for path, row in keys.items():
                if path.rpartition(".")[0] == table:
                    lines.append(_line(path, row, said[path], values.get(path, [])))
        holder = nodes.section()
        holder.document = self.state.document
        self.state.nested_parse(StringList(lines, "keys"), self.content_offset, holder, True)
        return holder.children


def _line(path: str, row: Row, said: tuple[str, str], values: list[Any]) -> str:
    entry, (span, source) = row.entry, said
    if span == "library":
        span, source = in_library(entry, values), "the library; " + source
    meaning = entry.meaning
    if isinstance(entry, Word):
        meaning += ": " + ", ".join(f"`{word}`" for word in entry.words)
    else:
        meaning += f", as `{entry.example}`"
    if row.law:
        meaning += f". With `{row.law}`"
    default = (
        "**needed**" if row.needed else "" if row.default in (None, "") else f"`{row.default}`"
    )
    cells = [f"`{path.rpartition('.')[2]}`", meaning, default, span, source]
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def setup(app):
    app.add_directive("keys", Keys)
    return {"parallel_read_safe": True}

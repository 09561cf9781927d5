"""Every key of the motor file in one map: path -> entry, for the laws a file has chosen.

The map is walked off the tables, so it cannot say anything else than the reader
does. The design space takes leaves from it, the writer units, the parameter
reference everything.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache
from typing import Annotated, Any, NamedTuple

from pydantic import BaseModel, create_model

from camring.files.errors import InputError, quote
from camring.files.motor.entries import Entry, Word
from camring.files.motor.laws import (
    SLOTS,
    Slot,
    known_laws,
    law_keys,
    laws_of,
    unfinished_law,
)
from camring.files.motor.tables import (
    CamTable,
    FileTables,
    MotorTable,
    PlanarCamTable,
    RadialCamTable,
    Table,
    ValvePlateTable,
)
from camring.files.motor.user_laws import SWITCH

CAMS: dict[str, type[CamTable]] = {"radial": RadialCamTable, "planar": PlanarCamTable}


@dataclass(frozen=True)
class Choices:
    """The laws a file has chosen, one for each slot, and the cam's representation."""

    laws: tuple[str, ...] = tuple(slot.default for slot in SLOTS)
    representation: str = "radial"

    def chosen(self, slot: Slot) -> type:
        return laws_of(slot)[self.laws[SLOTS.index(slot)]]


class ForeignKey(NamedTuple):
    """A key that exists, but only where another choice has been made."""

    chooser: str
    now: str
    needed: str


def choose(document: dict[str, Any]) -> Choices:
    """The choices a document makes.

    Raises
    ------
    InputError
        For a word that names no law.
    """
    laws = tuple(_law(document, slot) for slot in SLOTS)
    return Choices(laws, _word(document, "motor.cam.representation", tuple(CAMS), "radial"))


def _law(document: dict[str, Any], slot: Slot) -> str:
    path, known = f"{slot.table}.{slot.chooser}", tuple(laws_of(slot))
    try:
        return _word(document, path, known, slot.default, OWN)
    except InputError:
        given = _at(document, path)
        unfinished = unfinished_law(slot, given) if isinstance(given, str) else None
        if unfinished is None:
            raise
        law, lacking = unfinished
        methods = ", ".join(lacking)
        raise InputError(
            path, f"is {quote(given)}, whose class {law} has no {methods}", "define what it lacks"
        ) from None


OWN = f", or name the Python file of a law of your own in the variable {SWITCH}"


def _word(
    document: dict[str, Any], path: str, words: tuple[str, ...], default: str, more: str = ""
) -> str:
    here = _at(document, path)
    if here is None:
        return default
    if isinstance(here, str) and here in words:
        return here
    close = get_close_matches(here, words, n=1) if isinstance(here, str) else []
    hint = f" (did you mean {close[0]!r}?)" if close else ""
    listed = ", ".join(f'"{word}"' for word in words)
    one_of = "one of " if len(words) > 1 else ""
    raise InputError(path, f"is {quote(here)}{hint}", f"give {one_of}{listed}{more}")


def _at(document: dict[str, Any], path: str) -> Any:
    """What stands at a path; None for nothing, a word that TOML does not have."""
    here: Any = document
    for part in path.split("."):
        if not isinstance(here, dict) or part not in here:
            return None
        here = here[part]
    return here


def file_tables(choices: Choices) -> type[FileTables]:
    """The tables of a file with these choices, as one pydantic model."""
    return _file_tables(choices, known_laws())


@cache
def _file_tables(choices: Choices, known: tuple[type, ...]) -> type[FileTables]:
    added: dict[str, dict[str, Any]] = {}
    for slot in SLOTS:
        words = Word(f"the {slot.chooser} law", f'"{slot.default}"', words=tuple(laws_of(slot)))
        added.setdefault(slot.table, {})[slot.chooser] = (Annotated[str, words], slot.default)
        for path, entry, default in law_keys(slot, choices.chosen(slot)).values():
            table, key = path.rsplit(".", 1)
            added.setdefault(table, {})[key] = (Annotated[Any, entry], default)
    tables: dict[str, type[Table]] = {
        "motor.cam": CAMS[choices.representation],
        "motor.valve_plate": ValvePlateTable,
        "motor": MotorTable,
    }
    # Deepest first, so that a finished table becomes a field of the one around it.
    for path in sorted({*added, *tables}, key=lambda path: -path.count(".")):
        base = tables.get(path, _base_of(path))
        inner = {
            child.rsplit(".", 1)[1]: (tables[child], _needed(tables[child]))
            for child in tables
            if "." in child and child.rsplit(".", 1)[0] == path
        }
        fields: dict[str, Any] = {**added.get(path, {}), **inner}
        tables[path] = create_model(base.__name__, __base__=base, **fields)
    top: dict[str, Any] = {path: (table, ...) for path, table in tables.items() if "." not in path}
    return create_model("FileTables", __base__=FileTables, **top)


def _base_of(path: str) -> type[Table]:
    """The hand-written table at a path, or an empty one for a table that laws alone fill."""
    here: Any = FileTables
    for part in path.split("."):
        known = here.model_fields.get(part)
        here = known.annotation if known is not None else Table
    return here


def _needed(table: type[Table]) -> Any:
    """`...` for a table that must be there, else what it is when it is left out."""
    required = any(field.is_required() for field in table.model_fields.values())
    return ... if required else table()


def key_map(choices: Choices) -> dict[str, Entry]:
    """Every key by its path; those of operating points stand under `operating_points.`."""
    return _key_map(choices, known_laws())


@cache
def _key_map(choices: Choices, known: tuple[type, ...]) -> dict[str, Entry]:
    return dict(_walk(file_tables(choices), ""))


def _walk(table: type[BaseModel], prefix: str) -> Iterator[tuple[str, Entry]]:
    for name, field in table.model_fields.items():
        entries = [item for item in field.metadata if isinstance(item, Entry)]
        inner = inner_table(field.annotation)
        if entries:
            yield prefix + name, entries[0]
        elif inner is not None:
            yield from _walk(inner, f"{prefix}{name}.")


def inner_table(annotation: Any) -> type[BaseModel] | None:
    """The table a field holds, alone or in a list; None for a value."""
    for candidate in (annotation, *getattr(annotation, "__args__", ())):
        if isinstance(candidate, type) and issubclass(candidate, BaseModel):
            return candidate
    return None


def foreign_keys(choices: Choices) -> dict[str, ForeignKey]:
    """Keys that other choices would bring, with the choice each of them needs."""
    return _foreign_keys(choices, known_laws())


@cache
def _foreign_keys(choices: Choices, known: tuple[type, ...]) -> dict[str, ForeignKey]:
    found: dict[str, ForeignKey] = {}
    for slot in SLOTS:
        now = choices.laws[SLOTS.index(slot)]
        for name, law in laws_of(slot).items():
            for path, _, _ in law_keys(slot, law).values():
                found.setdefault(path, ForeignKey(f"{slot.table}.{slot.chooser}", now, name))
    for name, cam in CAMS.items():
        for key in cam.model_fields:
            found.setdefault(
                f"motor.cam.{key}",
                ForeignKey("motor.cam.representation", choices.representation, name),
            )
    here = key_map(choices)
    return {path: foreign for path, foreign in found.items() if path not in here}


def nearest(name: str, known: list[str]) -> str | None:
    """The known name that a misspelt one probably meant."""
    close = get_close_matches(name, known, n=1, cutoff=0.6)
    return close[0] if close else None

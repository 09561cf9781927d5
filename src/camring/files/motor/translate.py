"""What pydantic found wrong with a file, as one sentence with its full path."""

from typing import Any

from pydantic import BaseModel, ValidationError

from camring.files.errors import InputError, ordinal, quote
from camring.files.motor.keys import (
    Choices,
    file_tables,
    foreign_keys,
    inner_table,
    key_map,
    nearest,
)

MEANT = "you probably meant"


def input_error(error: ValidationError, choices: Choices) -> InputError:
    """The first fault that explains the others.

    A misspelt key comes before the missing one it was meant to be.
    """
    faults = error.errors(include_url=False)
    order = {"extra_forbidden": 0, "missing": 2}
    fault = min(faults, key=lambda each: order.get(each["type"], 1))
    return _sentence(dict(fault), choices)


def _sentence(fault: dict[str, Any], choices: Choices) -> InputError:
    place, kind, value = fault["loc"], fault["type"], fault["input"]
    path = dotted(place)
    if kind == "unfit":
        parts = fault["ctx"]
        return InputError(path + parts["inside"], parts["problem"], parts["way_out"])
    if kind == "missing":
        return _missing(place, path, choices)
    if kind == "extra_forbidden":
        return _unknown(place, path, choices)
    if kind == "list_type":
        return InputError(path, f"is {quote(value)} but must be a list", f"write [[{path}]]")
    return InputError(path, f"is {quote(value)} but must be a table", f"write it as [{path}]")


def _missing(place: tuple[int | str, ...], path: str, choices: Choices) -> InputError:
    entry = key_map(choices).get(plain(place))
    if entry is not None:
        return InputError(path, "is missing", entry.way_out)
    header = f"[[{path}]]" if path == "operating_points" else f"[{path}]"
    return InputError(header, "is missing", "add the table; `camring new` writes a file with all")


def _unknown(place: tuple[int | str, ...], path: str, choices: Choices) -> InputError:
    foreign = foreign_keys(choices).get(plain(place))
    if foreign is not None:
        chooser = foreign.chooser
        return InputError(
            path,
            f'has no effect with {chooser} = "{foreign.now}"',
            f'leave it out, or set {chooser} = "{foreign.needed}"',
        )
    table = _table_at(place[:-1], choices)
    known = list(table.model_fields) if table is not None else []
    close = nearest(str(place[-1]), known)
    header = f"[{dotted(place[:-1])}]" if len(place) > 1 else "a motor file"
    header = f"[[{place[0]}]]" if place[0] == "operating_points" and len(place) > 1 else header
    if close is not None:
        meant = dotted((*place[:-1], close))
        return InputError(quoted_path(place), f"is not a key of {header}", f"{MEANT} {meant}")
    elsewhere = [key for key in key_map(choices) if key.rsplit(".", 1)[-1] == place[-1]]
    if elsewhere:
        return InputError(
            quoted_path(place), f"is not a key of {header}", f"it belongs to {elsewhere[0]}"
        )
    return InputError(
        quoted_path(place),
        f"is not a key of {header}",
        "leave it out; known are " + ", ".join(known),
    )


def _table_at(place: tuple[int | str, ...], choices: Choices) -> type[BaseModel] | None:
    table: type[BaseModel] | None = file_tables(choices)
    for part in place:
        if isinstance(part, int) or table is None:
            continue
        table = inner_table(table.model_fields[part].annotation)
    return table


def dotted(place: tuple[int | str, ...]) -> str:
    """`motor.cam.degree`, `[[operating_points]] 2, speed`."""
    if len(place) > 1 and isinstance(place[1], int):
        table = f"[[{place[0]}]] {place[1] + 1}"
        return ", ".join([table, dotted(place[2:])] if place[2:] else [table])
    text = ""
    for part in place:
        text += f", {ordinal(part + 1)} value" if isinstance(part, int) else f".{part}"
    return text.removeprefix(".")


def quoted_path(place: tuple[int | str, ...]) -> str:
    """The dotted path, its last part quoted when it could not stand there bare."""
    last = str(place[-1])
    if last.isascii() and last.replace("_", "").replace("-", "").isalnum() and len(last) < 60:
        return dotted(place)
    return dotted((*place[:-1], quote(last)))


def plain(place: tuple[int | str, ...]) -> str:
    """The path without list indices, as the key map has it."""
    return ".".join(part for part in place if isinstance(part, str))

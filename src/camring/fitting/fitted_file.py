"""A fitted motor file: the given text with other numbers, and a remark where they come from."""

from pathlib import Path

from camring.files.errors import InputError
from camring.files.motor import parse_motor_file
from camring.files.motor.document import printable
from camring.files.motor.writer import changed_text
from camring.fitting.constants import AbstractFit
from camring.version import __version__

_BEGINS = "# Fitted with `camring fit` "


def fitted_text(found: AbstractFit) -> str:
    """The motor file's text with the fitted numbers in the units it uses, to six digits.

    Raises
    ------
    InputError
        When the file's own bounds or limits leave the fitted numbers out.
    """
    file = found.file
    values = {
        number.key: number.rounded(value)
        for number, value in zip(found.numbers, found.values.tolist(), strict=True)
    }
    text = changed_text(_without_remark(file.text), file.document, values, file.choices)
    try:
        parse_motor_file(text, file.path)
    except InputError as error:
        raise InputError(
            error.field,
            f"{error.problem}, once the fitted numbers are in the file",
            f"{error.way_out} in {file.path.name}",
        ) from None
    return _remark(found) + text


def interval_text(found: AbstractFit, place: int) -> str:
    """The 95 % interval of a number in words."""
    number = found.numbers[place]
    if not found.squares.free[place]:
        return "at a limit, no interval"
    if not found.determined(place):
        return "not determined by these rows"
    low, high = (number.shown(each[place]) for each in (found.low, found.high))
    return f"95 % from {low:.4g} to {high:.4g} {number.unit}".rstrip()


def _remark(found: AbstractFit) -> str:
    rows, values = len(found.table.lines), len(found.measured)
    table, given = (printable(Path(each.name)) for each in (found.table.path, found.file.path))
    lines = [f"{_BEGINS}{__version__} to {table}, {values} values of {rows} rows, from {given}:"]
    for place, number in enumerate(found.numbers):
        value = number.written(found.values[place])
        lines.append(f"#   {number.key} = {value}, {interval_text(found, place)}")
    return "\n".join(lines) + "\n\n"


def _without_remark(text: str) -> str:
    """The text without the remark of an earlier fit."""
    if not text.startswith(_BEGINS):
        return text
    lines = text.split("\n")
    end = next((n for n, line in enumerate(lines) if not line.startswith("#")), len(lines))
    return "\n".join(lines[end:]).lstrip("\n")

"""The header of a measured table: below titles, perhaps with a row of units of its own."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from camring.files.cells.cells import Cells
from camring.files.errors import InputError, quote
from camring.files.motor.keys import nearest
from camring.files.unit_spellings import ATMOSPHERE, ATMOSPHERE_SAID
from camring.fitting.measurements.columns import Column, column, is_known, may_be_unit, parts_of
from camring.fitting.measurements.names import (
    CONDITIONS,
    is_aside,
    is_other_result,
    meanings,
    words,
)
from camring.objective.measurable import MEASURABLE

HIGHEST_HEADER = 20  # rows of titles
OWN = 5  # results that no bench measures, in a table of our own
INDEPENDENT = ("mean_torque", "supply_flow", "case_drain")
KNOWN = 2  # names that make a row a header
HOW = (
    "begin with a header such as shaft speed [rpm], supply pressure [bar], mean torque [Nm] "
    "and give a row for each operating point"
)
_NUMBER_LIKE = re.compile(r"[+-]?[\d.,]*\d[\d.,]*([eE][+-]?\d+)?")


@dataclass(frozen=True)
class Header:
    """What the columns are.

    Attributes
    ----------
    columns
        One for each cell of the header; None where it is not read.
    below
        How many rows of the file stand above the first row of numbers.
    notes
        What was taken for a title.
    """

    columns: tuple[Column | None, ...]
    below: int
    notes: tuple[str, ...]

    @property
    def used(self) -> list[Column]:
        return [each for each in self.columns if each is not None]


def header_of(cells: Cells, shown: str, named: Mapping[str, str]) -> Header:
    """Find and read the header.

    Parameters
    ----------
    named
        Headers of the file by what they are.

    Raises
    ------
    InputError
        For a header that lacks, repeats or misspells something.
    """
    rows = cells.rows
    if not rows:
        raise InputError(shown, "holds no table", HOW)
    wanted = {_alike(header): name for name, header in named.items()}
    known = [
        sum(is_known(cell) or _alike(cell) in wanted for cell in row)
        for _, row in rows[:HIGHEST_HEADER]
    ]
    place = next((at for at, count in enumerate(known) if count >= KNOWN), 0)
    line, names = rows[place]
    names = list(names)
    while names and not names[-1]:
        names.pop()
    below = place + 1
    units: Sequence[str] = ()
    if below < len(rows) and _is_units(rows[below][1], names):
        units = rows[below][1]
        below += 1
    where = f"{shown} line {line}"
    _require_found(wanted, names, where)
    heads = [
        _with_unit(_renamed(name, wanted), units[at] if at < len(units) else "")
        for at, name in enumerate(names)
    ]
    columns = [column(each, f"{where}, column {n},") for n, each in enumerate(heads, 1)]
    columns, own = _without_derived(columns, heads)
    _require_enough(columns, where)
    titles = tuple(
        f"Line {n} is taken for a title: {' '.join(filter(None, row))[:60]}"
        for n, row in rows[:place]
    )
    aside = [each for each in heads if is_aside(parts_of(each)[0])]
    notes = [*titles, *own, *([f"Columns left out: {', '.join(aside)}."] if aside else [])]
    if any(each.offset == ATMOSPHERE for each in columns if each is not None):
        notes.append(f"{ATMOSPHERE_SAID[0].upper()}{ATMOSPHERE_SAID[1:]}.")
    return Header(tuple(columns), below, tuple(notes))


def _without_derived(
    columns: list[Column | None], heads: Sequence[str]
) -> tuple[list[Column | None], list[str]]:
    """A table that camring wrote has every result; those made of others count once."""
    others = sum(each is None and is_other_result(parts_of(head)[0])
                 for each, head in zip(columns, heads, strict=True))  # fmt: skip
    there = [each.name for each in columns if each is not None]
    measured = [name for name in INDEPENDENT if name in there]
    if others < OWN or not measured:
        return columns, []
    kept = [
        each if each is None or each.name in CONDITIONS or each.name in measured else None
        for each in columns
    ]
    said = ", ".join(map(words, measured))
    return kept, [f"The table is one that camring wrote; of its results are fitted: {said}."]


def _alike(header: str) -> str:
    return " ".join(header.split()).lower()


def _renamed(cell: str, wanted: Mapping[str, str]) -> str:
    """`torque [Nm]` for `M [Nm]` where the user said that this is the torque."""
    name = wanted.get(_alike(cell))
    if name is None:
        return cell
    unit = parts_of(cell)[1]
    return name if "[" in name or not unit else f"{name} [{unit}]"


def _with_unit(cell: str, unit: str) -> str:
    unit = unit.strip().strip("[]()").strip()
    if not cell or not unit or cell.startswith("(") or parts_of(cell)[1]:
        return cell or "(unnamed)"
    return f"{cell} [{unit}]"


def _is_units(row: Sequence[str], names: Sequence[str]) -> bool:
    """Whether a row holds units and no number, and some name above lacks its own."""
    filled = [cell for cell in row if cell]
    if any(_NUMBER_LIKE.fullmatch(cell) and cell != "1" for cell in filled):
        return False
    lacking = any(name and not parts_of(name)[1] for name in names)
    units = [cell for cell in filled if cell not in ("-", "–", "1")]
    known = [
        cell
        for cell, name in zip(row, names, strict=False)
        if cell and (is_known(name) or may_be_unit(cell))
    ]
    return lacking and bool(units) and all(map(may_be_unit, known))


def _require_found(wanted: Mapping[str, str], names: Sequence[str], where: str) -> None:
    there = [_alike(each) for each in names]
    for header, name in wanted.items():
        if not meanings(parts_of(name)[0]):
            raise InputError(
                f"--column {quote(name)}",
                "is nothing that can be read here",
                "write, for example, torque or shaft_speed",
            )
        if header not in there:
            close = nearest(header, there)
            raise InputError(
                f"--column {quote(name)}",
                f"names {quote(header)}, which {where} does not have",
                f"you probably meant {close}" if close else f"name one of {', '.join(there)}",
            )


def _require_enough(columns: Sequence[Column | None], where: str) -> None:
    known = [each for each in columns if each is not None]
    seen: dict[tuple[str, bool], Column] = {}
    for each in known:
        twin = seen.setdefault((each.name, each.deviation), each)
        if twin is not each:
            raise InputError(
                where,
                f"has two columns of the same, {quote(twin.header)} and {quote(each.header)}",
                "write one of them in brackets to leave it out",
            )
    names = {name for name, deviation in seen if not deviation}
    if "shaft_speed" not in names:
        raise InputError(where, "has no column shaft speed [rpm]", "add it")
    if ("supply_pressure" in names) == ("pressure_drop" in names):
        lacks = "supply_pressure" not in names
        raise InputError(
            where,
            "has no column supply pressure [bar]" if lacks else "has both supply pressure and drop",
            "add it, or pressure drop [bar]"
            if lacks
            else "write one of them in brackets to leave it out",
        )
    if not names & set(MEASURABLE):
        raise InputError(
            where,
            "names no measured result",
            "add one such as mean torque [Nm], supply flow [L/min], case drain [L/min] "
            "or efficiency [%]",
        )
    for name, deviation in seen:
        if deviation and name not in names:
            raise InputError(
                where,
                f"has {quote(seen[name, True].header)} without its result",
                f"add a column {name.replace('_', ' ')}",
            )

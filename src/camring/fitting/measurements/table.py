"""Measured torque, flow, efficiency as a table that a test bench or a spreadsheet wrote.

A header names columns with their units (`columns.py`), which may stand in a row of
their own; title lines may be above it. Each row below is one operating point. Commas,
semicolons or tabs separate, numbers have decimal points or commas (`files/cells`). Lines that
begin with `#` are remarks.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from os import fspath
from pathlib import Path

import numpy as np
from jaxtyping import Float

from camring.files.cells.cells import Cells, cells_of, read_cells
from camring.files.cells.numbers import decimal_sign, marks_of_missing, number, tidy
from camring.files.errors import InputError, quote
from camring.files.motor.document import printable
from camring.fitting.measurements.columns import Column
from camring.fitting.measurements.header import HOW, Header, header_of
from camring.fitting.measurements.names import CONDITIONS
from camring.fitting.measurements.temperatures import with_rise
from camring.objective.measurable import MEASURABLE

MOST_ROWS = 2000
NEEDED = ("shaft_speed", "supply_pressure", "pressure_drop")  # in every row
HIGHEST_SHARE = 1.5  # an efficiency above it was given in per cent without saying so
SHOWN = 5  # lines in one sentence

Row = Float[np.ndarray, " row"]


@dataclass(frozen=True, eq=False)
class MeasuredTable:
    """Rows of measured results.

    Attributes
    ----------
    lines
        Of the file, for each row.
    conditions
        What the rows say of their operating points, SI, absolute; NaN where a cell is empty.
    values, deviations
        By result, SI; NaN where nothing was measured, or no standard deviation is given.
    left_out
        Rows without any result.
    notes
        What was left out, or read otherwise than it is written, a sentence each.
    """

    path: Path
    lines: tuple[int, ...]
    conditions: dict[str, Row]
    values: dict[str, Row]
    deviations: dict[str, Row]
    left_out: int
    notes: tuple[str, ...] = ()

    def where(self, row: int, name: str = "") -> str:
        """A row, and in it what a column is about, for messages."""
        place = f"{printable(self.path)} line {self.lines[row]}"
        return f"{place}, {name.replace('_', ' ')}," if name else place


def read_measured_table(
    path: str | Path, columns: Mapping[str, str] | None = None
) -> MeasuredTable:
    """Read and check a table, of CSV or the first sheet of an XLSX workbook.

    Parameters
    ----------
    columns
        Headers of the file by what they are, where they do not say so:
        `{"torque": "M [Nm]", "shaft speed [rpm]": "Drehzahl"}`.

    Raises
    ------
    InputError
        In one sentence with line and column.
    """
    place = Path(fspath(path))
    return _table(read_cells(place), place, columns or {})


def parse_measured_table(
    text: str, path: Path = Path("measured.csv"), columns: Mapping[str, str] | None = None
) -> MeasuredTable:
    """The table in a text; `path` is only for messages."""
    return _table(cells_of(text, printable(path)), path, columns or {})


def _table(cells: Cells, path: Path, named: Mapping[str, str]) -> MeasuredTable:
    shown = printable(path)
    head = header_of(cells, shown, named)
    lines, texts = _texts(cells, head, shown)
    sign = _sign(cells, lines, texts, shown)
    read, notes = _numbers(head, lines, texts, sign, shown)
    names = {(each.name, each.deviation): read[:, k] for k, each in enumerate(head.used)}
    names = with_rise(names, shown)
    results = {name: names[name, False] for name in MEASURABLE if (name, False) in names}
    values = {name: each for name, each in results.items() if np.any(np.isfinite(each))}
    if not values:
        raise InputError(shown, "holds no measured number", HOW)
    deviations = {name: names.get((name, True), np.full(len(lines), np.nan)) for name in values}
    table = MeasuredTable(
        path=path,
        lines=tuple(lines),
        conditions={name: names[name, False] for name in CONDITIONS if (name, False) in names},
        values=values,
        deviations=deviations,
        left_out=0,
        notes=(*head.notes, *notes),
    )
    measured = np.any(np.isfinite(list(values.values())), axis=0)
    table = replace(_rows(table, measured), left_out=int(np.sum(~measured)))
    _require_whole(table)
    return _without_twins(table)


def _texts(cells: Cells, head: Header, shown: str) -> tuple[list[int], list[list[str]]]:
    """Lines and cells of the rows below the header, of the columns that are read."""
    rows = cells.rows[head.below :]
    if not rows:
        raise InputError(shown, "has a header and no rows", "add a row for each operating point")
    if len(rows) > MOST_ROWS:
        raise InputError(shown, f"has {len(rows)} rows, more than {MOST_ROWS}", "thin them out")
    found = []
    for line, row in rows:
        while len(row) > len(head.columns) and not row[-1]:
            row = row[:-1]
        if not cells.separator:
            row = row + [""] * (len(head.columns) - len(row))
        if len(row) != len(head.columns):
            raise InputError(
                f"{shown} line {line}",
                f"has {len(row)} cells where the header has {len(head.columns)}",
                "give each column a cell, an empty one where nothing was measured"
                + ("; separate by semicolons where numbers have decimal commas"
                   if cells.separator == "," else ""),
            )  # fmt: skip
        found.append([row[place] for place, each in enumerate(head.columns) if each is not None])
    return [line for line, _ in rows], found


def _sign(cells: Cells, lines: list[int], texts: list[list[str]], shown: str) -> str:
    """The decimal sign of the whole table."""
    if not cells.separator:
        return "."
    sign = decimal_sign(cell for row in texts for cell in row)
    if sign != "both":
        return sign
    seen = [(line, cell, decimal_sign([cell]))
            for line, row in zip(lines, texts, strict=True) for cell in row]  # fmt: skip
    point, comma = (next(each for each in seen if each[2] == sign) for sign in ".,")
    raise InputError(
        f"{shown} line {comma[0]}",
        f"has {quote(comma[1])} where line {point[0]} has {quote(point[1])}",
        "write all numbers with decimal points, or all with decimal commas",
    )


def _numbers(
    head: Header, lines: list[int], texts: list[list[str]], sign: str, shown: str
) -> tuple[Float[np.ndarray, "row column"], list[str]]:
    """SI values of all cells, and what is to be said of them."""
    found, said = np.full((len(texts), len(head.used)), np.nan), []
    for place, each in enumerate(head.used):
        cells = [row[place] for row in texts]
        where = [f"{shown} line {line}, {each.header}," for line in lines]
        read = [number(cell, sign, at) for cell, at in zip(cells, where, strict=True)]
        plain = np.array([value for value, _ in read])
        grouped = [row for row, (_, thousands) in enumerate(read) if thousands]
        if grouped:
            first = grouped[0]
            said.append(
                f"{each.header}: {cells[first]} in {_lines(lines, grouped)} is read as "
                f"{plain[first]:g}, as decimals of this table have a "
                f"{'point' if sign == '.' else 'comma'}."
            )
        marks = marks_of_missing(cells, plain)
        if np.any(marks):
            rows = np.flatnonzero(marks).tolist()
            if each.name in NEEDED:
                raise InputError(
                    where[rows[0]],
                    f"is {quote(cells[rows[0]])}, a mark of a missing value",
                    "give it, or take the row out",
                )
            said.append(
                f"{each.header}: {tidy(cells[rows[0]])} in {_lines(lines, rows)} is taken for a "
                "mark of a missing value and left out."
            )
        for row in np.flatnonzero(np.isfinite(plain) & ~marks):
            value = plain[row] * each.factor + each.offset
            _require_possible(each, value, cells[row], where[row])
            found[row, place] = value
    return found, said


def _require_possible(of: Column, value: float, cell: str, where: str) -> None:
    if of.deviation and value <= 0:
        raise InputError(where, f"is {quote(cell)} but must be above zero", "leave it empty")
    if "efficiency" in of.name and value > HIGHEST_SHARE:
        raise InputError(
            where,
            f"is {quote(cell)}, which is {100 * value:g} %",
            f"write its unit in the header, {of.name.replace('_', ' ')} [%]",
        )


def _lines(lines: Sequence[int], rows: Sequence[int]) -> str:
    """`line 5`, `lines 5, 7 and 9`, `line 5 and 12 others`."""
    shown = [str(lines[row]) for row in rows]
    if len(shown) > SHOWN:
        return f"line {shown[0]} and {len(shown) - 1} others"
    if len(shown) == 1:
        return f"line {shown[0]}"
    return f"lines {', '.join(shown[:-1])} and {shown[-1]}"


def _rows(table: MeasuredTable, kept: Sequence[bool] | np.ndarray) -> MeasuredTable:
    """Some rows of a table."""
    kept = np.asarray(kept, dtype=bool)

    def some(columns: dict[str, Row]) -> dict[str, Row]:
        return {name: values[kept] for name, values in columns.items()}

    return replace(
        table,
        lines=tuple(line for line, keep in zip(table.lines, kept, strict=True) if keep),
        conditions=some(table.conditions),
        values=some(table.values),
        deviations=some(table.deviations),
    )


def _without_twins(table: MeasuredTable) -> MeasuredTable:
    """Rows that are the same to the last digit count once: a copy tells nothing new."""
    columns = [*table.conditions.values(), *table.values.values(), *table.deviations.values()]
    seen: dict[bytes, int] = {}
    kept, twins = [], []
    for row, key in enumerate(np.stack(columns, axis=1)):
        first = seen.setdefault(key.tobytes(), row)
        kept.append(first == row)
        if first != row:
            twins.append((first, row))
    if not twins:
        return table
    pairs = [f"line {table.lines[row]} as line {table.lines[first]}" for first, row in twins]
    named = ", ".join(pairs[:SHOWN]) + (f" and {len(pairs) - SHOWN} more" * (len(pairs) > SHOWN))
    what = "row is" if len(twins) == 1 else "rows are"
    note = (
        f"{len(twins)} {what} the same as another to the last digit and "
        f"{'counts' if len(twins) == 1 else 'count'} once: {named}."
    )
    return replace(_rows(table, kept), notes=(*table.notes, note))


def _require_whole(table: MeasuredTable) -> None:
    """Speed and pressure in every row; standard deviations for all values of a result or none."""
    for name in NEEDED:
        missing = np.flatnonzero(np.isnan(table.conditions.get(name, np.zeros(1))))
        if len(missing):
            raise InputError(
                table.where(int(missing[0]), name), "is missing", "give it, or take the row out"
            )
    for name, deviations in table.deviations.items():
        if np.all(np.isnan(deviations)):
            continue
        missing = np.flatnonzero(np.isfinite(table.values[name]) & np.isnan(deviations))
        if len(missing):
            raise InputError(
                table.where(int(missing[0]), name),
                "has no standard deviation but others of its column have one",
                "give each its own, or write the name of that column in brackets",
            )

"""Measured torque, flow, efficiency as a CSV file that a test bench or a spreadsheet wrote.

A header names columns with their units (`measured_columns.py`); each row below is one
operating point. Commas, semicolons or tabs separate; with semicolons or tabs a number may
have a decimal comma. Lines that begin with `#` are remarks.
"""

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite, nan
from os import fspath
from pathlib import Path

import numpy as np
from jaxtyping import Float

from camring.interfaces.config.document import printable
from camring.interfaces.errors import InputError, quote
from camring.interfaces.measured_columns import DUTIES, Column, column
from camring.objective.measurable import MEASURABLE

LARGEST_FILE = 2_000_000  # bytes
MOST_ROWS = 2000
LONGEST_LINE = 20_000
HIGHEST_SHARE = 1.5  # an efficiency above it was given in per cent without saying so
MISSING = {"", "-", "–", "n/a", "N/A", "nan", "NaN"}
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_THOUSANDS = re.compile(r"[+-]?\d{1,3}(\.\d{3})+(,\d+)?")

Row = Float[np.ndarray, " row"]


@dataclass(frozen=True, eq=False)
class MeasuredTable:
    """Rows of measured results.

    Attributes
    ----------
    lines
        Of the file, for each row.
    duties
        What the rows say of their operating points, SI, absolute; NaN where a cell is empty.
    values, deviations
        By result, SI; NaN where nothing was measured, or no standard deviation is given.
    left_out
        Rows without any result.
    """

    path: Path
    lines: tuple[int, ...]
    duties: dict[str, Row]
    values: dict[str, Row]
    deviations: dict[str, Row]
    left_out: int

    def where(self, row: int, name: str = "") -> str:
        """A row, and in it what a column is about, for messages."""
        place = f"{printable(self.path)} line {self.lines[row]}"
        return f"{place}, {name.replace('_', ' ')}," if name else place


def read_measured_table(path: str | Path) -> MeasuredTable:
    """Read and check a table.

    Raises
    ------
    InputError
        In one sentence with line and column.
    """
    place = Path(fspath(path))
    return parse_measured_table(_text(place), place)


def parse_measured_table(text: str, path: Path = Path("measured.csv")) -> MeasuredTable:
    """The table in a text; `path` is only for messages."""
    shown = printable(path)
    records = [
        (number, line)
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip(" \t;,") and not line.lstrip().startswith("#")
    ]
    if not records:
        raise InputError(shown, "holds no table", _HOW)
    separator = next((each for each in ";\t" if each in records[0][1]), ",")
    head, *rows = [(number, _cells(line, separator)) for number, line in records]
    columns = _columns(head[1], f"{shown} line {head[0]}")
    if not rows:
        raise InputError(shown, "has a header and no rows", "add a row for each operating point")
    if len(rows) > MOST_ROWS:
        raise InputError(shown, f"has {len(rows)} rows, more than {MOST_ROWS}", "thin them out")
    comma = separator != "," and any(re.search(r"\d,\d", cell) for _, row in rows for cell in row)
    read = np.array([_row(row, columns, f"{shown} line {n}", comma) for n, row in rows])
    used = [each for each in columns if each is not None]
    names = {(each.name, each.deviation): read[:, k] for k, each in enumerate(used)}
    results = {name: names[name, False] for name in MEASURABLE if (name, False) in names}
    values = {name: each for name, each in results.items() if np.any(np.isfinite(each))}
    if not values:
        raise InputError(shown, "holds no measured number", _HOW)
    kept = np.any(np.isfinite(list(values.values())), axis=0)
    table = MeasuredTable(
        path=path,
        lines=tuple(n for (n, _), keep in zip(rows, kept, strict=True) if keep),
        duties={name: names[name, False][kept] for name in DUTIES if (name, False) in names},
        values={name: each[kept] for name, each in values.items()},
        deviations={
            name: names[name, True][kept] if (name, True) in names else np.full(kept.sum(), nan)
            for name in values
        },
        left_out=int(np.sum(~kept)),
    )
    _require_whole(table)
    return table


_HOW = (
    "begin with a header such as shaft speed [rpm], supply pressure [bar], mean torque [Nm] "
    "and give a row for each operating point"
)


def _text(path: Path) -> str:
    shown = printable(path)
    try:
        if path.is_dir():
            raise InputError(shown, "is a directory", "name a CSV file in it")
        if path.exists() and not path.is_file():
            raise InputError(shown, "is not a regular file", "name a CSV file")
        with open(path, "rb") as file:
            content = file.read(LARGEST_FILE + 1)
    except FileNotFoundError:
        raise InputError(shown, "does not exist", "name a CSV file of measured rows") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(
            shown, f"cannot be read ({reason.lower()})", "name a file that you may read"
        ) from None
    if len(content) > LARGEST_FILE:
        raise InputError(shown, f"has more than {LARGEST_FILE:,} bytes", "thin its rows out")
    if content.startswith(b"PK\x03\x04"):
        raise InputError(shown, "is a workbook", "save its sheet as CSV")
    if b"\0" in content:
        raise InputError(shown, "is no text", "save the table as CSV with the encoding UTF-8")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("cp1252", "replace")  # as spreadsheets on Windows write it


def _cells(line: str, separator: str) -> list[str]:
    cells = next(csv.reader([line], delimiter=separator)) if len(line) < LONGEST_LINE else [line]
    return [cell.strip() for cell in cells]


def _columns(cells: Sequence[str], where: str) -> list[Column | None]:
    while cells and not cells[-1]:
        cells = cells[:-1]
    columns = [column(cell, f"{where}, column {n},") for n, cell in enumerate(cells, 1)]
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
    return columns


def _row(
    cells: Sequence[str], columns: Sequence[Column | None], where: str, comma: bool
) -> list[float]:
    while len(cells) > len(columns) and not cells[-1]:
        cells = cells[:-1]
    if len(cells) != len(columns):
        raise InputError(
            where,
            f"has {len(cells)} cells where the header has {len(columns)}",
            "give each column a cell, an empty one where nothing was measured"
            + ("" if comma else "; separate by semicolons where numbers have decimal commas"),
        )
    return [
        _value(cell, each, f"{where}, {each.header},", comma)
        for cell, each in zip(cells, columns, strict=True)
        if each is not None
    ]


def _value(cell: str, of: Column, where: str, comma: bool) -> float:
    """SI value of a cell; NaN for an empty one."""
    if cell in MISSING:
        return nan
    text = cell.replace("−", "-").replace("\u00a0", "").replace("\u202f", "")
    if comma and _THOUSANDS.fullmatch(text):
        raise InputError(
            where,
            f"is {quote(cell)}, in which a point may be of thousands",
            "write it without, as the table has decimal commas",
        )
    plain = text.replace(",", ".") if comma else text
    if not _NUMBER.fullmatch(plain) or not isfinite(float(plain)):
        raise InputError(
            where, f"is {quote(cell)}, which is no number", "write a number, or leave it empty"
        )
    value = float(plain) * of.factor + of.offset
    if of.deviation and value <= 0:
        raise InputError(where, f"is {quote(cell)} but must be above zero", "leave it empty")
    if "efficiency" in of.name and value > HIGHEST_SHARE:
        raise InputError(
            where,
            f"is {quote(cell)}, which is {100 * value:g} %",
            f"write its unit in the header, {of.name.replace('_', ' ')} [%]",
        )
    return value


def _require_whole(table: MeasuredTable) -> None:
    """Speed and pressure in every row; standard deviations for all values of a result or none."""
    for name in ("shaft_speed", "supply_pressure", "pressure_drop"):
        missing = np.flatnonzero(np.isnan(table.duties.get(name, np.zeros(1))))
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

"""Every table that camring writes as CSV: one convention, one writer.

Remarks come first, each behind `#`; then one row of names, each with its unit,
`chamber_pressure [bar]`, bare where there is none; then the rows. A comma parts cells and a
point decimals, or a semicolon and a comma (`Decimal.COMMA`) as spreadsheets of most of Europe
want it. A number that is not there is `NaN`, a text that is not there is empty. Cells hold no
`#`, which readers take for a remark. Text that a spreadsheet would take for a formula begins with
`'`, as spreadsheets themselves mark text: a name from a stranger's file must not compute.
"""

import csv
import io
import re
from collections.abc import Iterable, Sequence
from enum import StrEnum
from math import isfinite
from typing import Annotated, Any

import typer

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_FORMULA = re.compile(r"[=+\-@＝＋－＠].")
"""How spreadsheets know a formula, those of East Asia too; a sign alone is none."""
_FORMULA_IN_A_LINE = re.compile(r"([,;][\s\"']*)(?=[=@＝＠]|[+\-＋－](?!\d[\d.]*(?:[\s,;]|$)))")
"""The same behind a separator; a number with its sign is none."""
_ASCII = str.maketrans({"·": ".", "²": "^2", "³": "^3", "°": "deg", "µ": "u", "−": "-"})


class Decimal(StrEnum):
    """What parts decimals."""

    POINT = "point"
    COMMA = "comma"


DecimalOption = Annotated[
    Decimal,
    typer.Option(
        "--decimal",
        help="Sign of decimals in CSV files; with comma semicolons part the cells, as "
        "spreadsheets of such countries read it.",
    ),
]


def named(name: str, unit: str = "") -> str:
    """A column's name with its unit: `chamber_pressure [bar]`."""
    plain = unit.translate(_ASCII).strip()
    return name if plain in ("", "1", "-") else f"{name} [{plain}]"


def csv_table(
    columns: Sequence[str],
    rows: Iterable[Sequence[Any]],
    *,
    remarks: Iterable[str] = (),
    decimal: Decimal = Decimal.POINT,
) -> str:
    """The text of a CSV file.

    Parameters
    ----------
    columns
        Names as from `named`.
    rows
        Numbers, texts, or numbers already written as text with a decimal point, a cell for
        each column.
    remarks
        Lines above the table.
    """
    text = io.StringIO()
    for line in remarks:
        text.write(f"# {_remark(line)}\n")
    table = csv.writer(
        text, lineterminator="\n", delimiter=";" if decimal == Decimal.COMMA else ","
    )
    table.writerow([_text(name) for name in columns])
    table.writerows([_cell(each, decimal) for each in row] for row in rows)
    return text.getvalue()


def _cell(value: Any, decimal: Decimal) -> str:
    if isinstance(value, str):
        if not _NUMBER.fullmatch(value):
            return _text(value)
        written = value
    elif isinstance(value, bool):
        return "yes" if value else "no"
    elif isinstance(value, int):
        return str(value)
    else:
        number = float(value)
        written = repr(number) if isfinite(number) else "NaN"
    return written.replace(".", ",") if decimal == Decimal.COMMA else written


def _text(value: str) -> str:
    text = " ".join(value.replace("#", "No. ").split())
    return f"'{text}" if _FORMULA.match(text) else text


def _remark(line: str) -> str:
    """A spreadsheet parts remarks at their commas like everything else."""
    return _FORMULA_IN_A_LINE.sub(r"\1'", " ".join(line.split()))

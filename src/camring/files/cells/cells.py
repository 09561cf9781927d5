"""A file of measured rows as cells: its encoding, separator, quotes, remarks, or workbook."""

import csv
from os import fspath
from pathlib import Path
from typing import NamedTuple

from camring.files.cells.workbook import workbook_rows
from camring.files.errors import InputError
from camring.files.motor.document import printable

LARGEST_FILE = 2_000_000  # bytes
LONGEST_CELL = 2000
SEP_LENGTH = len("sep=;")
_EMPTY = " \t;,\r\n"


class Cells(NamedTuple):
    """Rows that hold anything: line in the file and cells. `separator` is "" of a workbook."""

    rows: list[tuple[int, list[str]]]
    separator: str


def read_cells(path: str | Path) -> Cells:
    """All rows of a CSV file or of a workbook's first sheet.

    Raises
    ------
    InputError
        For a file that is no table or cannot be read.
    """
    place = Path(fspath(path))
    content, shown = _content(place), printable(place)
    if content.startswith(b"PK\x03\x04"):
        return Cells(workbook_rows(content, shown), "")
    if content.startswith(b"\xd0\xcf\x11\xe0"):
        raise InputError(shown, "is an old workbook", "save it as XLSX or its sheet as CSV")
    return cells_of(_decoded(content, shown), shown)


def cells_of(text: str, shown: str) -> Cells:
    """The rows of a text; cells in quotes may hold separators and line ends."""
    lines = text.splitlines(keepends=True)
    separator = ""
    kept: list[str] = []
    for line in lines:
        bare = line.strip('\r\n"')
        if not separator and bare.lower().startswith("sep=") and len(bare) == SEP_LENGTH:
            separator, line = bare[-1], "\n"
        # A remark keeps its line, so that lines are counted as an editor counts them.
        kept.append("\n" if line.lstrip().startswith("#") else line)
    separator = separator or _separator(kept)
    rows: list[tuple[int, list[str]]] = []
    reader = csv.reader(kept, delimiter=separator)
    before = 0
    try:
        for row in reader:
            cells = [" ".join(cell.split()) for cell in row]
            if any(len(cell) > LONGEST_CELL for cell in cells):
                raise InputError(
                    f"{shown} line {before + 1}", "has a cell without end", "close its quotes"
                )
            if any(cell.strip(_EMPTY) for cell in cells):
                rows.append((before + 1, cells))
            before = reader.line_num
    except csv.Error:
        raise InputError(
            f"{shown} line {before + 1}", "is no row of a table", "save the table as CSV"
        ) from None
    return Cells(rows, separator)


def _separator(lines: list[str]) -> str:
    """The one that most lines have; commas where no line has another."""
    filled = [line for line in lines if line.strip(_EMPTY)]
    return max(";\t", key=lambda sign: sum(sign in line for line in filled)) if any(
        sign in line for line in filled[:_HEAD] for sign in ";\t"
    ) else ","  # fmt: skip


_HEAD = 20


def _content(path: Path) -> bytes:
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
    return content


def _decoded(content: bytes, shown: str) -> str:
    """Text of UTF-8, UTF-16 with or without its mark, or a Windows spreadsheet's code page."""
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return content.decode("utf-16", "replace")
    if b"\0" in content:
        # Plain letters of UTF-16 have a zero in front, or behind.
        for name, zeros in (("utf-16-le", content[1::2]), ("utf-16-be", content[::2])):
            if zeros.count(0) > len(zeros) // 2 and not content.count(b"\0\0"):
                return content.decode(name, "replace")
        raise InputError(shown, "is no text", "save the table as CSV with the encoding UTF-8")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("cp1252", "replace")

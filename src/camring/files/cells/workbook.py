"""The first sheet of an XLSX workbook as rows of text, read without any library.

A workbook is a ZIP archive of XML (ECMA-376, part 1, 18.3): cells hold numbers, text of
their own, or places in a list of texts that all sheets share.
"""

import re
import struct
import zlib
from io import BytesIO
from lzma import LZMAError
from xml.etree import ElementTree
from zipfile import BadZipFile, ZipFile

from camring.files.errors import InputError

LARGEST_PART = 20_000_000  # bytes of XML
MOST_CELLS = 2_000_000  # with the empty ones between: two cells can span a sheet
_SHEETS = re.compile(r"xl/worksheets/sheet\d+\.xml")
_CELL = re.compile(r"([A-Z]{1,3})(\d+)")
_LETTERS = 26
# `zipfile` has an error of its own for a damaged list of parts only: a damaged stream, a length
# that is none, a way to compress that nobody knows and a password each come as something else.
_DAMAGE = (
    *(BadZipFile, zlib.error, LZMAError, struct.error, ElementTree.ParseError, EOFError, OSError),
    *(NotImplementedError, RuntimeError, KeyError, ValueError, IndexError),
)


def workbook_rows(content: bytes, shown: str) -> list[tuple[int, list[str]]]:
    """Number and cells of each row of the first sheet that has any.

    Raises
    ------
    InputError
        For what is no workbook, or one that is too large or damaged.
    """
    try:
        with ZipFile(BytesIO(content)) as archive:
            names = sorted(filter(_SHEETS.fullmatch, archive.namelist()), key=_number)
            if not names:
                raise InputError(shown, "is no XLSX workbook", "save the table as CSV or XLSX")
            texts = _shared(archive, shown)
            for name in names:
                rows = _rows(_xml(archive, name, shown), texts, shown)
                if rows:
                    return rows
    except InputError:
        raise
    except _DAMAGE:
        raise InputError(shown, "is a damaged workbook", "save its sheet as CSV") from None
    return []


def _number(name: str) -> int:
    return int(re.sub(r"\D", "", name))


def _xml(archive: ZipFile, name: str, shown: str) -> ElementTree.Element:
    if archive.getinfo(name).file_size > LARGEST_PART:
        raise InputError(shown, "is too large a workbook", "save its sheet as CSV")
    text = archive.read(name)
    # The only way in which XML can grow without end; in UTF-16, which no workbook is, it is hidden.
    if b"<!DOCTYPE" in text or b"\0" in text:
        raise InputError(shown, "is no plain workbook", "save its sheet as CSV")
    return ElementTree.fromstring(text)


def _shared(archive: ZipFile, shown: str) -> list[str]:
    if "xl/sharedStrings.xml" not in archive.namelist():
        return []
    return [_text(item) for item in _xml(archive, "xl/sharedStrings.xml", shown)]


def _text(item: ElementTree.Element) -> str:
    return "".join(part.text or "" for part in item.iter() if part.tag.endswith("}t"))


def _rows(sheet: ElementTree.Element, texts: list[str], shown: str) -> list[tuple[int, list[str]]]:
    found: dict[int, dict[int, str]] = {}
    for cell in (each for each in sheet.iter() if each.tag.endswith("}c")):
        place = _CELL.fullmatch(cell.get("r", ""))
        if place is None:
            raise ValueError("a cell without a place")
        value = _value(cell, texts).strip()
        if value:
            found.setdefault(int(place[2]), {})[_column(place[1])] = value
    width = max((max(row) for row in found.values()), default=0) + 1
    if width * len(found) > MOST_CELLS:
        raise InputError(shown, "is too large a workbook", "save its sheet as CSV")
    return [
        (line, [row.get(column, "") for column in range(width)])
        for line, row in sorted(found.items())
    ]


def _column(letters: str) -> int:
    place = 0
    for letter in letters:
        place = place * _LETTERS + ord(letter) - ord("A") + 1
    return place - 1


def _value(cell: ElementTree.Element, texts: list[str]) -> str:
    if cell.get("t") == "inlineStr":
        return _text(cell)
    inside = next((each.text or "" for each in cell if each.tag.endswith("}v")), "")
    return texts[int(inside)] if cell.get("t") == "s" else inside

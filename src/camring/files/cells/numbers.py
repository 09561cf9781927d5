"""Numbers as benches and spreadsheets write them: decimal signs, thousands, missing marks."""

import re
from collections.abc import Iterable
from math import isfinite, nan

import numpy as np
from jaxtyping import Bool, Float

from camring.files.errors import InputError, quote

MISSING = frozenset(
    [
        *("", "-", "–", "—", "--", "---", "n/a", "na", "n.a.", "n.b.", "nan", "null", "none"),
        *("inf", "-inf", "#n/a", "#div/0!", "#value!", "#ref!", "#num!", "#name?", "#null!"),
    ]
)
"""In small letters: a value that was not measured."""
MUCH_LARGER = 3.0
BEYOND = 1e20
"""No bench measures so much of anything; SCPI's 9.9E37 is an overload and 9.91E37 no number."""
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_GROUPS = re.compile(r"[+-]?[1-9]\d{0,2}([.,])\d{3}(?:\1\d{3})*")
_GROUPS_AND_PART = re.compile(r"[+-]?[1-9]\d{0,2}([.,])\d{3}(?:\1\d{3})*(?!\1)[.,]\d+")
_PART = re.compile(r"[+-]?\d*([.,])\d+(?:[eE][+-]?\d+)?")
_MARK = re.compile(r"-?9{3,}(?:[.,]9*0*)?|-9?9(?:[.,]9+)|-?9[.,]9{2,}[eE]\+?\d+")


def decimal_sign(cells: Iterable[str]) -> str:
    """ "." or "," where cells show which one parts decimals, "" where none does, "both" if both.

    `531,6`, `0,604`, `1.430,5` and `1.430.000` show a comma, `8.52`, `1,430.5` and `1,430,000`
    a point; `1,430` alone shows nothing, as three digits may be thousands.
    """
    shown = set()
    for cell in map(tidy, cells):
        if _GROUPS_AND_PART.fullmatch(cell):
            shown.add("." if cell.rfind(".") > cell.rfind(",") else ",")
        elif (groups := _GROUPS.fullmatch(cell)) and cell.count(groups[1]) > 1:
            shown.add("," if groups[1] == "." else ".")
        elif not _GROUPS.fullmatch(cell) and (found := _PART.fullmatch(cell)):
            shown.add(found[1])
    return "both" if len(shown) > 1 else "".join(shown)


def tidy(cell: str) -> str:
    """Without blanks inside, and with the plain minus sign."""
    bare = re.sub(r"[\u00a0\u202f\u2009']", "", cell.strip()).replace("−", "-")
    return re.sub(r"(?<=\d) (?=\d{3}(?!\d))", "", bare)


def number(cell: str, sign: str, where: str) -> tuple[float, bool]:
    """A cell's number, NaN for a missing one, and whether a sign of thousands was left out.

    Parameters
    ----------
    sign
        Of the table's decimals, from `decimal_sign`.

    Raises
    ------
    InputError
        For what is no number, or may be two.
    """
    text = tidy(cell)
    if text.lower() in MISSING:
        return nan, False
    groups = _GROUPS.fullmatch(text)
    thousands = bool((groups and groups[1] != sign) or _GROUPS_AND_PART.fullmatch(text))
    if groups and groups[1] == "," and not sign:
        plain = text.replace(",", "")
        raise InputError(
            where,
            f"is {quote(cell)}, which may be {plain} or {text.replace(',', '.')}",
            f"write {plain} or {text.replace(',', '.')}",
        )
    thousands = thousands and bool(sign)
    if thousands:
        text = text.replace("," if sign == "." else ".", "")
    if sign == ",":
        text = text.replace(",", ".")
    if not _NUMBER.fullmatch(text) or not isfinite(float(text)):
        raise InputError(
            where, f"is {quote(cell)}, which is no number", "write a number, or leave it empty"
        )
    return float(text), thousands


def marks_of_missing(
    cells: list[str], values: Float[np.ndarray, " row"]
) -> Bool[np.ndarray, " row"]:
    """Which cells of a column are -999, 9999, 9.9E37 and the like, as loggers write what they lack.

    Such a number that the column's other values surround is a number.
    """
    marked = np.array([bool(_MARK.fullmatch(tidy(cell))) for cell in cells], dtype=bool)
    enormous = np.abs(values) >= BEYOND
    others = values[~marked & ~enormous & np.isfinite(values)]
    if not len(others):  # a sensor that was never there
        return enormous | (marked & (values < 0) & (np.sum(marked) > 1))
    beyond = np.abs(values) > MUCH_LARGER * np.max(np.abs(others))
    opposite = (values < 0) & bool(np.all(others >= 0))
    return enormous | (marked & (beyond | opposite))

"""Ranges as they are typed: `"-2 deg..2 deg"`, or single values, `"1 mm, 2 mm, 5 mm"`."""

import re

import numpy as np

from camring.analyses.grid import Axis
from camring.files.errors import InputError, quote
from camring.files.motor.entries import Number, Unfit
from camring.files.units import UnitError, from_si, split_quantity

MOST_PLACES = 1000  # on one axis
MOST_POINTS = 100_000  # in all
FEWEST_PLACES = 2


def axis(key: str, text: str, entry: Number, count: int) -> Axis:
    """The values that a range stands for, evenly spaced in the unit it is written in.

    Parameters
    ----------
    entry
        What the key takes: unit and limits.
    count
        Values of a range; a list has as many as it has.

    Raises
    ------
    InputError
        For a text that is no range, a unit that does not fit, a value out of its limits.
    """
    example = f'"{_bare(entry.example)}..{_bare(entry.example)}"'
    ends = re.split(r"\s*\.\.+\s*", text.strip())
    listed = [part for part in re.split(r"\s*,\s*", text.strip()) if part]
    if len(ends) == 2 and all(ends):
        unit, (low, high) = _in_one_unit(key, ends, entry)
        if low == high:
            raise InputError(key, f"has the empty range {quote(text)}", "let its ends differ")
        shown = np.linspace(low, high, count)
    elif len(ends) == 1 and len(listed) >= FEWEST_PLACES:
        unit, values = _in_one_unit(key, listed, entry)
        shown = np.array(values)
        if len(shown) > MOST_PLACES:
            raise InputError(key, f"lists {len(shown)} values", f"give at most {MOST_PLACES}")
        if not (np.all(np.diff(shown) > 0) or np.all(np.diff(shown) < 0)):
            raise InputError(
                key, f"lists {quote(text)}, which neither rises nor falls", "order the values"
            )
    else:
        raise InputError(
            key,
            f"is {quote(text)} but must be a range or a list",
            f"write {key}={example} with the two ends, or values separated by commas",
        )
    # Linspace leaves 0.30000000000000004; nobody means it.
    return Axis(key, unit, np.array([float(f"{value:.12g}") for value in shown]))


def point_counts(text: str | None, axes: int, default: int) -> tuple[int, ...]:
    """How many values each axis takes: from `41`, or `40x30` for two axes.

    Raises
    ------
    InputError
        For anything else, or more points than `MOST_POINTS`.
    """
    if text is None:
        return (default,) * axes
    parts = re.split(r"\s*[x×*,]\s*", text.strip().lower())
    example = "41" if axes == 1 else "40x30"
    if len(parts) not in (1, axes) or not all(re.fullmatch(r"\d{1,9}", part) for part in parts):
        needs = "a whole number" if axes == 1 else "one whole number, or one for each axis"
        raise InputError("--points", f"is {quote(text)} but must be {needs}", f"give {example}")
    counts = tuple(int(part) for part in parts) * (axes if len(parts) == 1 else 1)
    if not all(FEWEST_PLACES <= count <= MOST_PLACES for count in counts):
        raise InputError(
            "--points",
            f"is {quote(text)} but each axis takes {FEWEST_PLACES} to {MOST_PLACES} values",
            f"give, for example, {example}",
        )
    if np.prod(counts) > MOST_POINTS:
        raise InputError(
            "--points", f"asks for {np.prod(counts):,} simulations", f"stay below {MOST_POINTS:,}"
        )
    return counts


def _in_one_unit(key: str, texts: list[str], entry: Number) -> tuple[str, list[float]]:
    """The numbers in one unit, the last that is given; `-2..2 deg` means degrees both times."""
    try:
        parts = [split_quantity(text) for text in texts]
    except UnitError as error:
        shown = quote(", ".join(texts))
        raise InputError(key, f"is {shown}, which {error}", entry.way_out) from None
    unit = next((unit for _, unit in reversed(parts) if unit), "")
    if not unit and entry.unit not in ("", "1"):
        example = _bare(entry.example)
        raise InputError(
            key, f"is {quote(', '.join(texts))}, without a unit", f"write one behind it: {example}"
        )
    values = []
    for number, own in parts:
        text = f"{number!r} {own or unit}".rstrip()
        try:
            si = entry.convert(text)
        except Unfit as error:
            raise InputError(key, error.problem, error.way_out) from None
        values.append(number if own in ("", unit) else from_si(si, unit, entry.unit))
    return unit, values


def _bare(example: str) -> str:
    return example.strip('"')

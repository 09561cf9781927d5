"""Units that a user's own program answers in, named result by result: `max_pressure = "bar"`."""

from collections.abc import Mapping
from difflib import get_close_matches
from functools import cache
from typing import TypeAlias, get_args, get_type_hints

from camring.files.errors import InputError, quote
from camring.files.unit_spellings import of_one_turn
from camring.files.units import UnitError, difference_to_si, to_si

Named: TypeAlias = tuple[tuple[str, str], ...]
"""Pairs of a result and its unit."""

ABSOLUTE = ("min_pressure", "max_pressure")
"""Results above nothing; any other pressure or temperature among them is a difference."""


@cache
def si_units() -> dict[str, str]:
    """SI units of the results by name, as their annotations have them."""
    from camring.metrics.summary import Metrics

    hints = get_type_hints(Metrics, include_extras=True)
    return {name: str(get_args(hint)[1]) for name, hint in hints.items()}


def factor_of(name: str, unit: str) -> float:
    """What a result in a unit is to be multiplied by to be in SI.

    Raises
    ------
    UnitError
        When it is no unit, or one of something else.
    """
    return difference_to_si(f"1 {_of(name, unit)}", si_units()[name])


def offset_of(name: str, unit: str) -> float:
    """What is to be added then: the atmosphere, to a pressure that a gauge shows."""
    return to_si(f"0 {_of(name, unit)}", si_units()[name]) if name in ABSOLUTE else 0.0


def _of(name: str, unit: str) -> str:
    return of_one_turn(unit) if name == "displacement" else unit


def read_units(given: Mapping[str, str], where: str) -> Named:
    """Units by name of result, each looked at.

    Raises
    ------
    InputError
        For a name that is no result, with its nearest neighbour, and a unit of something else.
    """
    for name, unit in given.items():
        if name not in si_units():
            close = get_close_matches(name, si_units(), n=1)
            raise InputError(
                f"{where}.{name}",
                "is no result",
                f"you probably meant {close[0]}" if close else "see `camring simulate --json`",
            )
        try:
            if not isinstance(unit, str):
                raise UnitError("is no text")
            factor_of(name, unit)
        except UnitError as error:
            raise InputError(
                f"{where}.{name}",
                f"is {quote(unit)}, which {error}",
                f"give a unit of {si_units()[name]}" if si_units()[name] != "1" else 'give "%"',
            ) from None
    return tuple(given.items())


def in_si(results: Mapping[str, float], units: Named) -> dict[str, float]:
    """Results as a program gave them, those with a named unit brought to SI."""
    scales = {name: (factor_of(name, unit), offset_of(name, unit)) for name, unit in units}
    found = {}
    for name, value in results.items():
        factor, offset = scales.get(name, (1.0, 0.0))
        found[name] = value * factor + offset
    return found


__all__ = ["Named", "factor_of", "in_si", "offset_of", "read_units", "si_units"]

"""What every table of a motor file is, and entries for the numbers of the hardware.

Units and usual values are read off the nouns of `geometry` and `physics` (`part`, `usual`), as
`laws.py` reads those of laws: a table adds only what a noun does not say, meaning, example and
limits of sanity.
"""

import re
from dataclasses import fields
from functools import cache
from typing import Any, get_args, get_type_hints

import equinox as eqx
from pydantic import BaseModel, ConfigDict

from camring.files.motor.entries import Number
from camring.physics.system import System

FULL_TURN = 6.283185307179586
LARGEST_RADIUS = 10.0  # m, of a ring
LARGEST_PART = 2.0  # m; a bare 30 that should have been "30 mm" is reported


class Table(BaseModel):
    """A table of the file: unknown keys are errors, values are final."""

    model_config = ConfigDict(extra="forbid", frozen=True)


def part(leaf: str, meaning: str, example: str, low: float = 0.0, high: float = 1e9) -> Number:
    """The entry of one number of the hardware.

    Parameters
    ----------
    leaf
        Where it stands in the `System`, such as `motor.gap.clearance`; its unit is that of the
        annotation there.
    low, high
        Limits of sanity, SI.

    Raises
    ------
    TypeError
        When there is no such number.
    """
    unit = unit_of(*_place_of(leaf))
    return Number(meaning, example, unit=unit, low=low, high=high, leaves=(leaf,))


def usual(leaf: str) -> float:
    """The value of a number that a file may leave out: the default of the noun."""
    noun, name = _place_of(leaf)
    default: Any = {each.name: each.default for each in fields(noun)}[name]
    return float(default)


def unit_of(noun: type, name: str) -> str:
    """Unit of a number of a noun in the spelling of files: of `m3/(s.Pa)`, `m^3/(s*Pa)`."""
    annotation = _annotation(noun, name)
    if not hasattr(annotation, "__metadata__"):
        raise TypeError(f"{noun.__name__}.{name} has no unit in its annotation")
    return re.sub(r"([a-zA-Z])(\d)", r"\1^\2", get_args(annotation)[1]).replace(".", "*")


def _place_of(leaf: str) -> tuple[type, str]:
    """The noun that holds a leaf of the `System`, and its name there."""
    *way, name = leaf.split(".")
    noun: type = System
    for each in way:
        annotation = _annotation(noun, each)
        candidates = (annotation, *get_args(annotation))
        noun = next(x for x in candidates if isinstance(x, type) and issubclass(x, eqx.Module))
    return noun, name


def _annotation(noun: type, name: str) -> Any:
    hints = _hints(noun)
    if name not in hints:
        raise TypeError(f"{noun.__name__} has no {name}")
    return hints[name]


@cache
def _hints(noun: type) -> dict[str, Any]:
    return get_type_hints(noun, include_extras=True)


def length(leaf: str, meaning: str, example: str, low: float = 1e-6) -> Number:
    return part(leaf, meaning, example, low, LARGEST_PART)


def pressure_entry(meaning: str, example: str, low: float = 0.0) -> Number:
    return Number(meaning, example, unit="Pa", low=low, high=1e9)


def modulus(leaf: str) -> Number:
    return part(leaf, "Young's modulus", '"206 GPa"', 1e6, 1e14)


def poisson(leaf: str) -> Number:
    return part(leaf, "Poisson's ratio", "0.3", high=0.5)

"""Other metres, kilograms and seconds, applied to any noun by the units in its annotations."""

import dataclasses
import re
import typing
from dataclasses import dataclass

import equinox as eqx
import numpy as np

# Powers of metre, kilogram, second.
BASE = {
    "m": (1, 0, 0), "kg": (0, 1, 0), "s": (0, 0, 1), "rad": (0, 0, 0), "1": (0, 0, 0),
    "N": (1, 1, -2), "Pa": (-1, 1, -2), "W": (2, 1, -3), "J": (2, 1, -2), "Hz": (0, 0, -1),
}  # fmt: skip
FACTOR = re.compile(r"([a-zA-Z]+|1)(-?\d+)?$")


def dimension(unit: str) -> np.ndarray:
    """Powers of metre, kilogram and second of "m3/(s.Pa)"."""
    unit = unit.replace(" ", "")
    upper, _, lower = unit.partition("/")
    total = np.zeros(3)
    for sign, part in ((1, upper), (-1, lower.strip("()"))):
        for factor in filter(None, part.split(".")):
            match = FACTOR.match(factor)
            assert match, f"unreadable unit {unit!r}"
            total += sign * int(match[2] or 1) * np.array(BASE[match[1]])
    return total


def unit_of(annotation) -> str | None:
    """The unit written in an annotation, if there is one."""
    for extra in getattr(annotation, "__metadata__", ()):
        if isinstance(extra, str):
            return extra
    return None


@dataclass(frozen=True)
class UnitSystem:
    """How many of ours make one of theirs: a number in m becomes `number * metre` of theirs."""

    metre: float
    kilogram: float
    second: float

    def factor(self, unit: str) -> float:
        return float(np.prod(np.array([self.metre, self.kilogram, self.second]) ** dimension(unit)))

    def convert(self, noun):
        """A copy of a noun in the other units; every number must say its unit."""
        hints = typing.get_type_hints(type(noun), include_extras=True)
        changes = {}
        for field in dataclasses.fields(noun):
            value = getattr(noun, field.name)
            unit = unit_of(hints[field.name])
            if isinstance(value, eqx.Module):
                changes[field.name] = self.convert(value)
            elif unit is not None and value is not None:  # None: a part that it does without
                changes[field.name] = value * self.factor(unit)
            elif not field.metadata.get("static", False) and value is not None:
                raise AssertionError(f"{type(noun).__name__}.{field.name} says no unit")
        return dataclasses.replace(noun, **changes)

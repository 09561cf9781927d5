"""The design space in the words and units of the motor file."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from camring.files.motor import MotorFile
from camring.files.motor.entries import Number
from camring.files.motor.keys import key_map
from camring.files.units import UnitError, from_si, split_quantity, unit_of
from camring.presentation.records import Variable

__all__ = ["Coordinate", "coordinates_of", "variables_of"]


@dataclass(frozen=True)
class Coordinate:
    """One coordinate of the unit box: `low` and `high` are what 0 and 1 stand for, in `unit`."""

    name: str
    unit: str
    low: float
    high: float

    def at(self, unit_value: float) -> float:
        return self.low + unit_value * (self.high - self.low)


def coordinates_of(motor_file: MotorFile) -> tuple[Coordinate, ...]:
    """Every coordinate of the file's design space, in the unit the file writes it in."""
    space, system = motor_file.design_space, motor_file.system
    if space is None:
        return ()
    count = space.dimension
    ends = [space.describe(system, np.full(count, end)) for end in (0.0, 1.0)]
    keyed = {variable.name for variable in space.variables}
    found = []
    for name in space.names:
        low, high = (values[name] for values in ends)
        # A cam mode's amplitude is a length; the others are written as the file writes them.
        unit = _unit(motor_file, name) if name in keyed else "mm"
        si_unit = _si_unit(motor_file, name) if name in keyed else "m"
        ends_shown = (from_si(end, unit, si_unit) for end in (low, high))
        found.append(Coordinate(name, unit, *ends_shown))
    return tuple(found)


def variables_of(
    motor_file: MotorFile, points: Sequence[Sequence[float] | np.ndarray]
) -> tuple[Variable, ...]:
    """What may change, with bounds and the value of each design.

    Parameters
    ----------
    points
        Unit points of the designs.
    """
    return tuple(
        Variable(c.name, _pretty(c.unit), c.low, c.high, tuple(c.at(float(p[k])) for p in points))
        for k, c in enumerate(coordinates_of(motor_file))
    )


def _unit(motor_file: MotorFile, path: str) -> str:
    """The unit the file writes a number in: with its value, its bounds, or as by custom."""
    document = motor_file.document
    bounds = _bounds(document, path)
    entry = key_map(motor_file.choices).get(path)
    example = entry.example.strip('"') if entry is not None else None
    for text in (_at(document, path), bounds, example):
        unit = _unit_of(text)
        if unit:
            return unit
    return ""


def _si_unit(motor_file: MotorFile, path: str) -> str | None:
    entry = key_map(motor_file.choices).get(path)
    return entry.unit if isinstance(entry, Number) else None


def _at(document: Any, path: str) -> Any:
    for part in path.split("."):
        document = document.get(part) if isinstance(document, dict) else None
    return document


def _bounds(document: dict[str, Any], path: str) -> Any:
    """The lower bound of a variable, written in quotes or as nested tables."""
    space = document.get("design_space", {})
    found = space.get(path, _at(space, path))
    if isinstance(found, dict):
        found = found.get("bounds")
    return found[0] if isinstance(found, list) and found else None


def _unit_of(text: Any) -> str:
    if not isinstance(text, str):
        return ""
    try:
        unit = split_quantity(text)[1]
        unit_of(unit)
    except UnitError:
        return ""
    return unit


def _pretty(unit: str) -> str:
    return unit.replace("^2", "²").replace("^3", "³").replace("*", "·")

"""The design space in the words and units of the motor file."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from camring.interfaces.config import MotorFile
from camring.interfaces.report.data import Variable
from camring.interfaces.units import UnitError, from_si, parse_unit, split_quantity

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
        unit = _unit(motor_file.document, name) if name in keyed else "mm"
        found.append(Coordinate(name, unit, from_si(low, unit), from_si(high, unit)))
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


def _unit(document: dict[str, Any], path: str) -> str:
    """The unit the file writes a number in; none for a bare number."""
    here: Any = document
    for part in path.split("."):
        here = here.get(part) if isinstance(here, dict) else None
    if not isinstance(here, str):
        return ""
    try:
        unit = split_quantity(here)[1]
        parse_unit(unit)
    except UnitError:
        return ""
    return unit


def _pretty(unit: str) -> str:
    return unit.replace("^2", "²").replace("^3", "³").replace("*", "·")

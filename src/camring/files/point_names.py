"""What an operating point is called wherever results stand side by side."""

from math import pi
from typing import Protocol, SupportsFloat

__all__ = ["name_of"]


class _Point(Protocol):
    """An operating point, or its record: SI."""

    @property
    def shaft_speed(self) -> SupportsFloat: ...
    @property
    def supply_pressure(self) -> SupportsFloat: ...
    @property
    def return_pressure(self) -> SupportsFloat: ...
    @property
    def reverse(self) -> bool: ...
    @property
    def mode(self) -> str: ...


def name_of(point: _Point) -> str:
    """Short name in shop-floor units: `450 rpm, 250 bar, fast`, `60 rpm, 10 against 200 bar`."""
    speed = float(point.shaft_speed) * 30 / pi
    supply, back = (float(each) / 1e5 for each in (point.supply_pressure, point.return_pressure))
    braked = f" against {back:.4g}" if supply < back else ""
    how = f", {point.mode}" * bool(point.mode) + ", reverse" * point.reverse
    return f"{speed:.4g} rpm, {supply:.4g}{braked} bar{how}"

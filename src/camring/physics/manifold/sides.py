"""The two places where a manifold may stand: before the supply windows, behind the return's.

Both are one thing to the equations: a volume between a port's set pressure and the windows,
with flows into the chambers counted positive. Where the return's oil goes the other way, its
numbers are negative.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import equinox as eqx
from jaxtyping import Array, Float

from camring.numerics.quantity import Q
from camring.physics.operating_point import OperatingPoint

__all__ = ["RETURN", "SIDES", "SUPPLY", "Side", "at_windows", "sides_of"]


class Side(NamedTuple):
    """What belongs to one kind of port is called so in several records."""

    manifold: str
    """In `Motor` and `Cycle`."""
    pressure: str
    """In `OperatingPoint`, that of the port; in `PistonState`, that of the manifold."""
    flow: str
    """In `PortFlows`, into the chamber."""

    def of(self, motor: Any) -> Any:
        """The manifold of this side; of a cycle, the orbit of its oil."""
        return getattr(motor, self.manifold)

    def set_pressure(self, point: OperatingPoint) -> Q[Float[Array, ""], "Pa"]:
        """Of the port, at the far end of the line."""
        return getattr(point, self.pressure)


SUPPLY = Side("manifold", "supply_pressure", "supply")
RETURN = Side("return_manifold", "return_pressure", "return_")
SIDES = (SUPPLY, RETURN)


def sides_of(motor: Any) -> tuple[Side, ...]:
    """Those with a manifold, in the order in which their states are solved."""
    return tuple(side for side in SIDES if side.of(motor) is not None)


def at_windows(
    motor: Any, point: OperatingPoint, pressures: Sequence[Q[Float[Array, "*grid"], "Pa"]]
) -> OperatingPoint:
    """The operating point as windows see it: manifolds' pressures, which differ by angle.

    Parameters
    ----------
    pressures
        One for each of `sides_of(motor)`.
    """
    names = [side.pressure for side in sides_of(motor)]
    if not names:
        return point
    return eqx.tree_at(lambda each: [getattr(each, name) for name in names], point, list(pressures))

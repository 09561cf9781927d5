"""Laws of a user's own in the second solver: plain numbers in, plain numbers out.

`LEAKAGES[SealRingLeakage] = written_anew` is all it takes: `written_anew(law, motor,
fluid)` reads the numbers of the three objects with `float` and returns what says the flow
of two pressures. `FRICTIONS` likewise. A law of this package stands there by its class's
name, for nothing here imports physics. A law that is in neither has no second solver.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

Leakage = Callable[[float, float], float]
"""(chamber pressure, case pressure), Pa -> volume flow out of the chamber, m3/s."""


@dataclass(frozen=True)
class Rubbing:
    """One piston's loaded contacts at some angles, SI."""

    radius: np.ndarray
    slope: np.ndarray  # of the radius by the angle
    force: np.ndarray
    normal_force: np.ndarray
    ring_length: np.ndarray  # that passes the roller for each radian
    shaft_speed: float

    @property
    def side_force(self) -> np.ndarray:
        return np.abs(self.force * self.slope / self.radius)

    @property
    def roller_speed(self) -> np.ndarray:
        """Of the roller's surface in its seat, m/s."""
        return self.shaft_speed * self.ring_length

    @property
    def piston_speed(self) -> np.ndarray:
        """Along its bore, m/s, without sign."""
        return np.abs(self.shaft_speed * self.slope)


@dataclass(frozen=True)
class Friction:
    """A friction law: the film's damping, N s/m, and torque lost in the contacts, N m."""

    damping: float
    loss_torque: Callable[[Rubbing], np.ndarray]


LEAKAGES: dict[type | str, Callable[[Any, Any, Any], Leakage]] = {}
FRICTIONS: dict[type | str, Callable[[Any, Any, Any], Friction]] = {}

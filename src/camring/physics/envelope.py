"""The range in which a motor must run: speeds, pressures, oil temperatures, directions.

An envelope is stated once and asked at as many points as its reader can afford: a
coarse grid while a search is under way, a finer one when its result is validated. Every
grid holds the corners, where limits are nearly always tightest.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from camring.numerics.quantity import real
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint

Range = tuple[float, float]


@dataclass(frozen=True, eq=False)
class Envelope:
    """Where a motor must keep every limit; SI, absolute pressures.

    Attributes
    ----------
    speed, supply_pressure, return_pressure
        Ends of the ranges, lowest first; equal ends are a single value.
    case_pressure
        None stands for the return pressure of the point.
    both_directions
        Whether it must run backwards too, the ports exchanged.
    fluids
        The oil at each end of its range of temperatures; empty where the temperature is
        that of the operating points.
    temperatures
        The same ends, K.
    ripple_ratio
        Limit of the torque ripple at each point over the given motor's there; None is none.
    efficiency_loss
        Limit of what the efficiency may fall below the given motor's at each point; None
        is none.
    """

    speed: Range
    supply_pressure: Range
    return_pressure: Range
    case_pressure: float | None = None
    both_directions: bool = False
    fluids: Sequence[AbstractFluid] = ()
    temperatures: Sequence[float] = ()
    ripple_ratio: float | None = None
    efficiency_loss: float | None = None

    def grid(self, speeds: int, pressures: int) -> "EnvelopeGrid":
        """Points over speed and supply pressure, at each end of all other ranges.

        Parameters
        ----------
        speeds, pressures
            Values on each axis, at least 2; speeds follow a geometric series, for what a
            speed does to a chamber goes with its ratio, pressures an arithmetic one.
        """
        axes = (
            np.array([False, True] if self.both_directions else [False]),
            np.arange(max(len(self.fluids), 1)),
            _ends(self.return_pressure),
            _between(self.speed, speeds, geometric=True),
            _between(self.supply_pressure, pressures, geometric=False),
        )
        backwards, fluid, back, speed, supply = (
            each.ravel() for each in np.meshgrid(*axes, indexing="ij")
        )
        case = back if self.case_pressure is None else np.full(len(speed), self.case_pressure)
        return EnvelopeGrid(speed, supply, back, case, backwards, fluid)


@dataclass(frozen=True, eq=False)
class EnvelopeGrid:
    """Points of an envelope; forwards first, then backwards.

    Attributes
    ----------
    fluid
        At each point the place of its oil in `Envelope.fluids`; 0 where there are none.
    """

    shaft_speed: Float[np.ndarray, " point"]
    supply_pressure: Float[np.ndarray, " point"]
    return_pressure: Float[np.ndarray, " point"]
    case_pressure: Float[np.ndarray, " point"]
    backwards: Bool[np.ndarray, " point"]
    fluid: np.ndarray

    @property
    def count(self) -> int:
        return len(self.shaft_speed)

    @property
    def pressure_drop(self) -> Float[np.ndarray, " point"]:
        return self.supply_pressure - self.return_pressure

    def operating_point(self, place: int) -> OperatingPoint:
        """One of the points by itself."""
        return OperatingPoint(
            shaft_speed=real(self.shaft_speed[place]),
            supply_pressure=real(self.supply_pressure[place]),
            return_pressure=real(self.return_pressure[place]),
            case_pressure=real(self.case_pressure[place]),
            reverse=bool(self.backwards[place]),
        )

    def text(self, place: int) -> str:
        """One of the points in words: speed, supply pressure, and what else it is known by."""
        words = [
            f"{self.shaft_speed[place] * 30 / np.pi:.4g} rpm",
            f"{self.supply_pressure[place] / 1e5:.4g} bar",
        ]
        if len(set(self.return_pressure)) > 1:
            words.append(f"return {self.return_pressure[place] / 1e5:.4g} bar")
        if self.fluid.any():
            words.append("hot" if self.fluid[place] else "cold")
        if self.backwards[place]:
            words.append("backwards")
        return ", ".join(words)

    def corners(self) -> list[int]:
        """Places of the points at an end of speed and of supply pressure."""
        ends = [
            (values == values.min()) | (values == values.max())
            for values in (self.shaft_speed, self.supply_pressure)
        ]
        return [int(place) for place in np.flatnonzero(ends[0] & ends[1])]


def _ends(limits: Range) -> Float[np.ndarray, " end"]:
    return np.unique(np.array(limits))


def _between(limits: Range, count: int, *, geometric: bool) -> Float[np.ndarray, " place"]:
    low, high = limits
    if low == high:
        return np.array([low])
    return np.geomspace(low, high, count) if geometric else np.linspace(low, high, count)

"""The heat balance by the second solver: the rise sought by secants over whole solutions."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import log10
from typing import Any

import numpy as np

from camring.reference.failure import OrbitError

STEPS = 30
CLOSED = 1e-9  # K
OPEN = "heat_left_over"
"""Among the results of a solution: degrees by which its rise is above a balance."""


@dataclass(frozen=True)
class Cooling:
    """What carries heat off, K, W/K and J/(kg K), and how warm case and films are."""

    inlet: float
    ambient: float
    heat_transfer: float
    specific_heat: float
    height: float  # of Walther's line, log log (nu + 0.7) over log T, mm2/s
    fall: float
    rise: float = 0.0

    def thinner(self) -> float:
        """Viscosity of the oil in the films over that of the oil that comes in."""

        def viscosity(temperature: float) -> float:
            return 10 ** (10 ** (self.height - self.fall * log10(temperature))) - 0.7

        return viscosity(self.inlet + self.rise) / viscosity(self.inlet)

    @property
    def surface_heat(self) -> float:
        """W, from the surface to what is around it."""
        return self.heat_transfer * (self.inlet + self.rise - self.ambient)


def cooling_of(motor: Any, fluid: Any) -> Cooling | None:
    """Read off a motor and its oil; None where nothing warms."""
    thermal = getattr(motor, "thermal", None)
    if thermal is None:
        return None
    line = fluid.line
    numbers = (
        line.temperature,
        thermal.ambient_temperature,
        thermal.heat_transfer,
        thermal.specific_heat,
        line.height,
        line.fall,
    )
    return Cooling(*(float(np.asarray(each)) for each in numbers))


def films_of(fluid: Any, cooling: Cooling | None) -> Any:
    """The oil as it is in films and leakage paths."""
    if cooling is None:
        return fluid
    return replace(fluid, viscosity=np.asarray(fluid.viscosity) * cooling.thinner())


def found_rise(left_over: Callable[[float], float], cooling: Cooling) -> float:
    """The rise at which heat that stays and heat that is carried off are the same.

    Parameters
    ----------
    left_over
        Heat carried off less heat that stays, over what one more degree carries off, K.
    """
    before, here = 0.0, 0.1
    at_before, at_here = left_over(before), left_over(here)
    for _ in range(STEPS):
        if abs(at_here) < CLOSED * (1 + abs(here)) or at_here == at_before:
            return here
        after = here - at_here * (here - before) / (at_here - at_before)
        # Oil is never colder than what comes in or is around, however far a secant leaps.
        after = max(after, min(0.0, cooling.ambient - cooling.inlet))
        before, at_before, here, at_here = here, at_here, after, left_over(after)
    raise OrbitError(f"the heat balance was not found in {STEPS} steps")


def warmth(cooling: Cooling | None, heat: float, drain_mass: float) -> dict[str, float]:
    """Results of the heat balance, and by how many degrees it is open."""
    if cooling is None:
        return {"surface_heat": 0.0, "case_temperature_rise": 0.0, OPEN: 0.0}
    drain_capacity = cooling.specific_heat * max(drain_mass, 0.0)
    carried = drain_capacity * cooling.rise + cooling.surface_heat
    return {
        "surface_heat": cooling.surface_heat,
        "case_temperature_rise": cooling.rise,
        OPEN: (carried - heat) / (drain_capacity + cooling.heat_transfer),
    }

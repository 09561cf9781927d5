"""Optuna's parameters as a unit box, which is all that a search knows."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from jaxtyping import Float
from optuna.distributions import (
    BaseDistribution,
    CategoricalDistribution,
    FloatDistribution,
    IntDistribution,
)

from camring.files.errors import InputError, quote

Point = Float[np.ndarray, " dimension"]


def require_numeric(name: str, distribution: BaseDistribution) -> None:
    """Raises `InputError` when a parameter is one of a list of choices."""
    if isinstance(distribution, CategoricalDistribution):
        choices = ", ".join(map(quote, distribution.choices))
        raise InputError(
            f"parameter {quote(name)}",
            f"is one of {choices}, and CamringSampler knows numbers only",
            "suggest an int that counts the choices if they have an order, or run a study for "
            "each choice",
        )


class Axis:
    """One parameter: its values and the coordinate in [0, 1] that stands for each."""

    def __init__(self, name: str, distribution: BaseDistribution) -> None:
        require_numeric(name, distribution)
        assert isinstance(distribution, FloatDistribution | IntDistribution)
        self._whole = isinstance(distribution, IntDistribution)
        self._log = distribution.log
        self._low, self._high = float(distribution.low), float(distribution.high)
        # A logarithmic whole number has the step 1, and Optuna allows no other.
        self.step = None if distribution.step is None else float(distribution.step)

    def value(self, unit: float) -> float | int:
        """The value at a coordinate, the nearest one where there are steps."""
        if self._log:
            low, high = math.log(self._low), math.log(self._high)
            reached = math.exp(low + (high - low) * unit)
        else:
            reached = self._low + (self._high - self._low) * unit
        if self.step is not None:
            reached = self._low + self.step * round((reached - self._low) / self.step)
        reached = min(max(reached, self._low), self._high)
        return round(reached) if self._whole else reached

    def unit(self, value: float) -> float:
        """The coordinate of a value; one outside is drawn to the edge."""
        low, high, here = self._low, self._high, float(value)
        if self._log:
            low, high, here = math.log(low), math.log(high), math.log(max(here, low))
        return min(max((here - low) / (high - low), 0.0), 1.0) if high > low else 0.5


class Box:
    """Several parameters in the order of their names."""

    def __init__(self, space: Mapping[str, BaseDistribution]) -> None:
        self.names = tuple(sorted(space))
        self._axes = {name: Axis(name, space[name]) for name in self.names}

    @property
    def dimension(self) -> int:
        return len(self.names)

    @property
    def stepped(self) -> bool:
        """Whether any parameter has steps, so that two points may be the same design."""
        return any(axis.step is not None for axis in self._axes.values())

    def values(self, point: Sequence[float] | Point) -> dict[str, Any]:
        """The parameters at a point."""
        units = map(float, point)
        return {name: self._axes[name].value(u) for name, u in zip(self.names, units, strict=True)}

    def point(self, values: Mapping[str, Any]) -> Point:
        """The point of parameters."""
        return np.array([self._axes[name].unit(values[name]) for name in self.names])

    def settled(self, point: Point) -> Point:
        """The point itself, with stepped parameters where their values are."""
        found = np.array(point, dtype=float)
        values = self.values(point)
        for place, name in enumerate(self.names):
            if self._axes[name].step is not None:
                found[place] = self._axes[name].unit(values[name])
        return found

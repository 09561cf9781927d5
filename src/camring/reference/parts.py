"""Oil, windows and manifolds of a machine, as plain numbers."""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np


@dataclass(frozen=True)
class Oil:
    """Numbers of both fluid laws; SI, absolute pressures."""

    density: float
    bulk_modulus: float
    vapour_pressure: float = 0.0
    transition_pressure: float = 1e5
    law: Literal["constant", "aerated"] = "constant"
    viscosity: float = 0.0
    air_fraction: float = 0.005
    air_density: float = 1.2
    polytropic_index: float = 1.0
    dissolution_pressure: float = 3e6
    atmospheric_pressure: float = 101325.0
    modulus_gain: float = 0.0


@dataclass(frozen=True)
class Window:
    """One kind of port: where it opens and how far. Angles in rad.

    `table` is a tabulated opening: distances from the centre and open shares,
    joined by straight lines. `area` and `discharge_coefficient` are those of this kind
    alone; None where they are the machine's.
    """

    width: float
    centre: float
    shape: Literal["linear", "round", "table"] = "linear"
    ramp: float = 1.0
    notch_angle: float = 0.0
    notch_area: float = 0.0
    table: tuple[tuple[float, ...], tuple[float, ...]] = ((), ())
    area: float | None = None
    discharge_coefficient: float | None = None


@dataclass(frozen=True)
class Manifold:
    """A manifold between a port and its windows, and the line that joins it to the port."""

    volume: float
    line_conductance: float  # volume flow for each pascal


@dataclass(frozen=True)
class Manifolds:
    """Before the supply windows and behind the return windows; None where there is none."""

    supply: Manifold | None = None
    return_: Manifold | None = None

    def __bool__(self) -> bool:
        return self.supply is not None or self.return_ is not None


def manifolds_of(motor: Any) -> Manifolds:
    """Those of a `camring.physics` motor, as plain numbers."""

    def read(name: str) -> Manifold | None:
        given = getattr(motor, name, None)
        if given is None:
            return None
        return Manifold(*(float(np.asarray(x)) for x in (given.volume, given.line_conductance)))

    return Manifolds(read("manifold"), read("return_manifold"))

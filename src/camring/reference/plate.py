"""Flow through the film on the valve plate, by the second solver: slits cut into thin rings."""

from dataclasses import dataclass
from math import pi
from typing import Any

import numpy as np

from camring.reference.failure import OrbitError

RINGS = np.polynomial.legendre.leggauss(24)


@dataclass(frozen=True)
class Plate:
    """Film thickness, radii of the lands, the angle between neighbouring slots, the share of
    lobes whose supply slots are fed."""

    thickness: float
    radii: tuple[float, float, float, float]
    land: float
    lands: int
    fed: float = 1.0

    def flows(
        self, viscosity: float, supply: float, back: float, case: float
    ) -> tuple[float, float, float]:
        """Volumes a second: supply to case, return to case, supply to return."""
        a, b, c, d = self.radii
        half_ring = pi * (1 / _resistance(a, b) + 1 / _resistance(c, d))
        across = self.lands * (c - b) / ((b + c) / 2 * self.land)
        slit = self.thickness**3 / (12 * viscosity)
        return (
            slit * half_ring * self.fed * (supply - case),
            slit * half_ring * (2 - self.fed) * (back - case),
            slit * across * (supply - back),
        )


def _resistance(inner: float, outer: float) -> float:
    """Of rings in series, each as long as it is thick and as wide as its radius: the log."""
    at = (inner + outer) / 2 + (outer - inner) / 2 * RINGS[0]
    return float(np.sum(RINGS[1] / at)) * (outer - inner) / 2


def plate_of(motor: Any, point: Any) -> Plate | None:
    """Read off a motor; None where its plate does not leak."""
    gap = getattr(motor, "plate_gap", None)
    if gap is None:
        return None
    plate = motor.valve_plate
    common = getattr(plate.window, "ramp", None)
    if common is None:
        raise OrbitError("a plate that leaks needs windows that say how far slots are apart")
    shut = pi / motor.lobes
    for port in (plate.supply, plate.return_):
        own = getattr(port, "ramp", None)
        shut -= float(port.width) * (1 - float(common if own is None else own) / 2) / 2
    a, b, c, d = (float(each) for each in np.asarray(gap.land_radii))
    fed = motor.lobes - len(getattr(point, "idle_lobes", ()))
    return Plate(float(gap.thickness), (a, b, c, d), shut, 2 * fed, fed / motor.lobes)

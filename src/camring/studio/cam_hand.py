"""What a hand does to the cam: one control value, its neighbours with it, or a smooth mode.

Mirror and equal displacement mean what they mean in `[design_space.cam]`.
"""

from dataclasses import dataclass
from math import pi
from typing import Any

import numpy as np

from camring.files.motor import MotorFile
from camring.geometry.cam import PlanarCam, RadialCam
from camring.numerics.spline import basis_matrix

_PER_SPAN = 16  # samples in which rises are added up, as in `objective.cam_modes`
MOST_WAVES = 12


@dataclass(frozen=True)
class Grip:
    """What the hand holds and where it is.

    Attributes
    ----------
    kind
        `handle`, `cos`, `sin`, or `waves` for several modes at once.
    number
        Of the control value, or of the harmonic of the lobe.
    to
        The control value, or the mode's amplitude, m.
    reach
        How many neighbours on each side follow a handle.
    mirror, keep
        Whether the cam stays symmetric, and its displacement as it was.
    """

    kind: str
    number: int
    to: float
    reach: int = 0
    mirror: bool = False
    keep: bool = False
    waves: tuple[tuple[str, int, float], ...] = ()
    """Kind, harmonic and amplitude of each, m."""

    @classmethod
    def of(cls, message: Any) -> "Grip":
        return cls(
            str(message["kind"]),
            int(message.get("number", 0)),
            float(message.get("to", 0.0)),
            int(message.get("reach", 0)),
            bool(message.get("mirror", False)),
            bool(message.get("keep", False)),
            tuple((str(kind), int(k), float(to)) for kind, k, to in message.get("waves", ())),
        )


@dataclass(frozen=True, eq=False)
class CamHand:
    """The control values of a file's cam, m, and how they are moved."""

    given: np.ndarray
    degree: int
    lobes: int
    """In one period of the cam."""
    points: np.ndarray | None = None
    """Of a planar cam, whose points move along their own rays."""

    @classmethod
    def of(cls, file: MotorFile) -> "CamHand":
        cam = file.system.motor.cam
        lobes = file.system.motor.lobes // cam.repeats
        if isinstance(cam, PlanarCam):
            points = np.asarray(cam.control_points)
            return cls(np.hypot(points[:, 0], points[:, 1]), cam.degree, lobes, points)
        assert isinstance(cam, RadialCam)
        return cls(np.asarray(cam.control_radii), cam.degree, lobes)

    def moved(self, grip: Grip) -> np.ndarray:
        """All control values with one of them, or one mode, where the hand has it."""
        count = len(self.given)
        values = self.given.copy()
        if grip.kind == "handle":
            at = grip.number % count
            values += (grip.to - self.given[at]) * self._brush(at, grip)
        for kind, harmonic, to in self._waves_of(grip):
            values += (to - self.amplitude(kind, harmonic)) * self.wave(kind, harmonic)
        if grip.keep:
            mean = values.mean()
            rises = self._rises(values)
            if rises > 0:
                values = mean + self._rises(self.given) / rises * (values - mean)
        return values

    def _waves_of(self, grip: Grip) -> tuple[tuple[str, int, float], ...]:
        if grip.kind in ("cos", "sin"):
            return ((grip.kind, grip.number, grip.to),)
        return tuple(each for each in grip.waves if each[0] in ("cos", "sin"))

    def leaf(self, values: np.ndarray) -> np.ndarray:
        """The values as the motor's cam holds them."""
        if self.points is None:
            return values
        return self.points * (values / self.given)[:, None]

    def amplitude(self, kind: str, harmonic: int) -> float:
        """Of a harmonic of the lobe in the control values, m."""
        wave = self.wave(kind, harmonic)
        return float(self.given @ wave / (wave @ wave))

    def modes(self) -> list[tuple[str, int, float]]:
        """Those that the control values of a lobe carry, with their amplitudes."""
        count = len(self.given)
        highest = min(MOST_WAVES, count // (2 * self.lobes))
        kinds = [(kind, k) for k in range(1, highest + 1) for kind in ("cos", "sin")]
        return [
            (kind, k, self.amplitude(kind, k))
            for kind, k in kinds
            if not (kind == "sin" and 2 * k * self.lobes == count)
        ]

    def _brush(self, at: int, grip: Grip) -> np.ndarray:
        count = len(self.given)
        shape = self._bump(at, grip.reach)
        if grip.mirror:
            shape = np.maximum(shape, self._bump(-at % count, grip.reach))
        return shape

    def _bump(self, at: int, reach: int) -> np.ndarray:
        """One at the handle, falling smoothly to nothing beyond its reach."""
        count = len(self.given)
        away = np.abs((np.arange(count) - at + count // 2) % count - count // 2)
        return np.where(away <= reach, np.cos(pi / 2 * away / (reach + 1)) ** 2, 0.0)

    def wave(self, kind: str, harmonic: int) -> np.ndarray:
        """A harmonic of the lobe at the control values, within [-1, 1]."""
        phase = 2 * pi * self.lobes * np.arange(len(self.given)) / len(self.given)
        return getattr(np, kind)(harmonic * phase)

    def _rises(self, values: np.ndarray) -> float:
        """What the spline of these values climbs in one period."""
        within = (np.arange(_PER_SPAN) / _PER_SPAN)[:, None] ** np.arange(self.degree + 1)
        neighbours = np.stack([np.roll(values, k) for k in range(self.degree + 1)])
        radius = (neighbours.T @ basis_matrix(self.degree) @ within.T).ravel()
        return float(np.sum(np.abs(np.roll(radius, -1) - radius)) / 2)

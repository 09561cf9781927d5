"""Torque and flows over speed, pressure and angle, as the C code looks them up.

Straight lines between operating points, a periodic cubic spline along the angle: what
`sources/camring_table.c` does, in NumPy, so that its error can be measured before
anything is written.
"""

import struct
from dataclasses import dataclass
from math import pi

import numpy as np
from jaxtyping import Float

__all__ = ["AXES", "QUANTITIES", "Table", "held_at_edges", "spline_coefficients"]

AXES = ("speed", "drop", "low")
QUANTITIES = ("torque", "supply_flow", "return_flow", "case_flow")
_MAGIC = b"CAMRING1"


@dataclass(frozen=True, eq=False)
class Table:
    """The motor's quasi-steady cycle at a grid of operating points.

    Attributes
    ----------
    speed
        Of the shaft, rad/s, signed, ascending.
    drop
        Supply less return pressure, Pa, signed, ascending.
    low
        The lower of both port pressures above the case's, Pa, ascending.
    means
        Over a revolution: N m and m3/s.
    waves
        The same at equal steps of one period of the ripple, from angle 0.
    periods
        Of the ripple in a revolution.
    """

    speed: Float[np.ndarray, " speed"]
    drop: Float[np.ndarray, " drop"]
    low: Float[np.ndarray, " low"]
    means: Float[np.ndarray, "speed drop low 4"]
    waves: Float[np.ndarray, "speed drop low 4 angle"]
    periods: int

    @property
    def axes(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return self.speed, self.drop, self.low

    @property
    def points(self) -> int:
        return int(np.prod(self.means.shape[:3]))

    def means_at(self, places: Float[np.ndarray, "place 3"]) -> Float[np.ndarray, "place 4"]:
        """Means between the table's points; held at its edge beyond."""
        return held_at_edges(self.axes, self.means, places)

    def waves_at(self, places: Float[np.ndarray, "place 3"]) -> Float[np.ndarray, "place 4 angle"]:
        """Waves between the table's points, at the table's own angles."""
        return held_at_edges(self.axes, self.waves, places)

    def waves_between(
        self, places: Float[np.ndarray, "place 3"]
    ) -> Float[np.ndarray, "place 4 angle"]:
        """The same half a step of the angle further on, by the spline along the angle."""
        coefficients = spline_coefficients(self.waves_at(places))
        shifted = [np.roll(coefficients, steps, axis=-1) for steps in (1, 0, -1, -2)]
        return (shifted[0] + 23 * shifted[1] + 23 * shifted[2] + shifted[3]) / 48

    def content(self) -> bytes:
        """The file that the C code reads: `sources/camring_table.c` says how."""
        counts = (*self.waves.shape[:3], self.waves.shape[4], len(QUANTITIES), self.periods)
        coefficients = spline_coefficients(self.waves)
        return b"".join(
            [
                _MAGIC,
                struct.pack("<6i", *counts),
                *(axis.astype("<f8").tobytes() for axis in self.axes),
                self.means.astype("<f8").tobytes(),
                coefficients.astype("<f4").tobytes(),
            ]
        )

    def angles(self) -> Float[np.ndarray, " angle"]:
        """Where the waves are sampled, rad of the shaft."""
        count = self.waves.shape[-1]
        return 2 * pi / self.periods * np.arange(count) / count


def held_at_edges(
    axes: tuple[np.ndarray, ...],
    values: Float[np.ndarray, "..."],
    places: Float[np.ndarray, "place axis"],
) -> Float[np.ndarray, "..."]:
    """Linear interpolation along every axis, places beyond the ends moved to them.

    Parameters
    ----------
    values
        The axes' dimensions first, any others behind.
    """
    weights = np.ones((1, len(places)))
    corners: list[tuple] = [()]
    for axis, along in zip(axes, places.T, strict=True):
        if len(axis) == 1:
            here = np.zeros(len(places), dtype=int)
            corners = [(*corner, here) for corner in corners]
            continue
        inside = np.clip(along, axis[0], axis[-1])
        before = np.clip(np.searchsorted(axis, inside, side="right") - 1, 0, len(axis) - 2)
        share = (inside - axis[before]) / (axis[before + 1] - axis[before])
        corners = [(*corner, at) for corner in corners for at in (before, before + 1)]
        weights = np.stack([w * part for w in weights for part in (1 - share, share)])
    behind = (...,) + (None,) * (values.ndim - len(axes))
    terms = [values[corner] * weight[behind] for corner, weight in zip(corners, weights,
                                                                       strict=True)]  # fmt: skip
    return np.sum(terms, axis=0)


def spline_coefficients(
    samples: Float[np.ndarray, "*rest angle"],
) -> Float[np.ndarray, "*rest angle"]:
    """Of the periodic cubic B-splines through equidistant samples.

    A spline's value at a knot is `(c[-1] + 4 c[0] + c[1]) / 6`: division in Fourier space.
    """
    count = samples.shape[-1]
    response = (2 + np.cos(2 * pi * np.arange(count // 2 + 1) / count)) / 3
    return np.fft.irfft(np.fft.rfft(samples, axis=-1) / response, n=count, axis=-1)

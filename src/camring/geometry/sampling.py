"""Pitch curves on a regular grid, in NumPy: for checks at the door.

Reading a file must not wait for a compiler, so what is refused there is found
with the spline's own matrices, without JAX. Nothing is simulated from it.
"""

from math import pi
from typing import NamedTuple

import numpy as np

from camring.numerics.spline import basis_matrix


class Samples(NamedTuple):
    """A spline over one period, `per_span` places from each knot to the next."""

    angle: np.ndarray
    value: np.ndarray
    first: np.ndarray


def sample_spline(control: np.ndarray, period: float, degree: int, per_span: int = 16) -> Samples:
    """The periodic spline of these control values and its slope, shape (count * per_span,).

    `control` is real (m) or complex; the angles lie in [0, period) and ascend.
    """
    count = len(control)
    spacing = period / count
    matrix = basis_matrix(degree)
    within = (np.arange(per_span) / per_span)[:, None] ** np.arange(degree + 1)
    slope = np.zeros((degree + 1, degree + 1))
    slope[:, :-1] = matrix[:, 1:] * np.arange(1, degree + 1)
    neighbours = np.stack([np.roll(control, k) for k in range(degree + 1)])
    start = np.arange(count) - (degree + 1) / 2
    angle = (start[:, None] + np.arange(per_span) / per_span).reshape(-1) * spacing % period
    value = (neighbours.T @ matrix @ within.T).reshape(-1)
    first = (neighbours.T @ slope @ within.T).reshape(-1) / spacing
    order = np.argsort(angle, kind="stable")
    return Samples(angle[order], value[order], first[order])


def full_ring(points: np.ndarray, repeats: int) -> np.ndarray:
    """Control points (count, 2) of one period as complex numbers around the whole ring."""
    period = points[:, 0] + 1j * points[:, 1]
    turns = np.exp(2j * pi / repeats * np.arange(repeats))
    return (turns[:, None] * period).reshape(-1)


def from_first(points: np.ndarray, repeats: int) -> np.ndarray:
    """The same curve's control points (count, 2), counted from the one nearest angle zero."""
    turns = np.exp(2j * pi / repeats * np.arange(repeats))
    ring = (turns[:, None] * (points[:, 0] + 1j * points[:, 1])).reshape(-1)
    first = int(np.argmin(np.abs(np.angle(ring))))
    chosen = np.roll(ring, -first)[: len(points)]
    return points if first == 0 else np.stack([chosen.real, chosen.imag], axis=1)


class Turning(NamedTuple):
    """How a closed curve goes round the shaft."""

    least: float  # smallest rate of polar angle against the curve's parameter
    angle: float  # polar angle of the place where it is, rad
    winding: int  # times round the shaft, anticlockwise
    lag: float  # greatest distance of polar angle from parameter, rad
    radius: Samples  # pitch radius at the samples, against polar angle


def turning(points: np.ndarray, repeats: int, degree: int) -> Turning:
    """How the planar spline of these control points (count, 2) goes round the shaft."""
    ring = full_ring(points, repeats)
    curve = sample_spline(ring, 2 * pi, degree, 8 if len(ring) > 5000 else 16)
    safe = np.where(np.abs(curve.value) > 0, curve.value, np.nan)
    rate = np.nan_to_num(np.imag(curve.first / safe), nan=-np.inf)
    worst = int(np.argmin(rate))
    steps = np.angle(np.roll(curve.value, -1) * np.conj(curve.value))
    polar = np.angle(curve.value[0]) + np.concatenate([[0.0], np.cumsum(steps)[:-1]])
    radius = np.abs(curve.value)
    return Turning(
        float(rate[worst]),
        float(np.angle(curve.value[worst]) % (2 * pi)),
        round(float(np.sum(steps)) / (2 * pi)),
        float(np.max(np.abs(polar - curve.angle))),
        Samples(polar % (2 * pi), radius, radius * np.real(curve.first / safe) / rate),
    )

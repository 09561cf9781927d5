"""Textbook cams, as control values of the spline over one lobe.

A profile is a law of lift over the lobe's phase: 0 at the inner dead centre,
pi at the outer. Smooth laws are interpolated at the knots, so that dead centres
and stroke are exact; the zero-ripple cams are exact in the spline itself.
"""

from collections.abc import Callable, Iterator
from math import comb, gcd, pi
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from camring.numerics.spline import basis_matrix

Phase = Float[np.ndarray, "*grid"]
Lift = Float[np.ndarray, "*grid"]  # as a share of the stroke


def sine(phase: Phase) -> Lift:
    """Simple harmonic motion: the smoothest acceleration, no dwell."""
    return (1 - np.cos(phase)) / 2


def constant_acceleration(phase: Phase) -> Lift:
    """Two parabolas a flank: the least peak acceleration, endless jerk between them."""
    part = _flank(phase)
    return np.where(part < 0.5, 2 * part**2, 1 - 2 * (1 - part) ** 2)


def modified_trapezoid(phase: Phase) -> Lift:
    """Trapezoid of acceleration with sine ramps of an eighth of a flank.

    The classical law of fast cams (Norton, *Cam Design and Manufacturing
    Handbook*, 2nd ed., section 3.3); acceleration is zero at the dead centres.
    """
    part = _flank(phase)
    half = np.minimum(part, 1 - part)
    # notation: acceleration a sin(4 pi x), then a, then a cos(4 pi (x - 3/8)), pieces joined
    #           in value and slope; a chosen so that half a flank rises by 1/2
    k = 4 * pi
    first = half / k - np.sin(k * half) / k**2
    x = np.minimum(half, 3 / 8) - 1 / 8
    second = (1 / 8) / k - 1 / k**2 + x / k + x**2 / 2
    speed, rise = 1 / k + 1 / 4, (1 / 8) / k - 1 / k**2 + (1 / 4) / k + 1 / 32
    # (1/8)/k - sin(pi/2)/k^2 is the rise of the first piece, 1/k its final speed
    x = half - 3 / 8
    third = rise + speed * x + (1 - np.cos(k * x)) / k**2
    lift = np.where(half < 1 / 8, first, np.where(half < 3 / 8, second, third))
    top = rise + speed / 8 + 1 / k**2
    lift = lift / (2 * top)
    return np.where(part <= 0.5, lift, 1 - lift)


def _flank(phase: Phase) -> Phase:
    """Share of the flank travelled: 0 at the inner dead centre, 1 at the outer."""
    turn = np.mod(phase / (2 * pi), 1.0)
    return 2 * np.minimum(turn, 1 - turn)


LAWS: dict[str, Callable[[Phase], Lift]] = {
    "sine": sine,
    "constant-acceleration": constant_acceleration,
    "trapezoid": modified_trapezoid,
}


def control_values(
    law: Callable[[Phase], Lift], count: int, degree: int = 3
) -> Float[np.ndarray, " control"]:
    """Control values of one lobe whose spline passes through the law at every `j h`.

    Returned for a stroke of 1 from 0; `count` should be even, so that a control
    value stands at both dead centres.
    """
    lift = law(2 * pi * np.arange(count) / count)
    matrix = basis_matrix(degree)
    # Value of the basis at the control values' own angles: start of a span for
    # odd degrees, its middle for even ones.
    weights = matrix[:, 0] if degree % 2 else matrix @ 0.5 ** np.arange(degree + 1)
    kernel = np.zeros(count)
    for place, weight in enumerate(weights):
        kernel[(place - (degree + 1) // 2) % count] += weight
    return np.real(np.fft.ifft(np.fft.fft(lift) / np.fft.fft(kernel)))


class ZeroRipple(NamedTuple):
    """A spline cam whose geometric torque ripple vanishes with ideal switching."""

    steps: Float[np.ndarray, " step"]  # of the rising control values, any scale
    box: int  # control spans of the box, j m / q
    kernel: Float[np.ndarray, " tap"]

    def control_values(self, count: int) -> Float[np.ndarray, " control"]:
        """Control values of one lobe for a stroke of 1 from 0, dead centre at angle 0."""
        change = np.zeros(count)
        length = len(self.steps)
        change[:length] = self.steps
        change[count // 2 : count // 2 + length] = -self.steps
        values = np.cumsum(change) / np.sum(self.steps)
        # The inner dwell is symmetric about half of `count + count/2 + length - 2`.
        return np.roll(values, -((3 * count // 2 + length - 2) // 2))


def zero_ripple_cams(pistons: int, lobes: int, count: int, degree: int = 3) -> Iterator[ZeroRipple]:
    """Every zero-ripple spline cam of the kernels here, symmetric about a control value.

    docs/theory.md section 11: the rising slope is a box of `j/q` of a lobe convolved
    with a non-negative kernel, `q` the distinct piston phases; flank and fall
    must not meet, `steps + degree - 1 <= count/2`.

    Parameters
    ----------
    count
        Control values of one lobe; even and a multiple of `q`, else there is none.
    """
    phases = pistons // gcd(pistons, lobes)
    if count % 2 or count % phases or phases < 2:
        return
    longest = count // 2 - (degree - 1)
    seen: set[tuple[float, ...]] = set()
    for j in range(1, phases):
        box = j * count // phases
        for kernel in _kernels(longest - box + 1):
            steps = np.convolve(np.ones(box), kernel)
            key = tuple(np.round(steps / np.sum(steps), 12))
            # Else the dead centre lies between two control values.
            centred = (3 * count // 2 + len(steps)) % 2 == 0
            if centred and key not in seen:
                seen.add(key)
                yield ZeroRipple(steps, box, kernel)


def _kernels(longest: int) -> Iterator[Float[np.ndarray, " tap"]]:
    """Symmetric non-negative kernels: boxes, boxes of boxes, binomials, tapers."""
    for length in range(1, longest + 1):
        candidates = [np.ones(length), np.array([comb(length - 1, k) for k in range(length)])]
        for inner in range(2, length):
            candidates.append(np.convolve(np.ones(inner), np.ones(length - inner + 1)))
        if length >= 3:
            candidates += [
                np.array([edge, *[1.0] * (length - 2), edge]) for edge in (0.25, 0.5, 2.0, 4.0)
            ]
        yield from (kernel / np.sum(kernel) for kernel in candidates)

"""Pitch radii of many radial cams side by side, a member for each (`numerics/batch.py`).

The cams share their counts and degree and differ in their control radii, shape
(control, batch). Where angles differ from member to member each member takes its own piece;
at fixed fractions of the period the piece is known beforehand.
"""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from camring.geometry.cam import RadialCam
from camring.numerics.batch import take
from camring.numerics.compilation import computed_once
from camring.numerics.extremum import rise_to_turn
from camring.numerics.quantity import Q
from camring.numerics.radau import combine, horner
from camring.numerics.selection import larger, largest, smaller, smallest
from camring.numerics.spline import Jet, basis_matrix, floor_past_rounding

SAMPLES_PER_SPAN = 8
"""Parts of each span between which a cam's extremes are sought; a multiple of four."""


def radius_at(cam: RadialCam, angle: Q[Float[Array, "*grid batch"], "rad"]) -> Jet:
    """Pitch radius and its derivatives at angles that differ from member to member."""
    degree, spacing = cam.degree, cam.period / _count(cam)
    position = angle / spacing + (degree + 1) / 2
    span = floor_past_rounding(position)
    within = position - span
    number = (span - _count(cam) * jnp.floor(span / _count(cam))).astype(jnp.int32)
    # Looked up once: the compiler would do it again for each derivative.
    powers, within = computed_once(([take(each, number) for each in _span_powers(cam)], within))
    derivatives = []
    for order in range(4):
        derivatives.append(horner(powers, within) / spacing**order)
        powers = [power * each for power, each in enumerate(powers)][1:]
    return Jet(*derivatives)


def radius_around(cam: RadialCam, fraction: Float[np.ndarray, " place"]) -> Jet:
    """The same at fixed fractions of the period, shape (place, batch)."""
    degree, count = cam.degree, _count(cam)
    position = fraction * count + (degree + 1) / 2
    span = np.floor(position + 1e-9)
    return _weighted(cam, span.astype(int), position - span)


class RoundTheCam(NamedTuple):
    """A cam sampled in every span from knot to knot, and the turning points between."""

    radius: Jet
    """Shape (point, span, batch): ends and equal parts of every span."""
    turning_radius: Q[Float[Array, "part span batch"], "m"]
    """Where the slope changes its sign between two samples; elsewhere the later sample."""

    def extremes(self) -> tuple[Q[Float[Array, " batch"], "m"], Q[Float[Array, " batch"], "m"]]:
        """Smallest and largest pitch radius."""
        value, turning = self.radius.value, self.turning_radius
        lowest = smaller(smallest(value, axis=(0, 1)), smallest(turning, axis=(0, 1)))
        highest = larger(largest(value, axis=(0, 1)), largest(turning, axis=(0, 1)))
        return lowest, highest

    def rises(
        self, counted: Float[Array, "span batch"] | None = None
    ) -> Q[Float[Array, " batch"], "m"]:
        """What the radius climbs in one period, all rises together.

        Half of all it travels, for falls undo rises; of some spans also half of what they gain.

        Parameters
        ----------
        counted
            One for each span that counts, else zero; all of them unless given.
        """
        before, after = self.radius.value[:-1], self.radius.value[1:]
        there = jnp.abs(self.turning_radius - before) + jnp.abs(after - self.turning_radius)
        there = there if counted is None else (there + after - before) * counted
        return jnp.sum(there, axis=(0, 1)) / 2


def round_the_cam(cam: RadialCam, parts: int = SAMPLES_PER_SPAN) -> RoundTheCam:
    """Samples for what a cam is by itself: exact turning points at degree 3."""
    count = _count(cam)
    within = np.repeat(np.arange(parts + 1) / parts, count)
    span = np.tile(np.arange(count), parts + 1)
    jet = _weighted(cam, span, within)
    jet = Jet(*(each.reshape(parts + 1, count, -1) for each in jet))
    step = cam.period / count / parts
    value, slope = jet.value, jet.first * step
    there = rise_to_turn(slope[:-1], slope[1:], value[1:] - value[:-1])
    return RoundTheCam(jet, value[:-1] + there)


def _count(cam: RadialCam) -> int:
    return cam.control_radii.shape[0]


def _span_powers(cam: RadialCam) -> list[Float[Array, "span batch"]]:
    """Coefficients of every span's polynomial, lowest power first."""
    matrix, pieces = basis_matrix(cam.degree), range(cam.degree + 1)
    shifted = [jnp.roll(cam.control_radii, piece, axis=0) for piece in pieces]
    return [combine(matrix[:, power], shifted) for power in pieces]


def _weighted(cam: RadialCam, span: np.ndarray, within: np.ndarray) -> Jet:
    """Numbered spans at known fractions: fixed weights of neighbouring control radii."""
    degree, count = cam.degree, _count(cam)
    matrix = basis_matrix(degree)
    powers = within[:, None] ** np.arange(degree + 1)
    derivatives = []
    for order in range(4):
        weight = powers @ matrix.T * (count / cam.period) ** order
        terms = [weight[:, [k]] * cam.control_radii[(span - k) % count] for k in range(degree + 1)]
        derivatives.append(sum(terms[1:], terms[0]))
        matrix = np.roll(matrix * np.arange(degree + 1), -1, axis=1)
    return Jet(*derivatives)

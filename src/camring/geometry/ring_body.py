"""The ring's body: how much of it stands outside the working surface."""

import numpy as np
from jaxtyping import Float

from camring.numerics.quantity import Q

__all__ = ["RING_WALL", "usual_outer_radius", "wall_outside"]

RING_WALL = 0.6
"""Bores of ring and housing outside the deepest place of the working surface; assumed."""

Lengths = Q[Float[np.ndarray, "*batch"], "m"] | float


def usual_outer_radius(greatest_radius: Lengths, roller_radius: Lengths, bore: Lengths) -> Lengths:
    """Outer radius of a ring's body of the usual wall, m.

    The one rule by which a motor is sized, a ring is drawn and a given outer diameter is
    compared.

    Parameters
    ----------
    greatest_radius
        Of the pitch curve: where the roller's centre stands at the outer dead centre.
    """
    return greatest_radius + roller_radius + RING_WALL * bore


def wall_outside(
    outer_diameter: Lengths, greatest_radius: Lengths, roller_radius: Lengths
) -> Lengths:
    """What a body leaves outside the deepest place, m; negative where the cam reaches beyond it."""
    return outer_diameter / 2 - greatest_radius - roller_radius

"""How pistons stand round the cylinder block: where their bores would run into each other."""

from math import pi

import numpy as np
from jaxtyping import Float

from camring.numerics.quantity import Q

Lengths = Q[Float[np.ndarray, "*batch"], "m"] | float


def meeting_radius(pistons: int | np.ndarray, bore: Lengths) -> Lengths:
    """Radius at which the walls between neighbouring bores come to nothing, m.

    `bore / (2 sin(pi / pistons))`: axes stand `2 R sin(pi / pistons)` apart at the
    radius `R`. One piston alone meets nobody: zero.
    """
    turned = np.sin(pi / np.asarray(pistons))
    alone = np.asarray(pistons) < 2
    return np.where(alone, 0.0, bore / (2 * np.where(alone, 1.0, turned)))


def wall_between(pistons: int | np.ndarray, bore: Lengths, radius: Lengths) -> Lengths:
    """Thickness of the block between two bores at a radius, m; negative where they overlap."""
    return 2 * np.asarray(radius) * np.sin(pi / np.asarray(pistons)) - bore


def guided_length(pistons: int | np.ndarray, bore: Lengths, least_radius: Lengths) -> Lengths:
    """Longest piston, from the roller's centre inwards, that neighbours leave room for, m.

    Parameters
    ----------
    least_radius
        Of the pitch curve: where the roller's centre stands at the inner dead centre.

    Returns
    -------
    Negative where the bores overlap even there.
    """
    return np.asarray(least_radius) - meeting_radius(pistons, bore)

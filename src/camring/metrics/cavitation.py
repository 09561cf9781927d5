"""How near a chamber comes to air release and vapour, and for how long it is there.

Below the atmospheric pressure at which the oil met it, air comes out of
solution; below the vapour pressure the oil boils. Nothing is clipped: the
margins are negative, and the shares of the cycle above zero, where that happens.
"""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from camring.numerics.extremum import EXTREMUM_FRACTIONS
from camring.numerics.quantity import Q
from camring.numerics.selection import bounded, smaller
from camring.physics.cycle import Cycle


class Cavitation(eqx.Module):
    """Margins of the lowest chamber pressure, and shares of the cycle spent below."""

    air_release_margin: Q[Float[Array, ""], "Pa"]
    vapour_margin: Q[Float[Array, ""], "Pa"]
    share_below_air_release: Q[Float[Array, ""], "1"]
    share_below_vapour: Q[Float[Array, ""], "1"]


def cavitation(
    cycle: Cycle,
    pressure: Q[Float[Array, "point element *batch"], "Pa"],
    least_pressure: Q[Float[Array, "*batch"], "Pa"],
    fractions: Float[np.ndarray, " point"] = EXTREMUM_FRACTIONS,
) -> Cavitation:
    """Cavitation of a cycle whose pressure is sampled at fractions of every element.

    Between two samples the pressure counts as straight, so the shares move
    smoothly with a design: good to 1e-5 of the period, where the pressure
    crosses a limit in the middle of an element.
    """
    fluid, width = cycle.fluid, cycle.orbit.mesh.width
    length = np.diff(fractions).reshape(-1, *(1 for _ in width.shape)) * width

    def share_below(limit: Q[Float[Array, ""], "Pa"]) -> Q[Float[Array, ""], "1"]:
        one, other = pressure[:-1], pressure[1:]
        low, rise = smaller(one, other), jnp.abs(other - one)
        part = bounded((limit - low) / jnp.where(rise > 0, rise, 1), 0, 1)
        below = jnp.where(rise > 0, part, limit > low)
        return jnp.sum(below * length, axis=(0, 1)) / jnp.sum(width, axis=0)

    return Cavitation(
        air_release_margin=least_pressure - fluid.atmospheric_pressure,
        vapour_margin=least_pressure - fluid.vapour_pressure,
        share_below_air_release=share_below(fluid.atmospheric_pressure),
        share_below_vapour=share_below(fluid.vapour_pressure),
    )

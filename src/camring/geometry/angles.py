"""Distances on a circle."""

from math import pi

import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.numerics.quantity import Q

REVOLUTION = 2 * pi


def signed_distance(
    angle: Q[Float[Array, "*grid"], "rad"],
    centre: Q[Float[Array, ""], "rad"],
    period: float,
) -> Q[Float[Array, "*grid"], "rad"]:
    """The short way from `centre` to `angle` on a circle of the given period.

    Positive ahead of the centre, within [-period/2, period/2].
    """
    ahead = angle - centre
    return ahead - period * jnp.round(ahead / period)

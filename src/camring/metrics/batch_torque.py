"""Largest and smallest shaft torque of many motors side by side (`numerics/batch.py`).

Between two places at which any piston passes a node of its mesh, shaft torque is a sum
of cubics, so itself a cubic, whose extremes are known exactly. Each node of the mesh
begins one such interval; where the other pistons stand then, and which of them is the
first to pass its next node, says the rest.
"""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from camring.numerics.batch import locate, take
from camring.numerics.batch_extremum import highest_of_cubics
from camring.numerics.compilation import computed_once
from camring.numerics.quantity import Q
from camring.numerics.radau import element_powers
from camring.numerics.selection import bounded, smaller, smallest
from camring.physics.cycle import Cycle


def torque_span(
    cycle: Cycle, torque: Q[Float[Array, "4 element batch"], "N.m"]
) -> Q[Float[Array, " batch"], "N.m"]:
    """From the lowest to the highest torque on the shaft.

    Parameters
    ----------
    torque
        Of one piston, at an element's start and its collocation points.
    """
    motor, mesh = cycle.motor, cycle.orbit.mesh
    period, phases = motor.cam.period, motor.distinct_phases
    powers = computed_once(element_powers(torque[0], torque[1:]))
    width = jnp.where(mesh.width > 0, mesh.width, period)

    ahead = jnp.asarray(np.arange(1, phases) * (period / phases))[:, None, None]
    place = mesh.start + ahead
    place = jnp.where(place >= mesh.start[:1] + period, place - period, place)
    element = locate(mesh.start, place.reshape(-1, place.shape[-1])).reshape(place.shape)
    their_width = take(width, element)
    fraction = bounded((place - take(mesh.start, element)) / their_width, 0, 1)
    element, their_width, fraction = computed_once((element, their_width, fraction))

    left = (1 - fraction) * their_width
    length = computed_once(smaller(mesh.width, smaller(smallest(left, axis=0), period)))
    share = length / width
    whole = _in_parts(list(powers), jnp.zeros_like(share), share)
    if phases > 1:
        theirs = [take(each, element) for each in powers]
        others = _in_parts(theirs, fraction, length / their_width)
        whole = [mine + jnp.sum(rest, axis=0) for mine, rest in zip(whole, others, strict=True)]
    whole = computed_once(whole)
    span = highest_of_cubics(whole) + highest_of_cubics([-each for each in whole])
    return motor.pistons // phases * span


def _in_parts(powers: list[Array], fraction: Array, share: Array) -> list[Array]:
    """Coefficients of cubics from a fraction of their elements on, over a share of these."""
    constant, first, second, third = powers
    return [
        constant + fraction * (first + fraction * (second + fraction * third)),
        share * (first + fraction * (2 * second + fraction * 3 * third)),
        share**2 * (second + fraction * 3 * third),
        share**3 * third,
    ]

"""What a piston rises under pressure in one revolution: the geometry behind displacement.

Of idle lobes nothing counts, for what is drawn in there comes from the return.
"""

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from camring.geometry.angles import REVOLUTION, signed_distance
from camring.geometry.valve_plate import ValvePlate
from camring.numerics.extremum import EXTREMUM_FRACTIONS, total_variation
from camring.numerics.quantity import Q
from camring.physics.motor import Motor

__all__ = ["driving", "rises_between_knots"]

ASIDE = 1e-7  # of a pitch, so that a place midway between two lobes belongs to one


def driving(
    plate: ValvePlate, angle: Q[Float[Array, "*grid"], "rad"]
) -> Bool[Array, "*grid"] | Float[Array, "*grid"]:
    """Whether an angle lies on a lobe that is fed, lobes counted from inner dead centre to next.

    The windows say which lobe is which; a shift or a few degrees of theirs move no lobe.
    """
    pitch = plate.pitch
    middle = (plate.supply.centre + plate.return_.centre) / 2
    first = pitch * (jnp.round(middle / pitch - 0.5) + 0.5)
    found = jnp.ones_like(angle)
    for lobe in plate.idle_lobes:
        away = jnp.abs(signed_distance(angle + ASIDE * pitch, first + lobe * pitch, REVOLUTION))
        found = jnp.where(away < pitch / 2, 0.0, found)
    return found


def rises_between_knots(motor: Motor) -> Q[Float[Array, ""], "m"]:
    """All that a piston rises on fed lobes in one revolution, from the cam alone."""
    knots = motor.cam.breakpoints()
    width = jnp.diff(knots, append=knots[:1] + motor.cam.period)
    radius = motor.cam.pitch_radius_between(knots, width, jnp.asarray(EXTREMUM_FRACTIONS))
    fed = driving(motor.valve_plate, knots + width / 2)
    quarter = width / (len(EXTREMUM_FRACTIONS) - 1)
    value = radius.value * fed
    travel = total_variation(value, radius.first * fed, quarter)
    # A lobe between unequal ones may end higher than it begins: rises less falls is its climb.
    climb = jnp.sum(value[-1] - value[0])
    return motor.cam.repeats * (travel + climb) / 2

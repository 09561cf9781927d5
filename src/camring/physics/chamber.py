"""What a chamber is at each angle, whatever the pressure in it."""

from typing import NamedTuple

from jaxtyping import Array, Float

from camring.numerics.quantity import Q
from camring.numerics.spline import Jet
from camring.physics.motor import Motor


class Chamber(NamedTuple):
    """Openings and volume, and how the volume changes."""

    supply_area: Q[Float[Array, "*grid"], "m2"]
    return_area: Q[Float[Array, "*grid"], "m2"]
    volume: Q[Float[Array, "*grid"], "m3"]
    volume_slope: Q[Float[Array, "*grid"], "m3/rad"]


def chamber_between(
    motor: Motor,
    reference: Q[Float[Array, ""], "m"],
    start: Q[Float[Array, " element"], "rad"],
    width: Q[Float[Array, " element"], "rad"],
    fraction: Float[Array, " point"],
) -> tuple[Jet, Chamber]:
    """Cam and chamber at fractions of elements that no breakpoint divides."""
    angle = start + fraction[:, None] * width
    radius = motor.cam.pitch_radius_between(start, width, fraction)
    return radius, chamber_at(motor, reference, angle, radius)


def chamber_alone(
    parameters: tuple,
    start: Q[Float[Array, " element"], "rad"],
    width: Q[Float[Array, " element"], "rad"],
    fraction: Float[Array, " point"],
) -> Chamber:
    """The chamber as a solver asks for it: parameters are motor, fluid, point and reference."""
    motor, _, _, reference = parameters
    return chamber_between(motor, reference, start, width, fraction)[1]


def chamber_at(
    motor: Motor,
    reference: Q[Float[Array, ""], "m"],
    angle: Q[Float[Array, "*grid"], "rad"],
    radius: Jet,
) -> Chamber:
    """Openings and volume of the chamber whose piston stands at each angle."""
    plate, area = motor.valve_plate, motor.piston.area
    return Chamber(
        plate.port_area * plate.opening(plate.supply, angle),
        plate.port_area * plate.opening(plate.return_, angle),
        motor.dead_volume + area * (radius.value - reference),
        area * radius.first,
    )

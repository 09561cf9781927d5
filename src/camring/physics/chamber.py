"""What a chamber is at each angle, whatever the pressure in it."""

from typing import Any, NamedTuple

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
    idle_area: Q[Float[Array, "*grid"], "m2"] | None = None
    """Of supply windows that lead to the return; None where no lobe idles."""


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
    parameters: tuple[Any, ...],
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
    supply, back = plate.opening(plate.supply, angle), plate.opening(plate.return_, angle)
    idle_area = None
    if plate.idle_lobes:
        # A window of its own: laminar flow through two is not that through both areas in one.
        idle = plate.idle_share(plate.supply, angle)
        supply, idle_area = supply * (1 - idle), plate.area_of(plate.supply) * supply * idle
    return Chamber(
        plate.area_of(plate.supply) * supply,
        plate.area_of(plate.return_) * back,
        motor.dead_volume + area * (radius.value - reference),
        area * radius.first,
        idle_area,
    )

"""What figures sample of a motor or a cycle, each one compiled program."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from jaxtyping import Array, Float

from camring.geometry.contour import pressure_angle, undercut_factor
from camring.metrics.spectrum import OrderSpectrum, order_spectrum
from camring.numerics.quantity import Q, real
from camring.physics.cycle import reference_radius
from camring.programs.motor_program import motor_program

if TYPE_CHECKING:
    from camring.physics.motor import Motor

spectra = motor_program(order_spectrum)


class Unrolled(NamedTuple):
    """The cam and the windows over the cam's angle."""

    angle: Q[Float[Array, " angle"], "rad"]
    radius: Q[Float[Array, " angle"], "m"]
    slope: Q[Float[Array, " angle"], "m/rad"]
    lift: Q[Float[Array, " angle"], "m"]
    pressure_angle: Q[Float[Array, " angle"], "rad"]
    undercut_factor: Q[Float[Array, " angle"], "1"]
    supply_opening: Q[Float[Array, " angle"], "1"]
    return_opening: Q[Float[Array, " angle"], "1"]


def unrolled(motor: "Motor", highest: float, count: int) -> Unrolled:
    """A motor's cam from 0 to an angle, both ends in."""
    return _unrolled(motor, real(np.linspace(0, highest, count)))


@motor_program
def _unrolled(motor: "Motor", angle: Q[Float[Array, " angle"], "rad"]) -> Unrolled:
    jet, plate = motor.cam.pitch_radius(angle), motor.valve_plate
    return Unrolled(
        angle=angle,
        radius=jet.value,
        slope=jet.first,
        lift=jet.value - reference_radius(motor),
        pressure_angle=pressure_angle(jet),
        undercut_factor=undercut_factor(jet, motor.roller.radius),
        supply_opening=plate.opening(plate.supply, angle),
        return_opening=plate.opening(plate.return_, angle),
    )


__all__ = ["OrderSpectrum", "Unrolled", "spectra", "unrolled"]

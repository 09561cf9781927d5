"""Both directions of rotation: what is simulated when a motor turns backwards.

A directional valve exchanges the ports: windows that were fed from the supply now lead
to the return, and the other way round. Seen from the other end of its shaft such a
motor turns forwards again, as its own mirror image. That image is what is simulated:
angles count the way the shaft turns, torque is positive that way, and every result
means what it always does.
"""

from dataclasses import replace

from camring.physics.mirror import has_mirror_image, mirrored
from camring.physics.motor import Motor
from camring.physics.operating_point import OperatingPoint

__all__ = ["turned"]


def turned(motor: Motor, point: OperatingPoint) -> Motor:
    """The motor as an operating point turns it: itself, or seen from behind if backwards.

    Linear in the motor's numbers, so it turns directions of change too. A motor that has
    been turned stays as it is. Traceable; works with lanes along the last axis.

    Raises
    ------
    ValueError
        When the plate has a relief notch, which would lie at the closing edge, or the cam
        is none whose mirror image is known.

    Notes
    -----
    A manifold stays before whichever windows are fed: both galleries are taken as alike.
    """
    if point.reverse == motor.from_behind:
        return motor
    if not has_mirror_image(motor):
        raise ValueError(
            "A motor with a relief notch turns forwards only: backwards the notch would lie at "
            "the closing edge, which this model does not have; leave the notch out."
        )
    image = mirrored(motor)
    plate = image.valve_plate
    exchanged = replace(plate, supply=plate.return_, return_=plate.supply)
    return replace(image, valve_plate=exchanged, from_behind=point.reverse)

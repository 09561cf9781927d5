"""Both directions of rotation: what is simulated when a motor turns backwards.

A directional valve exchanges the ports: windows that were fed from the supply now lead
to the return, and the other way round. Seen from the other end of its shaft such a
motor turns forwards again, as its own mirror image. That image is what is simulated:
angles count the way the shaft turns, torque is positive that way, and every result
means what it always does.
"""

from dataclasses import replace
from typing import Any

import equinox as eqx

from camring.geometry.idle_lobes import idling
from camring.physics.mirror import has_mirror_image, mirrored
from camring.physics.motor import Motor
from camring.physics.operating_point import OperatingPoint

__all__ = ["in_mode", "turned", "with_like_ports"]


def in_mode(motor: Motor, idle_lobes: tuple[int, ...]) -> Motor:
    """The motor with some lobes idle (`geometry.idle_lobes`); one that has such stays as it is."""
    if not idle_lobes or motor.valve_plate.idle_lobes:
        return motor
    cam, plate = idling(motor.cam, motor.valve_plate, idle_lobes)
    return replace(motor, cam=cam, valve_plate=plate)


def with_like_ports(motor: Motor) -> Motor:
    """The motor whose two kinds of ports hold the same numbers of their own, and does the same.

    Where only one kind has a number of its own, the other takes that of both kinds: then
    mirror image and motor have one structure and may lie in one batch. A tree of marks in a
    motor's place is treated alike.
    """
    plate = motor.valve_plate
    for name in ("area", "discharge_coefficient", "ramp", "notch"):
        given = getattr(plate.supply, name), getattr(plate.return_, name)
        if (given[0] is None) != (given[1] is None):
            without = "supply" if given[0] is None else "return_"
            motor = _with_number(motor, without, name, _of_both_kinds(motor, name))
    return motor


def _with_number(motor: Motor, side: str, name: str, value: Any) -> Motor:
    return eqx.tree_at(
        lambda each: getattr(getattr(each.valve_plate, side), name),
        motor,
        value,
        is_leaf=lambda each: each is None,
    )


def _of_both_kinds(motor: Motor, name: str) -> Any:
    """What a kind of port without a number of its own has."""
    if name == "discharge_coefficient":
        return getattr(motor.orifice, name)
    plate = motor.valve_plate
    if name == "ramp":
        return getattr(plate.window, name)
    return plate.port_area if name == "area" else plate.notch


def turned(motor: Motor, point: OperatingPoint) -> Motor:
    """The motor as an operating point turns it: its mode, and seen from behind if backwards.

    Linear in the motor's numbers, so it turns directions of change too. A motor that has
    been turned stays as it is. Traceable; works with a batch along the last axis.

    Raises
    ------
    ValueError
        When the plate has a relief notch, which would lie at the closing edge, or the cam
        is none whose mirror image is known.

    Notes
    -----
    A manifold stays with what it does, not with its port: `manifold` stands before whichever
    windows are fed, `return_manifold` behind those that lead back.
    """
    motor = in_mode(motor, point.idle_lobes)
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

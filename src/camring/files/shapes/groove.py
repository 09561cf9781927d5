"""A relief groove as the literature states it, by angles and length, becomes a relief notch.

A straight V-groove runs from nothing at its tip to the port's edge, its bottom sloping by the
depth angle and its flanks enclosing the width angle. `x` from the tip it is `x tan(depth angle)`
deep, and its section is `x^2 tan(depth angle)^2 tan(width angle / 2)`: the notch's square law.
On a circle through the ports an arc is an angle.
"""

from math import pi, tan
from typing import Any

from camring.files.errors import InputError
from camring.files.motor.entries import Unfit
from camring.files.shapes.plate_table import SIDES, ValvePlateTable

__all__ = ["GROOVE_KEYS", "groove_section", "with_groove"]

GROOVE_KEYS = ("groove_depth_angle", "groove_width_angle", "groove_length", "groove_circle")
_PLATE = "motor.valve_plate"


def groove_section(depth_angle: float, width_angle: float, distance: float) -> float:
    """Area of a V-groove across its length, `distance` (m) from its tip, m^2; angles in rad."""
    return (distance * tan(depth_angle)) ** 2 * tan(width_angle / 2)


def with_groove(document: dict[str, Any]) -> dict[str, Any]:
    """The document with `notch_angle` and `notch_area` of the groove that it gives.

    A kind of port with an area of its own gets a notch of its own: the same section is another
    share of it.

    Unchanged without a groove, and where the keys cannot be read: reading them says why.

    Raises
    ------
    InputError
        For a part of the groove's keys, a notch beside them, or a section beyond the port's.
    """
    motor = document.get("motor")
    plate = motor.get("valve_plate") if isinstance(motor, dict) else None
    if motor is None or not isinstance(plate, dict) or not set(GROOVE_KEYS) & plate.keys():
        return document
    for key in GROOVE_KEYS:
        if key not in plate:
            raise InputError(f"{_PLATE}.{key}", "is missing: a groove needs all four of its keys",
                             f"give {', '.join(GROOVE_KEYS)}, or none")  # fmt: skip
    varied = document.get("design_space", {})
    for key in (f"{side}notch_{what}" for side in SIDES for what in ("angle", "area")):
        if key in plate or (isinstance(varied, dict) and f"{_PLATE}.{key}" in varied):
            raise InputError(
                f"{_PLATE}.{key}",
                "stands beside a groove of depth angle, width angle and length, which sets it",
                "leave one of the two out",
            )
    try:
        depth, width, length, circle = (_read(key, plate[key]) for key in GROOVE_KEYS)
        keys = ["port_area", *(f"{side}port_area" for side in SIDES[1:])]
        ports = {key: _read(key, plate[key]) for key in keys if key in plate}
    except Unfit:
        return document
    section = groove_section(depth, width, length)
    notches: dict[str, float] = {}
    for key, port in ports.items():
        if section > port:
            raise InputError(
                f"{_PLATE}.groove_length",
                f"gives the groove a section of {1e6 * section:.4g} mm^2 at the port's edge, more "
                f"than {key} of {1e6 * port:.4g} mm^2",
                "shorten it or make its angles smaller",
            )
        side = key.removesuffix("port_area")
        notches[f"{side}notch_angle"] = min(length / circle, 2 * pi)
        notches[f"{side}notch_area"] = section / port
    return {**document, "motor": {**motor, "valve_plate": {**plate, **notches}}}


def _read(key: str, value: Any) -> float:
    (entry,) = (
        each for each in ValvePlateTable.model_fields[key].metadata if hasattr(each, "read")
    )
    return float(entry.read(value))

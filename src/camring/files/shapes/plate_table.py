"""The table [motor.valve_plate]: ports, notches, grooves, the film on it."""

from dataclasses import replace
from typing import Annotated as Key

from camring.files.motor.entries import Number, Numbers
from camring.files.motor.table import FULL_TURN, LARGEST_PART, Table, length, part, usual

__all__ = ["SIDES", "ValvePlateTable"]

SIDES = ("", "supply_", "return_")
"""Before a key of the plate: of both kinds of ports, or of one."""

LANDS = "motor.plate_gap.land_radii"


def _width(side: str) -> Number:
    leaf = f"motor.valve_plate.{side.replace('return', 'return_')}.width"
    meaning = f"the angle over which the {side} window is open"
    return part(leaf, meaning, '"28 deg"', 1e-4, FULL_TURN)


def _angle(leaf: str, meaning: str, example: str) -> Number:
    return part(leaf, meaning, example, -FULL_TURN, FULL_TURN)


OWN: dict[str, tuple[str, str, float, float]] = {
    "area": ("the area of a fully open {} port", '"45 mm^2"', 1e-12, 10.0),
    "discharge_coefficient": ("the discharge coefficient of the {} ports", "0.6", 1e-6, 2.0),
    "ramp": ("the ramps' share of a {} window", "0.35", 1e-4, 1.0),
    "notch.angle": (
        "the angle from a relief notch's tip to the opening edge of a {} port",
        '"1.5 deg"',
        1e-5,
        FULL_TURN,
    ),
    "notch.area": ("the relief notch's share of the {} port's area", "0.03", 0.0, 1.0),
}
"""Numbers that one kind of port may have for itself: meaning, example, limits of sanity."""


def _own(side: str, name: str) -> Number:
    meaning, example, low, high = OWN[name]
    leaf = f"motor.valve_plate.{side.replace('return', 'return_')}.{name}"
    meaning = f"{meaning.format(side)}, where it is its own"
    return part(leaf, meaning, example, low, high)


class ValvePlateTable(Table):
    """[motor.valve_plate]"""

    port_area: Key[
        float,
        part(
            "motor.valve_plate.port_area", "the area of a fully open port", '"60 mm^2"', 1e-12, 10.0
        ),
    ]
    supply_width: Key[float, _width("supply")]
    return_width: Key[float, _width("return")]
    supply_centre: Key[
        float | None,
        _angle(
            "motor.valve_plate.supply.centre",
            "the centre of the first supply window (unless given, a quarter of the lobe pitch)",
            '"15 deg"',
        ),
    ] = None
    return_centre: Key[
        float | None,
        _angle(
            "motor.valve_plate.return_.centre",
            "the centre of the first return window (unless given, 3/4 of the lobe pitch)",
            '"45 deg"',
        ),
    ] = None
    shift: Key[
        float, _angle("motor.valve_plate.shift", "the turn of the whole plate", '"0.5 deg"')
    ] = usual("motor.valve_plate.shift")
    notch_angle: Key[
        float | None,
        part(
            "motor.valve_plate.notch.angle",
            "the angle from a relief notch's tip to the port's opening edge",
            '"1.5 deg"',
            1e-5,
            FULL_TURN,
        ),
    ] = None
    notch_area: Key[
        float | None,
        part(
            "motor.valve_plate.notch.area",
            "the relief notch's share of the port area",
            "0.03",
            high=1.0,
        ),
    ] = None
    supply_port_area: Key[float | None, _own("supply", "area")] = None
    supply_discharge_coefficient: Key[float | None, _own("supply", "discharge_coefficient")] = None
    supply_ramp: Key[float | None, _own("supply", "ramp")] = None
    supply_notch_angle: Key[float | None, _own("supply", "notch.angle")] = None
    supply_notch_area: Key[float | None, _own("supply", "notch.area")] = None
    return_port_area: Key[float | None, _own("return", "area")] = None
    return_discharge_coefficient: Key[float | None, _own("return", "discharge_coefficient")] = None
    return_ramp: Key[float | None, _own("return", "ramp")] = None
    return_notch_angle: Key[float | None, _own("return", "notch.angle")] = None
    return_notch_area: Key[float | None, _own("return", "notch.area")] = None
    gap: Key[
        float | None,
        part(
            "motor.plate_gap.thickness",
            "the thickness of the film between block and valve plate",
            '"8 um"',
            1e-8,
            1e-3,
        ),
    ] = None
    land_radii: Key[
        list[float] | None,
        Numbers(
            "the radii of the plate's lands: inner edge and outer edge of the inner, then of the "
            "outer one, the ports between them",
            '["30 mm", "36 mm", "48 mm", "54 mm"]',
            item=replace(length(LANDS, "a radius", '"30 mm"', 1e-4), leaves=()),
            fewest=4,
            most=4,
            leaves=(LANDS,),
        ),
    ] = None
    groove_depth_angle: Key[
        float | None,
        Number(
            "the slope of a V-groove's bottom against the plate, instead of notch_angle and area",
            '"12 deg"',
            unit="rad",
            low=1e-3,
            high=1.5,
        ),
    ] = None
    groove_width_angle: Key[
        float | None,
        Number(
            "the angle between the V-groove's flanks", '"90 deg"', unit="rad", low=1e-3, high=3.1
        ),
    ] = None
    groove_length: Key[
        float | None,
        Number("the V-groove's length", '"3 mm"', unit="m", low=1e-6, high=LARGEST_PART),
    ] = None
    groove_circle: Key[
        float | None,
        Number(
            "the radius of the circle on which ports and V-grooves lie",
            '"42 mm"',
            unit="m",
            low=1e-4,
            high=LARGEST_PART,
        ),
    ] = None

"""What the laws of the second rung ask of each other: refused before anything is simulated."""

from itertools import pairwise
from math import degrees, pi
from typing import Any

from camring.interfaces.config.tables import FileTables
from camring.interfaces.errors import InputError, quote


def require_sound_laws(tables: FileTables, document: dict[str, Any]) -> None:
    """Refuse laws without the numbers they need, and shapes that contradict themselves.

    Raises
    ------
    InputError
        With the keys that clash.
    """
    _require_viscosity(tables, document)
    _require_whole_notch(tables, document["motor"]["valve_plate"])
    _require_ascending_table(tables.motor.valve_plate, document["motor"]["valve_plate"])
    _require_dissolution(tables.fluid, document["fluid"])


def _require_viscosity(tables: FileTables, document: dict[str, Any]) -> None:
    if tables.fluid.viscosity > 0:  # type: ignore[attr-defined]
        return
    asking = None
    if document["motor"]["valve_plate"].get("orifice") == "laminar-turbulent":
        asking = 'motor.valve_plate.orifice = "laminar-turbulent"'
    if tables.motor.gap is not None:
        asking = "[motor.gap]"
    if asking is not None:
        raise InputError(
            "fluid.viscosity",
            f"is missing: {asking} needs it",
            'give the kinematic viscosity, for example "46 mm^2/s", '
            'or an oil = "ISO VG 46" with its temperature = "50 degC"',
        )


def _require_whole_notch(tables: FileTables, given: dict[str, Any]) -> None:
    plate, pitch = tables.motor.valve_plate, 2 * pi / tables.motor.lobes
    keys = {"notch_angle": plate.notch_angle, "notch_area": plate.notch_area}
    if all(value is None for value in keys.values()):
        return
    for key, value in keys.items():
        if value is None:
            raise InputError(
                f"motor.valve_plate.{key}",
                "is missing: a relief notch has an angle and an area",
                'give notch_angle = "1.5 deg" and notch_area = 0.03, or neither',
            )
    widest = max(plate.supply_width, plate.return_width)
    room = pitch / 2 - widest / 2
    assert plate.notch_angle is not None
    if plate.notch_angle > room * (1 + 1e-12):
        raise InputError(
            "motor.valve_plate.notch_angle",
            f"is {quote(given['notch_angle'])}, more than the {degrees(room):.4g} deg from "
            "the window's edge to where the next window's half of the pitch begins",
            "shorten the notch, or make the windows narrower",
        )


def _require_ascending_table(plate: Any, given: dict[str, Any]) -> None:
    if given.get("shape") != "tabulated":
        return
    places, shares = plate.position, plate.opening_share
    key = "motor.valve_plate.position"
    if len(places) != len(shares):
        raise InputError(
            key,
            f"has {len(places)} items and opening_share {len(shares)}",
            "give as many of one as of the other",
        )
    if any(after <= before for before, after in pairwise(places)):
        raise InputError(key, "does not ascend", "order the points by position")
    if plate.notch_area is not None and _share_at_centre(places, shares) < 1:
        raise InputError(
            "motor.valve_plate.opening_share",
            "is below 1 at the centre, where a relief notch ends",
            "let the opening reach 1 there, or leave the notch out",
        )


def _share_at_centre(places: list[float], shares: list[float]) -> float:
    for k in range(len(places) - 1):
        if places[k] <= 0 <= places[k + 1]:
            part = -places[k] / (places[k + 1] - places[k])
            return shares[k] + part * (shares[k + 1] - shares[k])
    return 0.0


def _require_dissolution(fluid: Any, given: dict[str, Any]) -> None:
    high = getattr(fluid, "dissolution_pressure", None)
    if high is not None and high <= fluid.atmospheric_pressure:
        raise InputError(
            "fluid.dissolution_pressure",
            f"is {quote(given.get('dissolution_pressure', high))}, not above the atmospheric "
            f"pressure of {fluid.atmospheric_pressure / 1e5:.4g} bar",
            "raise it; about 30 bar is common",
        )

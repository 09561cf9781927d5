"""What the laws of the detailed laws ask of each other: refused before anything is simulated."""

from itertools import pairwise
from math import degrees, pi
from typing import Any

from camring.files.errors import InputError, quote
from camring.files.motor.tables import FileTables
from camring.files.shapes.plate_table import SIDES


def require_sound_laws(tables: FileTables, document: dict[str, Any]) -> None:
    """Refuse laws without the numbers they need, and shapes that contradict themselves.

    Raises
    ------
    InputError
        With the keys that clash.
    """
    _require_viscosity(tables, document)
    _require_cooling(tables)
    _require_whole_notch(tables, document["motor"]["valve_plate"])
    _require_laws_with_own_numbers(tables, document["motor"]["valve_plate"])
    _require_whole_plate_gap(tables, document["motor"]["valve_plate"])
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
    if tables.motor.valve_plate.gap is not None:
        asking = "motor.valve_plate.gap"
    if document["motor"].get("leakage") == "viscous":
        asking = 'motor.leakage = "viscous"'
    if asking is not None:
        raise InputError(
            "fluid.viscosity",
            f"is missing: {asking} needs it",
            'give the kinematic viscosity, for example "46 mm^2/s", '
            'or an oil = "ISO VG 46" with its temperature = "50 degC"',
        )


def _require_cooling(tables: FileTables) -> None:
    motor, thermal = tables.motor, tables.thermal
    if tables.constraints.max_case_temperature_rise is not None and thermal is None:
        raise InputError(
            "constraints.max_case_temperature_rise",
            "has no effect without [thermal]",
            "add that table with ambient_temperature and heat_transfer, or leave the limit out",
        )
    if thermal is None or thermal.heat_transfer > 0:
        return
    leaks = getattr(motor, "leakage_coefficient", 1.0) > 0 or motor.gap is not None
    if not leaks and motor.valve_plate.gap is None:
        raise InputError(
            "thermal.heat_transfer",
            "is 0 and no oil leaks into the case, so that nothing carries heat off",
            'give the heat transfer of the surface, such as "12 W/K", or a leakage',
        )


def _require_whole_plate_gap(tables: FileTables, given: dict[str, Any]) -> None:
    plate, place = tables.motor.valve_plate, "motor.valve_plate"
    if plate.gap is None and plate.land_radii is None:
        return
    for key in ("gap", "land_radii"):
        if getattr(plate, key) is None:
            raise InputError(
                f"{place}.{key}",
                "is missing: a film between block and plate has a thickness and lands",
                'give gap = "8 um" and land_radii = ["30 mm", "36 mm", "48 mm", "54 mm"], '
                "or neither",
            )
    assert plate.land_radii is not None
    if any(after <= before for before, after in pairwise(plate.land_radii)):
        raise InputError(
            f"{place}.land_radii",
            "do not ascend",
            "give inner and outer edge of the inner land, then of the outer one",
        )
    if given.get("shape") == "tabulated":
        raise InputError(
            f"{place}.gap",
            'has no effect with shape = "tabulated", which does not say how far slots are apart',
            'leave it out, or set shape = "round" or "linear"',
        )
    passed = tables.motor.manifolds()
    if passed:
        raise InputError(
            f"{place}.gap",
            f"leaks past {passed[0]}, which this model does not have",
            "leave one of the two out",
        )


def _require_whole_notch(tables: FileTables, given: dict[str, Any]) -> None:
    plate, pitch = tables.motor.valve_plate, 2 * pi / tables.motor.lobes
    widths = {"supply_": plate.supply_width, "return_": plate.return_width}
    for side, widest in {"": max(widths.values()), **widths}.items():
        _require_notch_fits(plate, given, side, pitch / 2 - widest / 2)


def _require_notch_fits(plate: Any, given: dict[str, Any], side: str, free: float) -> None:
    keys = {key: getattr(plate, key) for key in (f"{side}notch_angle", f"{side}notch_area")}
    if all(value is None for value in keys.values()):
        return
    for key, value in keys.items():
        if value is None:
            raise InputError(
                f"motor.valve_plate.{key}",
                "is missing: a relief notch has an angle and an area",
                f'give {side}notch_angle = "1.5 deg" and {side}notch_area = 0.03, or neither',
            )
    angle = keys[f"{side}notch_angle"]
    if angle > free * (1 + 1e-12):
        shown = f"{degrees(angle):.4g} deg"  # of a groove's length on its circle
        raise InputError(
            f"motor.valve_plate.{side}notch_angle",
            f"is {quote(given.get(f'{side}notch_angle', shown))}, more than the "
            f"{degrees(free):.4g} deg from the window's edge to where the next window's half of "
            "the pitch begins",
            "shorten the notch, or make the windows narrower",
        )


def notched(plate: Any) -> bool:
    """Whether a table of the valve plate gives any port a relief notch."""
    return any(getattr(plate, f"{side}notch_angle") is not None for side in SIDES)


def _require_laws_with_own_numbers(tables: FileTables, given: dict[str, Any]) -> None:
    """A kind of port has a ramp or coefficient of its own only where the law has one at all."""
    plate = tables.motor.valve_plate
    for name, chooser in (("ramp", "shape"), ("discharge_coefficient", "orifice")):
        for key in (f"supply_{name}", f"return_{name}"):
            if getattr(plate, key) is not None and not hasattr(plate, name):
                raise InputError(
                    f"motor.valve_plate.{key}",
                    f"has no effect with {chooser} = {quote(given.get(chooser))}, which has no "
                    f"{name}",
                    "leave it out",
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
    if notched(plate) and _share_at_centre(places, shares) < 1:
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

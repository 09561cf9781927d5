"""Keys of both kinds of ports that say nothing where each kind has a number of its own."""

from collections.abc import Mapping
from typing import Any

from camring.files.errors import InputError

__all__ = ["overriding", "require_effect"]

PLATE = "motor.valve_plate"
COMMON = ("port_area", "discharge_coefficient", "ramp", "notch_angle", "notch_area")
"""What a kind of port may have for itself, `supply_` or `return_` in front."""


def overriding(key: str, plate: Mapping[str, Any]) -> tuple[str, ...]:
    """The two keys that leave a common one without effect; none where it has one.

    Parameters
    ----------
    key
        Its path in the motor file.
    plate
        What `[motor.valve_plate]` gives, None for what it does not.

    Examples
    --------
    >>> overriding("motor.valve_plate.ramp", {"supply_ramp": 0.3, "return_ramp": 0.4})
    ('motor.valve_plate.supply_ramp', 'motor.valve_plate.return_ramp')
    >>> overriding("motor.valve_plate.ramp", {"supply_ramp": 0.3, "ramp": 0.4})
    ()
    """
    table, _, name = key.rpartition(".")
    own = [f"{side}_{name}" for side in ("supply", "return")]
    if table != PLATE or name not in COMMON or any(plate.get(each) is None for each in own):
        return ()
    return tuple(f"{PLATE}.{each}" for each in own)


def require_effect(field: str, key: str, plate: Mapping[str, Any], instead: str) -> None:
    """Refuse to vary a common number of the ports that no port has.

    Parameters
    ----------
    field
        Where the user wrote the key.
    instead
        What to do with the keys of both sides: "vary", "fit".

    Raises
    ------
    InputError
        Where both kinds of ports have a number of their own.
    """
    if own := overriding(key, plate):
        raise InputError(
            field,
            f"changes nothing: {own[0]} and {own[1].rpartition('.')[2]} are given, one for each "
            f"of the 2 kinds of ports",
            f"{instead} those, or leave one of them out of the motor file",
        )

"""An oil named in the file: its data stand for the keys of [fluid] that are not given."""

from dataclasses import asdict
from typing import Any

from camring.interfaces.config.entries import Unfit
from camring.interfaces.config.tables import FluidTable
from camring.interfaces.errors import InputError, quote
from camring.physics.oils import COLDEST, HOTTEST, OILS, ZERO_CELSIUS, oil_data


def with_oil(document: dict[str, Any]) -> dict[str, Any]:
    """The document with the data of a named oil in it; unchanged without one.

    Raises
    ------
    InputError
        For an oil without a temperature, a temperature without an oil, or one outside its data.
    """
    fluid = document.get("fluid")
    if not isinstance(fluid, dict) or not ({"oil", "temperature"} & fluid.keys()):
        return document
    name = fluid.get("oil")
    if name is None:
        raise InputError(
            "fluid.temperature",
            "has no effect without fluid.oil",
            f'leave it out, or add oil = "{OILS[1]}"',
        )
    if name not in OILS:
        return document  # the table says what is wrong with it
    if "temperature" not in fluid:
        raise InputError(
            "fluid.temperature",
            f"is missing: {quote(name)} has a viscosity only at a temperature",
            'give the temperature of the oil, for example "50 degC"',
        )
    entry = FluidTable.model_fields["temperature"].metadata[0]
    try:
        temperature = entry.read(fluid["temperature"])
    except Unfit:
        return document
    if not COLDEST <= temperature <= HOTTEST:
        raise InputError(
            "fluid.temperature",
            f"is {quote(fluid['temperature'])}, outside the data of {quote(name)}",
            f"give a value from {COLDEST - ZERO_CELSIUS:g} to {HOTTEST - ZERO_CELSIUS:g} degC, "
            "or the oil's density, bulk_modulus, vapour_pressure and viscosity themselves",
        )
    return {**document, "fluid": {**asdict(oil_data(name, temperature)), **fluid}}

"""An oil named in the file: its data stand for the keys of [fluid] that are not given.

A heat balance asks for one, and may say how warm it comes in.
"""

from dataclasses import asdict
from typing import Any

from camring.files.errors import InputError, quote
from camring.files.motor.document import INLET
from camring.files.motor.entries import Unfit
from camring.files.motor.tables import FluidTable, ThermalTable
from camring.physics.oil.presets import COLDEST, HOTTEST, OILS, ZERO_CELSIUS, oil_data


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


def with_inlet(document: dict[str, Any]) -> dict[str, Any]:
    """The document with its oil as warm as `[thermal]` says that it comes in.

    Raises
    ------
    InputError
        For a heat balance without a named oil, or an oil of two temperatures.
    """
    thermal, fluid = document.get("thermal"), document.get("fluid")
    if not isinstance(thermal, dict) or not isinstance(fluid, dict):
        return document
    if "oil" not in fluid:
        raise InputError(
            "[thermal]",
            "needs an oil whose viscosity follows its temperature, and fluid.oil is missing",
            f'name it in [fluid], oil = "{OILS[1]}", with its temperature = "50 degC"',
        )
    if INLET not in thermal:
        return document
    entry = ThermalTable.model_fields[INLET].metadata[0]
    try:
        here = entry.read(thermal[INLET])
        there = entry.read(fluid["temperature"]) if "temperature" in fluid else here
    except Unfit:
        return document  # the table says what is wrong with it
    if abs(here - there) > 1e-9 * here:
        raise InputError(
            f"thermal.{INLET}",
            f"is {quote(thermal[INLET])} and fluid.temperature {quote(fluid['temperature'])}, "
            "but the oil that comes in has one temperature",
            "leave one of the two out",
        )
    return {**document, "fluid": {**fluid, "temperature": thermal[INLET]}}

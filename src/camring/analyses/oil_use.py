"""A motor file's named oil: at other temperatures, and what it does not change, in a sentence."""

import numpy as np

from camring.files.errors import InputError
from camring.files.motor import MotorFile
from camring.files.motor.build import build_system
from camring.files.motor.document import at_temperature
from camring.files.motor.motor_file import validated
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.oil.presets import OILS
from camring.physics.oil.viscosity_use import reads_viscosity

__all__ = ["oils_at", "require_oil", "unread_viscosity"]

_WAY_OUT = (
    'give [motor.gap] with clearance and length, leakage = "viscous" in [motor], or '
    'orifice = "laminar-turbulent" in [motor.valve_plate]'
)


def unread_viscosity(file: MotorFile) -> list[str]:
    """A sentence where a file speaks of its oil's viscosity and no law of its motor reads it."""
    fluid = file.document.get("fluid", {})
    named = [f"fluid.{key}" for key in ("oil", "temperature") if key in fluid]
    if file.envelope is not None and file.envelope.temperatures:
        named.append("envelope.temperature")
    if not named and "viscosity" not in fluid:
        return []
    system = file.system
    if reads_viscosity(system.motor, system.fluid, system.operating_points[0]):
        return []
    if not named:
        return [f"fluid.viscosity has no effect: no law of this motor reads it; {_WAY_OUT}."]
    listed = ", ".join(named[:-1]) + f" and {named[-1]}" if len(named) > 1 else named[0]
    return [
        f"No law of this motor reads a viscosity: {listed} set density, bulk modulus and vapour "
        f"pressure only, and leakage and friction are the same hot and cold; {_WAY_OUT}."
    ]


def require_oil(file: MotorFile) -> None:
    """Refuse an axis of temperatures where the file names no oil."""
    if "oil" not in file.document["fluid"]:
        raise InputError(
            "--temperature",
            f"has no effect while {file.path.name} names no oil",
            f'name it, oil = "{OILS[1]}" in [fluid], with its temperature',
        )


def oils_at(file: MotorFile, temperatures: np.ndarray) -> list[AbstractFluid]:
    """The file's oil at each temperature."""
    found = []
    for kelvin in temperatures:
        choices, tables = validated(at_temperature(file.document, f"{float(kelvin)!r} K"))
        found.append(build_system(tables, choices).fluid)
    return found

"""A small reader of the reference motor files, so that the oracle is tested without the product's.

Every number in those files is a plain number in SI or a text "number unit".
"""

import json
import tomllib
from math import pi
from pathlib import Path

import numpy as np

from camring.reference import Machine, Oil, Window

DATA = Path(__file__).parent / "published" / "data"
UNITS = {
    "mm": 1e-3, "cm^3": 1e-6, "mm^2": 1e-6, "kg": 1.0, "N*s/m": 1.0, "m^3/(s*Pa)": 1.0,
    "GPa": 1e9, "kPa": 1e3, "bar": 1e5, "deg": pi / 180, "rpm": 2 * pi / 60, "kg/m^3": 1.0,
    "N": 1.0, "mm^2/s": 1e-6,
}  # fmt: skip


def si(value):
    """The SI number of "250 bar"; numbers pass through, lists go one by one."""
    if isinstance(value, list):
        return np.array([si(item) for item in value])
    if not isinstance(value, str):
        return value
    number, unit = value.split(" ", 1)
    return float(number) * UNITS[unit]


def reference_document(name: str) -> dict:
    return tomllib.loads((DATA / f"{name}.toml").read_text(encoding="utf-8"))


def reference_results(name: str) -> list[dict[str, float]]:
    return json.loads((DATA / f"{name}.json").read_text(encoding="utf-8"))


def reference_machines(name: str) -> list[Machine]:
    """One machine for each operating point of a reference file."""
    document = reference_document(name)
    motor, fluid = document["motor"], document["fluid"]
    cam, roller, plate = motor["cam"], motor["roller"], motor["valve_plate"]
    pitch = 2 * pi / motor["lobes"]
    shift = si(plate.get("shift", 0.0))
    ramp = plate.get("ramp", 1.0)
    oil = Oil(**{key: si(value) for key, value in fluid.items() if key != "law"}
              | {"law": fluid.get("law", "constant")})  # fmt: skip
    ring = cam.get("symmetry", "lobes") == "ring"
    machines = []
    for point in document["operating_points"]:
        back = si(point["return_pressure"])
        machines.append(
            Machine(
                pistons=motor["pistons"],
                lobes=motor["lobes"],
                bore=si(motor["bore"]),
                piston_mass=si(motor["piston_mass"]),
                viscous_damping=si(motor["viscous_damping"]),
                dead_volume=si(motor["dead_volume"]),
                leakage_coefficient=si(motor["leakage_coefficient"]),
                control=si(cam["control_radii"]),
                repeats=1 if ring else motor["lobes"],
                degree=cam.get("degree", 3),
                reference_radius=cam.get("reference_radius", "minimum"),
                ring_modulus=si(cam["elastic_modulus"]),
                ring_poisson=cam["poisson_ratio"],
                roller_radius=si(roller["radius"]),
                roller_length=si(roller["length"]),
                roller_modulus=si(roller["elastic_modulus"]),
                roller_poisson=roller["poisson_ratio"],
                port_area=si(plate["port_area"]),
                discharge_coefficient=plate["discharge_coefficient"],
                supply=Window(si(plate["supply_width"]), pitch / 4 + shift, ramp=ramp),
                return_=Window(si(plate["return_width"]), 3 * pitch / 4 + shift, ramp=ramp),
                oil=oil,
                shaft_speed=si(point["speed"]),
                supply_pressure=si(point["supply_pressure"]),
                return_pressure=back,
                case_pressure=si(point.get("case_pressure", back)),
            )
        )
    return machines

"""The tables of a motor file: every key, its unit, its limits and the leaf it becomes.

Each field is one key. Keys that belong to an exchangeable law (the oil's, the
orifice's, the window's, ...) are not here: `laws.py` reads them off the law's
own class. Units are those in which the program keeps the number.
"""

from typing import Annotated as Key
from typing import Any

from pydantic import BaseModel, ConfigDict

from camring.interfaces.config.entries import (
    Band,
    Count,
    Number,
    NumberOrWord,
    Numbers,
    Text,
    Word,
    band,
)
from camring.physics.oils import OILS

MOST_POINTS = 50  # operating points in one file
FULL_TURN = 6.283185307179586


class Table(BaseModel):
    """A table of the file: unknown keys are errors, values are final."""

    model_config = ConfigDict(extra="forbid", frozen=True)


def _length(meaning: str, example: str, leaf: str, low: float = 1e-6) -> Number:
    return Number(meaning, example, unit="m", low=low, high=100.0, leaves=(leaf,))


def _modulus(leaf: str) -> Number:
    return Number("Young's modulus", '"206 GPa"', unit="Pa", low=1e6, high=1e14, leaves=(leaf,))


def _poisson(leaf: str) -> Number:
    return Number("Poisson's ratio", "0.3", low=0.0, high=0.5, leaves=(leaf,))


class CamTable(Table):
    """[motor.cam]: keys of every representation; the control values follow below."""

    representation: Key[
        str, Word("how the pitch curve is written", '"radial"', words=("radial", "planar"))
    ] = "radial"
    symmetry: Key[str, Word("over which part it repeats", '"lobes"', words=("lobes", "ring"))] = (
        "lobes"
    )
    reference_radius: Key[
        str | float,
        NumberOrWord(
            "the pitch radius at lift zero",
            '"minimum", "mean" or "90 mm"',
            unit="m",
            low=1e-4,
            high=100.0,
            words=("minimum", "mean"),
            leaves=("motor.given_reference_radius",),
        ),
    ] = "minimum"
    degree: Key[int, Count("the degree of the spline", "3", low=3, high=5)] = 3
    elastic_modulus: Key[float, _modulus("motor.ring_material.elastic_modulus")]
    poisson_ratio: Key[float, _poisson("motor.ring_material.poisson_ratio")]


CONTROL_RADIUS = Number("a control radius", '"90 mm"', unit="m", low=1e-4, high=100.0)
COORDINATE = Number("a coordinate", '"90 mm"', unit="m", low=-100.0, high=100.0)


class RadialCamTable(CamTable):
    """[motor.cam] whose spline is the radius itself."""

    control_radii: Key[
        list[float],
        Numbers(
            "the control radii of one period",
            '["84 mm", "86 mm", ...]',
            item=CONTROL_RADIUS,
            most=720,
            leaves=("motor.cam.control_radii",),
        ),
    ]


class PlanarCamTable(CamTable):
    """[motor.cam] whose spline is a curve in the plane."""

    control_points: Key[
        list[list[float]],
        Numbers(
            "the control points of one period",
            '[["84 mm", "0 mm"], ...]',
            item=Numbers("a point", '["84 mm", "0 mm"]', item=COORDINATE, fewest=2, most=2),
            most=720,
            leaves=("motor.cam.control_points",),
        ),
    ]


class RollerTable(Table):
    """[motor.roller]"""

    radius: Key[float, _length("the roller's radius", '"12 mm"', "motor.roller.radius")]
    length: Key[float, _length("the length of line contact", '"28 mm"', "motor.roller.length")]
    elastic_modulus: Key[float, _modulus("motor.roller.material.elastic_modulus")]
    poisson_ratio: Key[float, _poisson("motor.roller.material.poisson_ratio")]


def _width(side: str) -> Number:
    return Number(
        f"the angle over which the {side} window is open",
        '"28 deg"',
        unit="rad",
        low=1e-4,
        high=FULL_TURN,
        leaves=(f"motor.valve_plate.{side.replace('return', 'return_')}.width",),
    )


def _angle(meaning: str, example: str, leaf: str) -> Number:
    return Number(meaning, example, unit="rad", low=-FULL_TURN, high=FULL_TURN, leaves=(leaf,))


class ValvePlateTable(Table):
    """[motor.valve_plate]"""

    port_area: Key[
        float,
        Number(
            "the area of a fully open port",
            '"60 mm^2"',
            unit="m^2",
            low=1e-12,
            high=10.0,
            leaves=("motor.valve_plate.port_area",),
        ),
    ]
    supply_width: Key[float, _width("supply")]
    return_width: Key[float, _width("return")]
    supply_centre: Key[
        float | None,
        _angle(
            "the centre of the first supply window (unless given, a quarter of the lobe pitch)",
            '"15 deg"',
            "motor.valve_plate.supply.centre",
        ),
    ] = None
    return_centre: Key[
        float | None,
        _angle(
            "the centre of the first return window (unless given, 3/4 of the lobe pitch)",
            '"45 deg"',
            "motor.valve_plate.return_.centre",
        ),
    ] = None
    shift: Key[
        float,
        _angle("the turn of the whole plate", '"0.5 deg"', "motor.valve_plate.shift"),
    ] = 0.0
    notch_angle: Key[
        float | None,
        Number(
            "the angle from a relief notch's tip to the port's opening edge",
            '"1.5 deg"',
            unit="rad",
            low=1e-5,
            high=FULL_TURN,
            leaves=("motor.valve_plate.notch.angle",),
        ),
    ] = None
    notch_area: Key[
        float | None,
        Number(
            "the relief notch's share of the port area",
            "0.03",
            high=1.0,
            leaves=("motor.valve_plate.notch.area",),
        ),
    ] = None


class GapTable(Table):
    """[motor.gap]: the gap between piston and bore."""

    clearance: Key[
        float,
        Number(
            "the radial clearance of piston in bore",
            '"15 um"',
            unit="m",
            low=1e-8,
            high=0.01,
            leaves=("motor.gap.clearance",),
        ),
    ]
    length: Key[float, _length("the length of the gap", '"30 mm"', "motor.gap.length", 1e-5)]
    eccentricity: Key[
        float,
        Number(
            "the piston's eccentricity over the clearance",
            "0.5",
            high=1.0,
            leaves=("motor.gap.eccentricity",),
        ),
    ] = 0.0


class MotorTable(Table):
    """[motor]"""

    name: Key[str, Text("a name for the motor", '"Wheel motor"')] = ""
    pistons: Key[int, Count("the number of pistons", "8", high=200)]
    lobes: Key[int, Count("the number of lobes", "6", high=100)]
    bore: Key[float, _length("the cylinders' bore", '"30 mm"', "motor.piston.bore", 1e-4)]
    piston_mass: Key[
        float,
        Number(
            "the mass of a piston with its roller",
            '"0.24 kg"',
            unit="kg",
            low=1e-9,
            high=1e4,
            leaves=("motor.piston.mass",),
        ),
    ]
    dead_volume: Key[
        float,
        Number(
            "a chamber's volume at lift zero",
            '"6 cm^3"',
            unit="m^3",
            low=1e-12,
            high=10.0,
            leaves=("motor.dead_volume",),
        ),
    ]
    cam: CamTable
    roller: RollerTable
    valve_plate: ValvePlateTable
    gap: GapTable | None = None


class FluidTable(Table):
    """[fluid]: an oil by its name; the keys of the law follow below."""

    oil: Key[
        str | None,
        Word("an oil whose data stand for the keys that are not given", '"ISO VG 46"', words=OILS),
    ] = None
    temperature: Key[
        float | None,
        Number("the oil's temperature", '"50 degC"', unit="K", low=230.0, high=420.0),
    ] = None


def _pressure(meaning: str, example: str, low: float = 0.0) -> Number:
    return Number(meaning, example, unit="Pa", low=low, high=1e9)


class OperatingPointTable(Table):
    """[[operating_points]]"""

    speed: Key[float, Number("the shaft speed", '"100 rpm"', unit="rad/s", low=1e-4, high=1e4)]
    supply_pressure: Key[float, _pressure("the absolute supply pressure", '"250 bar"')]
    return_pressure: Key[float, _pressure("the absolute return pressure", '"10 bar"')]
    case_pressure: Key[
        float | None,
        _pressure("the absolute case pressure (unless given, the return pressure)", '"2 bar"'),
    ] = None
    weight: Key[float, Number("the weight of this point in the objective", "1", high=1e6)] = 1.0


def _weight(meaning: str, example: str) -> Number:
    return Number(f"the weight of {meaning}", example, high=1e6)


class ObjectiveTable(Table):
    """[objective]: the weights of model.md section 8."""

    torque_ripple: Key[float, _weight("squared torque ripple", "10")] = 10.0
    pressure_ripple: Key[float, _weight("squared pressure ripple", "0.02")] = 0.02
    efficiency: Key[float, _weight("one minus efficiency", "1")] = 1.0
    spectrum: Key[float, _weight("the spectral sum", "1")] = 1.0
    jerk: Key[float, _weight("the mean squared jerk", "0.02")] = 0.02
    spectral_pressure: Key[float, _weight("pressure in the spectral sum", "0.01")] = 0.01
    spectral_torque: Key[float, _weight("torque in the spectral sum", "1")] = 1.0
    penalty: Key[float, Number("the factor of squared violations", "100", high=1e9)] = 100.0
    harmonics: Key[
        int, Count("the number of shaft orders in ripples and sums", "600", high=20000)
    ] = 600


def _limit(
    meaning: str, example: str, unit: str = "1", low: float = 0.0, high: float = 1e12
) -> Number:
    return Number(f"the limit of {meaning}", example, unit=unit, low=low, high=high)


class ConstraintsTable(Table):
    """[constraints]: results with their sense; a limit that is not given is none."""

    min_pressure: Key[
        float | None,
        _pressure("the least chamber pressure (unless given, the vapour pressure)", '"3 kPa"'),
    ] = None
    max_pressure: Key[float | None, _pressure("the greatest chamber pressure", '"300 bar"', 1)] = (
        None
    )
    max_contact_stress: Key[
        float | None, _limit("Hertzian contact stress", '"1.8 GPa"', "Pa", 1.0)
    ] = None
    min_contact_force: Key[
        float | None, _limit("the force of roller on ring", '"0 N"', "N", -1e9)
    ] = None
    max_pressure_angle: Key[
        float | None, _limit("the pressure angle", '"30 deg"', "rad", 1e-6, FULL_TURN / 4)
    ] = None
    min_undercut_factor: Key[
        float | None, _limit("the undercut factor", "0.25", low=-10.0, high=10.0)
    ] = None
    max_velocity: Key[float | None, _limit("piston speed", '"2 m/s"', "m/s", 1e-9)] = None
    max_acceleration: Key[
        float | None, _limit("piston acceleration", '"500 m/s^2"', "m/s^2", 1e-9)
    ] = None
    max_jerk: Key[float | None, _limit("piston jerk", '"1e5 m/s^3"', "m/s^3", 1e-9)] = None
    min_damping_ratio: Key[float | None, _limit("the damping ratio", "0.001", high=10.0)] = None
    min_mean_torque: Key[float | None, _limit("the mean torque", '"1.5 kN*m"', "N*m", -1e9)] = None
    displacement: Key[
        tuple[float, float] | None,
        band(_limit("the volume per revolution", '"400 cm^3"', "m^3", 0.0, 1e3)),
    ] = None
    stroke: Key[
        tuple[float, float] | None, band(_limit("the stroke", '"12 mm"', "m", 0.0, 100.0))
    ] = None
    lift: Key[
        tuple[float, float] | None, band(_limit("the lift", '"12 mm"', "m", -100.0, 100.0))
    ] = None


class SearchTable(Table):
    """[search]"""

    budget: Key[int, Count("the number of model evaluations", "300", high=1_000_000)] = 300
    seed: Key[int, Count("the number all chance comes from", "0", low=0, high=2**31)] = 0


class FileTables(Table):
    """The whole file; `design_space` is read by `design.py` once the motor stands."""

    motor: MotorTable
    fluid: FluidTable
    operating_points: list[OperatingPointTable]
    objective: ObjectiveTable = ObjectiveTable()
    constraints: ConstraintsTable = ConstraintsTable()
    design_space: dict[str, Any] | None = None
    search: SearchTable = SearchTable()


__all__ = [
    "MOST_POINTS",
    "Band",
    "CamTable",
    "ConstraintsTable",
    "FileTables",
    "FluidTable",
    "GapTable",
    "MotorTable",
    "ObjectiveTable",
    "OperatingPointTable",
    "PlanarCamTable",
    "RadialCamTable",
    "RollerTable",
    "SearchTable",
    "Table",
    "ValvePlateTable",
]

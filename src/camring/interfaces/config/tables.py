"""The tables of a motor file: every key, its unit, its limits and the leaf it becomes.

Each field is one key. Keys that belong to an exchangeable law (the oil's, the
orifice's, the window's, ...) are not here: `laws.py` reads them off the law's
own class. Units are those in which the program keeps the number.
"""

from typing import Annotated as Key
from typing import Any

from camring.interfaces.config.entries import (
    Band,
    Count,
    Number,
    NumberOrWord,
    Numbers,
    Text,
    Word,
)
from camring.interfaces.config.evaluator_table import EvaluatorTable
from camring.interfaces.config.goal_tables import ConstraintsTable, ObjectiveTable, SearchTable
from camring.interfaces.config.table import FULL_TURN, Table, pressure_entry
from camring.physics.oils import OILS

MOST_POINTS = 50  # operating points in one file
LARGEST_PART = 2.0  # m; a bare 30 that should have been "30 mm" is told
LARGEST_RADIUS = 10.0  # m, of a ring


def _length(meaning: str, example: str, leaf: str, low: float = 1e-6) -> Number:
    return Number(meaning, example, unit="m", low=low, high=LARGEST_PART, leaves=(leaf,))


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
            high=LARGEST_RADIUS,
            words=("minimum", "mean"),
            leaves=("motor.given_reference_radius",),
        ),
    ] = "minimum"
    degree: Key[int, Count("the degree of the spline", "3", low=3, high=5)] = 3
    elastic_modulus: Key[float, _modulus("motor.ring_material.elastic_modulus")]
    poisson_ratio: Key[float, _poisson("motor.ring_material.poisson_ratio")]


CONTROL_RADIUS = Number("a control radius", '"90 mm"', unit="m", low=1e-4, high=LARGEST_RADIUS)
COORDINATE = Number("a coordinate", '"90 mm"', unit="m", low=-LARGEST_RADIUS, high=LARGEST_RADIUS)


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


class ManifoldTable(Table):
    """[motor.manifold]: the gallery before the supply windows, and the line that feeds it."""

    supply_volume: Key[
        float,
        Number(
            "the oil volume common to all supply windows",
            '"200 cm^3"',
            unit="m^3",
            low=1e-9,
            high=100.0,
            leaves=("motor.manifold.volume",),
        ),
    ]
    line_conductance: Key[
        float,
        Number(
            "the volume flow through the feeding line for each unit of pressure drop",
            '"40 L/min/bar"',
            unit="m^3/s/Pa",
            low=1e-14,
            high=1e3,
            leaves=("motor.manifold.line_conductance",),
        ),
    ]


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
    manifold: ManifoldTable | None = None


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


class OperatingPointTable(Table):
    """[[operating_points]]"""

    speed: Key[float, Number("the shaft speed", '"100 rpm"', unit="rad/s", low=1e-4, high=1e4)]
    supply_pressure: Key[float, pressure_entry("the absolute supply pressure", '"250 bar"')]
    return_pressure: Key[float, pressure_entry("the absolute return pressure", '"10 bar"')]
    case_pressure: Key[
        float | None,
        pressure_entry("the absolute case pressure (unless given, the return pressure)", '"2 bar"'),
    ] = None
    weight: Key[float, Number("the weight of this point in the objective", "1", high=1e6)] = 1.0
    rotation: Key[
        str,
        Word(
            "which way the shaft turns; backwards the ports are exchanged",
            '"forward"',
            words=("forward", "reverse"),
        ),
    ] = "forward"


class FileTables(Table):
    """The whole file; `design_space` is read by `design.py` once the motor stands, `tolerances`
    by `tolerances.py`."""

    motor: MotorTable
    fluid: FluidTable
    operating_points: list[OperatingPointTable]
    objective: ObjectiveTable = ObjectiveTable()
    constraints: ConstraintsTable = ConstraintsTable()
    design_space: dict[str, Any] | None = None
    tolerances: dict[str, Any] | None = None
    search: SearchTable = SearchTable()
    evaluator: EvaluatorTable | None = None


__all__ = [
    "MOST_POINTS",
    "Band",
    "CamTable",
    "ConstraintsTable",
    "EvaluatorTable",
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

"""The tables of a motor file: every key, its unit, its limits and the leaf it becomes.

Each field is one key. Keys that belong to an exchangeable law (the oil's, the
orifice's, the window's, ...) are not here: `laws.py` reads them off the law's
own class. Units are those in which the program keeps the number.
"""

from typing import Annotated as Key
from typing import Any

from camring.files.motor.entries import Band, Count, Number, Text, Word
from camring.files.motor.envelope import EnvelopeTable
from camring.files.motor.evaluator_table import EvaluatorTable
from camring.files.motor.goal_tables import ConstraintsTable, ObjectiveTable, SearchTable
from camring.files.motor.table import (
    Table,
    length,
    modulus,
    part,
    poisson,
    pressure_entry,
    unit_of,
    usual,
)
from camring.files.shapes.cam_tables import CamTable, PlanarCamTable, RadialCamTable
from camring.files.shapes.plate_table import ValvePlateTable
from camring.physics.oil.presets import OILS
from camring.physics.operating_point import OperatingPoint

MOST_POINTS = 50  # operating points in one file


class RollerTable(Table):
    """[motor.roller]"""

    radius: Key[float, length("motor.roller.radius", "the roller's radius", '"12 mm"')]
    length: Key[float, length("motor.roller.length", "the length of line contact", '"28 mm"')]
    elastic_modulus: Key[float, modulus("motor.roller.material.elastic_modulus")]
    poisson_ratio: Key[float, poisson("motor.roller.material.poisson_ratio")]


class PistonTable(Table):
    """[motor.piston]: the spring behind it."""

    spring_rate: Key[
        float, part("motor.piston.spring.rate", "the return spring's rate", '"8 N/mm"', high=1e9)
    ]
    spring_preload: Key[
        float,
        part(
            "motor.piston.spring.preload",
            "the return spring's force at the inner dead centre",
            '"150 N"',
            high=1e7,
        ),
    ]


class GapTable(Table):
    """[motor.gap]: the gap between piston and bore."""

    clearance: Key[
        float,
        part(
            "motor.gap.clearance", "the radial clearance of piston in bore", '"15 um"', 1e-8, 0.01
        ),
    ]
    length: Key[float, length("motor.gap.length", "the length of the gap", '"30 mm"', 1e-5)]
    eccentricity: Key[
        float,
        part(
            "motor.gap.eccentricity",
            "the piston's eccentricity over the clearance",
            "0.5",
            high=1.0,
        ),
    ] = usual("motor.gap.eccentricity")


def _manifold_volume(place: str, windows: str) -> Number:
    meaning = f"the oil volume common to all {windows} windows"
    return part(f"{place}.volume", meaning, '"200 cm^3"', 1e-9, 100.0)


def _conductance(place: str, line: str) -> Number:
    meaning = f"the volume flow through the {line} line for each unit of pressure drop"
    return part(f"{place}.line_conductance", meaning, '"40 L/min/bar"', 1e-14, 1e3)


class ManifoldTable(Table):
    """[motor.manifold]: the manifold before the supply windows, and the line that feeds it."""

    supply_volume: Key[float, _manifold_volume("motor.manifold", "supply")]
    line_conductance: Key[float, _conductance("motor.manifold", "feeding")]


class ReturnManifoldTable(Table):
    """[motor.return_manifold]: the manifold behind the return windows, and its line."""

    return_volume: Key[float, _manifold_volume("motor.return_manifold", "return")]
    line_conductance: Key[float, _conductance("motor.return_manifold", "return")]


class ChurningTable(Table):
    """[motor.churning]: oil in the case that the block drags along."""

    moment_coefficient: Key[
        float,
        part(
            "motor.churning.moment_coefficient",
            "the torque of the block in the case's oil over rho w^2 R^5 / 2",
            "0.05",
            high=100.0,
        ),
    ]
    radius: Key[
        float,
        length(
            "motor.churning.radius", "the radius of the block with its pistons", '"100 mm"', 1e-3
        ),
    ]


class MotorTable(Table):
    """[motor]"""

    name: Key[str, Text("a name for the motor", '"Wheel motor"')] = ""
    pistons: Key[int, Count("the number of pistons", "8", high=200)]
    lobes: Key[int, Count("the number of lobes", "6", high=100)]
    bore: Key[float, length("motor.piston.bore", "the cylinders' bore", '"30 mm"', 1e-4)]
    piston_mass: Key[
        float,
        part("motor.piston.mass", "the mass of a piston with its roller", '"0.24 kg"', 1e-9, 1e4),
    ]
    dead_volume: Key[
        float, part("motor.dead_volume", "a chamber's volume at lift zero", '"6 cm^3"', 1e-12, 10.0)
    ]
    cam: CamTable
    roller: RollerTable
    valve_plate: ValvePlateTable
    piston: PistonTable | None = None
    gap: GapTable | None = None
    manifold: ManifoldTable | None = None
    return_manifold: ReturnManifoldTable | None = None
    modes: dict[str, Any] | None = None
    churning: ChurningTable | None = None

    def manifolds(self) -> list[str]:
        """Names of the tables that put a volume at the windows."""
        given = {"manifold": self.manifold, "return_manifold": self.return_manifold}
        return [f"[motor.{name}]" for name, table in given.items() if table is not None]


class FluidTable(Table):
    """[fluid]: an oil by its name; the keys of the law follow below."""

    oil: Key[
        str | None,
        Word("an oil whose data stand for the keys that are not given", '"ISO VG 46"', words=OILS),
    ] = None
    temperature: Key[
        float | None, Number("the oil's temperature", '"50 degC"', unit="K", low=230.0, high=420.0)
    ] = None


class ThermalTable(Table):
    """[thermal]: the heat balance of case and films."""

    inlet_temperature: Key[
        float | None,
        Number(
            "the temperature of the oil that comes in (unless given, that of [fluid])",
            '"50 degC"',
            unit="K",
            low=230.0,
            high=420.0,
        ),
    ] = None
    ambient_temperature: Key[
        float,
        part(
            "motor.thermal.ambient_temperature",
            "the temperature around the motor",
            '"20 degC"',
            200.0,
            400.0,
        ),
    ]
    heat_transfer: Key[
        float,
        part(
            "motor.thermal.heat_transfer",
            "the heat that the whole surface gives off for each degree above its surroundings",
            '"12 W/K"',
            high=1e6,
        ),
    ]
    specific_heat: Key[
        float,
        part(
            "motor.thermal.specific_heat",
            "the specific heat of the oil",
            '"1.9 kJ/(kg*K)"',
            100.0,
            1e5,
        ),
    ] = usual("motor.thermal.specific_heat")


class OperatingPointTable(Table):
    """[[operating_points]]"""

    speed: Key[
        float,
        Number(
            "the shaft speed",
            '"100 rpm"',
            unit=unit_of(OperatingPoint, "shaft_speed"),
            low=1e-4,
            high=1e4,
        ),
    ]
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
    mode: Key[
        str | None,
        Text(
            "the name of the mode in [motor.modes] it runs in (unless given, all lobes)", '"half"'
        ),
    ] = None


class FileTables(Table):
    """The whole file; `design_space` is read by `design.py` once the motor stands, `tolerances`
    by `tolerances.py`."""

    motor: MotorTable
    fluid: FluidTable
    thermal: ThermalTable | None = None
    operating_points: list[OperatingPointTable]
    envelope: EnvelopeTable | None = None
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
    "ChurningTable",
    "ConstraintsTable",
    "EnvelopeTable",
    "EvaluatorTable",
    "FileTables",
    "FluidTable",
    "GapTable",
    "MotorTable",
    "ObjectiveTable",
    "OperatingPointTable",
    "PistonTable",
    "PlanarCamTable",
    "RadialCamTable",
    "ReturnManifoldTable",
    "RollerTable",
    "SearchTable",
    "Table",
    "ThermalTable",
    "ValvePlateTable",
]

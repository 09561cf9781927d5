"""From validated tables to the nouns of the program."""

from dataclasses import replace
from math import nan, pi
from typing import Any, Literal, TypeVar

import numpy as np

from camring.files.modes import idle_lobes_of, modes_of
from camring.files.motor.entries import Entry
from camring.files.motor.keys import Choices
from camring.files.motor.laws import SLOTS, Slot, law_keys
from camring.files.motor.tables import (
    CamTable,
    FileTables,
    OperatingPointTable,
    PlanarCamTable,
    RadialCamTable,
    RollerTable,
    Table,
)
from camring.geometry.cam import AbstractCam, PlanarCam, RadialCam
from camring.geometry.material import Material
from camring.geometry.notch import ReliefNotch
from camring.geometry.piston import Piston, ReturnSpring, Roller
from camring.geometry.sampling import from_first
from camring.geometry.valve_plate import Port, ValvePlate
from camring.numerics.quantity import real
from camring.physics.gap import PistonGap, PlateGap
from camring.physics.heat.thermal import Thermal
from camring.physics.manifold.manifold import Manifold
from camring.physics.motor import Motor
from camring.physics.oil.churning import Churning
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.oil.viscosity_line import ViscosityLine
from camring.physics.operating_point import OperatingPoint
from camring.physics.system import System

Noun = TypeVar("Noun")


def build_system(tables: FileTables, choices: Choices) -> System:
    """Motor, oil and operating points of a file."""
    laws = {slot.leaf: _law(tables, slot, choices.chosen(slot)) for slot in SLOTS}
    motor = tables.motor
    rule, given = _reference(motor.cam)
    modes = modes_of(motor.modes or {}, motor.lobes)
    return System(
        motor=Motor(
            cam=_cam(motor.cam, motor.lobes),
            piston=Piston(
                real(motor.bore),
                real(motor.piston_mass),
                _part(ReturnSpring, "motor.piston.spring", motor.piston),
            ),
            roller=Roller(
                radius=real(motor.roller.radius),
                length=real(motor.roller.length),
                material=_material("motor.roller.material", motor.roller),
            ),
            ring_material=_material("motor.ring_material", motor.cam),
            valve_plate=_valve_plate(tables, laws["motor.valve_plate.window"]),
            dead_volume=real(motor.dead_volume),
            orifice=laws["motor.orifice"],
            leakage=laws["motor.leakage"],
            friction=laws["motor.friction"],
            gap=_part(PistonGap, "motor.gap", motor.gap),
            manifold=_part(Manifold, "motor.manifold", motor.manifold),
            return_manifold=_part(Manifold, "motor.return_manifold", motor.return_manifold),
            plate_gap=_part(PlateGap, "motor.plate_gap", motor.valve_plate),
            thermal=_part(Thermal, "motor.thermal", tables.thermal),
            churning=_part(Churning, "motor.churning", motor.churning),
            given_reference_radius=real(given),
            reference=rule,
            pistons=motor.pistons,
            lobes=motor.lobes,
            name=motor.name,
        ),
        fluid=_fluid(tables, laws["fluid"]),
        operating_points=tuple(
            _operating_point(point, idle_lobes_of(modes, point.mode, place))
            for place, point in enumerate(tables.operating_points)
        ),
    )


def _law(tables: FileTables, slot: Slot, law: type) -> Any:
    values = {}
    for name, (path, _, _) in law_keys(slot, law).items():
        here: Any = tables
        for part in path.split("."):
            here = getattr(here, part)
        values[name] = here
    return law(**values)


def _reference(cam: CamTable) -> tuple[Literal["minimum", "mean", "given"], float]:
    if isinstance(cam.reference_radius, float):
        return "given", cam.reference_radius
    return ("mean" if cam.reference_radius == "mean" else "minimum"), nan


def _part(noun: type[Noun], place: str, table: Table | None) -> Noun | None:
    """The noun that stands at a place of the `System`, of the numbers that a table has for it.

    None where there is no table, or one that leaves some of them out.
    """
    if table is None:
        return None
    numbers = {}
    for key, field in type(table).model_fields.items():
        for entry in field.metadata:
            for leaf in entry.leaves if isinstance(entry, Entry) else ():
                at, _, name = leaf.rpartition(".")
                if at == place:
                    numbers[name] = getattr(table, key)
    if None in numbers.values():
        return None
    return noun(**{name: real(np.asarray(value, float)) for name, value in numbers.items()})


def _material(place: str, table: RollerTable | CamTable) -> Material:
    found = _part(Material, place, table)
    assert found is not None
    return found


def _cam(cam: CamTable, lobes: int) -> AbstractCam:
    repeats = lobes if cam.symmetry == "lobes" else 1
    if isinstance(cam, PlanarCamTable):
        points = from_first(np.array(cam.control_points), repeats)
        return PlanarCam(control_points=real(points), repeats=repeats, degree=cam.degree)
    assert isinstance(cam, RadialCamTable)
    return RadialCam(
        control_radii=real(np.array(cam.control_radii)), repeats=repeats, degree=cam.degree
    )


def _valve_plate(tables: FileTables, window: Any) -> ValvePlate:
    plate, lobes = tables.motor.valve_plate, tables.motor.lobes
    pitch = 2 * pi / lobes
    supply = pitch / 4 if plate.supply_centre is None else plate.supply_centre
    back = 3 * pitch / 4 if plate.return_centre is None else plate.return_centre
    return ValvePlate(
        port_area=real(plate.port_area),
        supply=_port(plate, "supply", supply),
        return_=_port(plate, "return", back),
        window=window,
        shift=real(plate.shift),
        notch=_part(ReliefNotch, "motor.valve_plate.notch", plate),
        lobes=lobes,
    )


def _port(plate: Any, side: Literal["supply", "return"], centre: float) -> Port:
    """One kind of port, with what the file gives for it alone."""
    leaf = side.replace("return", "return_")
    return Port(
        width=real(getattr(plate, f"{side}_width")),
        centre=real(centre),
        area=getattr(plate, f"{side}_port_area"),
        discharge_coefficient=getattr(plate, f"{side}_discharge_coefficient"),
        ramp=getattr(plate, f"{side}_ramp"),
        notch=_part(ReliefNotch, f"motor.valve_plate.{leaf}.notch", plate),
    )


def _fluid(tables: FileTables, fluid: AbstractFluid) -> AbstractFluid:
    """The oil, which knows how its viscosity goes on where a heat balance asks."""
    name, temperature = tables.fluid.oil, tables.fluid.temperature
    if tables.thermal is None or name is None or temperature is None:
        return fluid
    return replace(fluid, line=ViscosityLine.of_oil(name, temperature))


def _operating_point(point: OperatingPointTable, idle_lobes: tuple[int, ...]) -> OperatingPoint:
    case = point.return_pressure if point.case_pressure is None else point.case_pressure
    return OperatingPoint(
        shaft_speed=real(point.speed),
        supply_pressure=real(point.supply_pressure),
        return_pressure=real(point.return_pressure),
        case_pressure=real(case),
        weight=real(point.weight),
        reverse=point.rotation == "reverse",
        idle_lobes=idle_lobes,
        mode=point.mode or "",
    )

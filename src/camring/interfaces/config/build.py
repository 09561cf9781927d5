"""From validated tables to the nouns of the program."""

from math import nan, pi
from typing import Any, Literal

import numpy as np

from camring.geometry.cam import AbstractCam, PlanarCam, RadialCam
from camring.geometry.material import Material
from camring.geometry.notch import ReliefNotch
from camring.geometry.piston import Piston, Roller
from camring.geometry.sampling import from_first
from camring.geometry.valve_plate import Port, ValvePlate
from camring.interfaces.config.keys import Choices
from camring.interfaces.config.laws import SLOTS, Slot, law_keys
from camring.interfaces.config.tables import (
    CamTable,
    FileTables,
    GapTable,
    ManifoldTable,
    OperatingPointTable,
    PlanarCamTable,
    RadialCamTable,
    RollerTable,
    ValvePlateTable,
)
from camring.numerics.quantity import real
from camring.physics.gallery import Manifold
from camring.physics.gap import PistonGap
from camring.physics.motor import Motor
from camring.physics.operating_point import OperatingPoint
from camring.physics.system import System


def build_system(tables: FileTables, choices: Choices) -> System:
    """Motor, oil and operating points of a file."""
    laws = {slot.leaf: _law(tables, slot, choices.chosen(slot)) for slot in SLOTS}
    motor = tables.motor
    rule, given = _reference(motor.cam)
    return System(
        motor=Motor(
            cam=_cam(motor.cam, motor.lobes),
            piston=Piston(bore=real(motor.bore), mass=real(motor.piston_mass)),
            roller=Roller(
                radius=real(motor.roller.radius),
                length=real(motor.roller.length),
                material=_material(motor.roller),
            ),
            ring_material=_material(motor.cam),
            valve_plate=_valve_plate(tables, laws["motor.valve_plate.window"]),
            dead_volume=real(motor.dead_volume),
            orifice=laws["motor.orifice"],
            leakage=laws["motor.leakage"],
            friction=laws["motor.friction"],
            gap=_gap(motor.gap),
            manifold=_manifold(motor.manifold),
            given_reference_radius=real(given),
            reference=rule,
            pistons=motor.pistons,
            lobes=motor.lobes,
            name=motor.name,
        ),
        fluid=laws["fluid"],
        operating_points=tuple(_operating_point(point) for point in tables.operating_points),
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


def _material(table: RollerTable | CamTable) -> Material:
    return Material(real(table.elastic_modulus), real(table.poisson_ratio))


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
        supply=Port(width=real(plate.supply_width), centre=real(supply)),
        return_=Port(width=real(plate.return_width), centre=real(back)),
        window=window,
        shift=real(plate.shift),
        notch=_notch(plate),
        lobes=lobes,
    )


def _notch(plate: ValvePlateTable) -> ReliefNotch | None:
    if plate.notch_angle is None or plate.notch_area is None:
        return None
    return ReliefNotch(angle=real(plate.notch_angle), area=real(plate.notch_area))


def _gap(gap: GapTable | None) -> PistonGap | None:
    if gap is None:
        return None
    return PistonGap(real(gap.clearance), real(gap.length), real(gap.eccentricity))


def _manifold(manifold: ManifoldTable | None) -> Manifold | None:
    if manifold is None:
        return None
    return Manifold(real(manifold.supply_volume), real(manifold.line_conductance))


def _operating_point(point: OperatingPointTable) -> OperatingPoint:
    case = point.return_pressure if point.case_pressure is None else point.case_pressure
    return OperatingPoint(
        shaft_speed=real(point.speed),
        supply_pressure=real(point.supply_pressure),
        return_pressure=real(point.return_pressure),
        case_pressure=real(case),
        weight=real(point.weight),
        reverse=point.rotation == "reverse",
    )

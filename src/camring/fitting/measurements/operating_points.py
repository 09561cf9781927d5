"""Operating point and oil of each measured row; what a row does not say the motor file does."""

import numpy as np

from camring.files.errors import InputError
from camring.files.motor import MotorFile
from camring.files.motor.build import build_system
from camring.files.motor.document import at_temperature
from camring.files.motor.entries import Number, Unfit
from camring.files.motor.keys import key_map
from camring.files.motor.motor_file import validated
from camring.fitting.measurements.table import MeasuredTable
from camring.fitting.measurements.temperatures import OIL_TEMPERATURE as TEMPERATURE
from camring.numerics.quantity import real
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint


def operating_points_of(
    file: MotorFile, table: MeasuredTable
) -> list[tuple[OperatingPoint, AbstractFluid]]:
    """One for each row.

    Return and case pressure that the table does not give are those of the file's first
    operating point; the oil's temperature is the file's.

    Raises
    ------
    InputError
        For a value outside its key's limits, a supply pressure that is the return's, or
        temperatures where no oil is named. A supply below the return's is a machine that brakes.
    """
    return [(_point(file, table, row), _fluid(file, table, row)) for row in range(len(table.lines))]


def _point(file: MotorFile, table: MeasuredTable, row: int) -> OperatingPoint:
    first = file.system.operating_points[0]
    back = _given(table, "return_pressure", row, float(first.return_pressure))
    case = _given(table, "case_pressure", row, float(first.case_pressure))
    if "pressure_drop" in table.conditions:
        supply = back + float(table.conditions["pressure_drop"][row])
    else:
        supply = float(table.conditions["supply_pressure"][row])
    speed = float(table.conditions["shaft_speed"][row])
    entries = key_map(file.choices)
    for name, key, value in (
        ("shaft_speed", "speed", speed),
        ("supply_pressure", "supply_pressure", supply),
        ("return_pressure", "return_pressure", back),
        ("case_pressure", "case_pressure", case),
    ):
        entry = entries[f"operating_points.{key}"]
        assert isinstance(entry, Number)
        try:
            entry.read(value)
        except Unfit as error:
            raise InputError(
                table.where(row, name), f"{error.problem}, in {entry.unit}", error.way_out
            ) from None
    if supply == back:
        raise InputError(
            table.where(row, "supply_pressure"),
            f"is {supply / 1e5:.4g} bar, the return pressure itself",
            "give both absolute, or write gauge into their units: [bar gauge]",
        )
    return OperatingPoint(real(speed), real(supply), real(back), real(case))


def _given(table: MeasuredTable, name: str, row: int, otherwise: float) -> float:
    if name not in table.conditions or np.isnan(table.conditions[name][row]):
        return otherwise
    return float(table.conditions[name][row])


def _fluid(file: MotorFile, table: MeasuredTable, row: int) -> AbstractFluid:
    if TEMPERATURE not in table.conditions:
        return file.system.fluid
    if "oil" not in file.document["fluid"]:
        raise InputError(
            f"{table.path}, oil temperature,",
            f"has no effect while {file.path.name} names no oil",
            'name it, oil = "ISO VG 46" in [fluid], or write the name of that column in brackets',
        )
    kelvin = table.conditions[TEMPERATURE][row]
    if np.isnan(kelvin):
        return file.system.fluid
    try:
        choices, tables = validated(at_temperature(file.document, f"{float(kelvin)!r} K"))
    except InputError as error:
        raise InputError(table.where(row, TEMPERATURE), error.problem, error.way_out) from None
    return build_system(tables, choices).fluid

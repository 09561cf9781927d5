"""One convention for every CSV file: read by pandas, by Octave, and with decimal commas."""

import csv
import io
from math import inf, nan
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas
import pytest
from motor_files import SOUND

import camring
from camring.cli.app import COMMANDS
from camring.files.csv_table import Decimal, csv_table, named
from camring.files.errors import InputError
from camring.files.motor import parse_motor_file
from camring.files.result_names import quantity, result_names
from camring.fitting.measurements.table import parse_measured_table
from camring.presentation.pareto import csv_text as front_csv

HEAD = ["point", named("chamber_pressure", "bar"), named("displacement", "cm³/rev"), "says"]
ROWS = [[1, 250.125, "400.4", ""], [2, nan, "-1.5e-3", "lifts off, #3; twice"], [3, inf, "0", "ü"]]
REMARKS = ["Waveforms of a motor,\nwith air", "written by camring"]


def read_as_octave(text, remarks, separator=",", decimal="."):
    """As dlmread(file, separator, remarks + 1, 0): numbers, and zero where there is a text."""

    def number(cell):
        try:
            return float(cell.replace(decimal, "."))
        except ValueError:
            return 0.0

    lines = text.splitlines()[remarks + 1 :]
    return np.array([[number(cell) for cell in line.split(separator)[:3]] for line in lines])


def test_pandas_reads_one_header_with_units_and_numbers_as_numbers():
    frame = pandas.read_csv(io.StringIO(csv_table(HEAD, ROWS, remarks=REMARKS)), comment="#")
    assert list(frame.columns) == [
        "point", "chamber_pressure [bar]", "displacement [cm^3/rev]", "says"
    ]  # fmt: skip
    assert len(frame) == 3
    np.testing.assert_array_equal(frame["chamber_pressure [bar]"], [250.125, nan, nan])
    np.testing.assert_array_equal(frame["displacement [cm^3/rev]"], [400.4, -1.5e-3, 0])
    assert frame["says"][1] == "lifts off, No. 3; twice"


def test_octave_reads_the_numbers_below_remarks_and_header():
    expected = [[1, 250.125, 400.4], [2, nan, -1.5e-3], [3, nan, 0]]
    plain = csv_table(HEAD, ROWS, remarks=REMARKS)
    np.testing.assert_array_equal(read_as_octave(plain, 2), expected)


def test_a_spreadsheet_with_decimal_commas_reads_the_same():
    text = csv_table(HEAD, ROWS, remarks=REMARKS, decimal=Decimal.COMMA)
    frame = pandas.read_csv(io.StringIO(text), comment="#", sep=";", decimal=",")
    plain = pandas.read_csv(io.StringIO(csv_table(HEAD, ROWS, remarks=REMARKS)), comment="#")
    pandas.testing.assert_frame_equal(frame, plain)
    assert "." not in text.splitlines()[3]
    assert "250,125;400,4" in text


def test_units_are_plain_letters_and_none_of_a_plain_number():
    assert named("ripple", "%") == "ripple [%]"
    assert named("mean_torque", "N·m") == "mean_torque [N.m]"
    assert [named("x", each) for each in ("", "1", "-")] == ["x"] * 3
    assert named("angle", "°").isascii()


def test_every_row_has_as_many_cells_as_the_header():
    rows = list(csv.reader(csv_table(HEAD, ROWS).splitlines()))
    assert {len(row) for row in rows} == {len(HEAD)}


def test_no_other_module_writes_csv():
    """So that a new table cannot begin a convention of its own."""
    writers = [
        path.name
        for path in Path(camring.__file__).parent.rglob("*.py")
        if "csv.writer" in path.read_text(encoding="utf-8")
    ]
    assert writers == ["csv_table.py"]


@pytest.mark.parametrize(
    "name", ["map", "sweep", "simulate", "tolerance", "robust", "pareto", "layouts", "export"]
)
def test_every_command_that_writes_csv_takes_the_decimal_sign(name):
    import inspect
    from importlib import import_module

    assert name in COMMANDS
    command = getattr(import_module(f"camring.cli.{name}"), name)
    assert inspect.signature(command).parameters["decimal"].default == Decimal.POINT


def test_a_front_says_the_unit_of_every_variable_and_result():
    file = parse_motor_file(SOUND)
    names = ("torque_ripple", "efficiency")
    results = [dict.fromkeys(result_names(), 0.5) for _ in file.system.operating_points]
    each = SimpleNamespace(
        values=np.array([0.01, 0.9]),
        point=np.full(file.design_space.dimension, 0.5),
        outcome=SimpleNamespace(results=results),
    )
    front = SimpleNamespace(file=file, names=names, compromises=[each, each])
    frame = pandas.read_csv(io.StringIO(front_csv(front)), comment="#")
    assert list(frame.columns[:3]) == ["design", "torque_ripple [%]", "efficiency [%]"]
    np.testing.assert_allclose(frame["efficiency [%]"], [90, 90])
    assert "motor.valve_plate.shift [rad]" in frame.columns
    assert "mean_torque.1 [N.m]" in frame.columns
    assert not any("[SI]" in name for name in frame.columns)
    modes = [name for name in frame.columns[3:] if "mode" in name]
    assert all(name.endswith(" [m]") for name in modes)


def written_table(decimal):
    """What `camring map` writes: speed and pressure, every result, why there is none."""
    names = result_names()
    head = [
        named("operating_points.speed", "rpm"),
        named("operating_points.supply_pressure", "bar"),
        *(named(name, quantity(name).unit) for name in names),
        "fault",
    ]
    rows = [
        [speed, bar, *(0.01 * k + bar / 7000 for k, _ in enumerate(names)), ""]
        for speed in (20.0, 60.5)
        for bar in (100.0, 200.0)
    ]
    return csv_table(head, rows, decimal=decimal), names


@pytest.mark.parametrize("decimal", list(Decimal))
def test_fit_reads_a_table_of_our_own_and_counts_each_measurement_once(decimal):
    text, names = written_table(decimal)
    found = parse_measured_table(text)
    assert set(found.values) == {"mean_torque", "supply_flow", "case_drain"}
    place = list(names).index("mean_torque")
    torque = quantity("mean_torque").factor * found.values["mean_torque"]
    np.testing.assert_allclose(torque[:2], 0.01 * place + np.array([100, 200]) / 7000)
    np.testing.assert_allclose(found.conditions["supply_pressure"][:2], [1e7, 2e7])
    assert found.notes == (
        "The table is one that camring wrote; of its results are fitted: mean torque, supply flow, "
        "case drain.",
    )


def test_waveforms_are_no_measured_rows_and_that_is_said():
    text = csv_table(
        ["operating_point", named("angle", "deg"), named("torque", "N m")], [[1, 0, 5]]
    )
    with pytest.raises(InputError, match=r"column 2, is .angle \[deg\]., which is nothing"):
        parse_measured_table(text)

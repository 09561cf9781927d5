"""The same waveforms and results in every kind of file, read by other programs."""

import csv
import zipfile

import numpy as np
import openpyxl
import pandas
import pytest
import xarray
from scipy.io import loadmat

from camring.exchange.waveforms.file import RESULT, waveform_dataset, write_simulation
from camring.exchange.waveforms.units import EVERYDAY, everyday_result, result_units, spelt_out
from camring.files.errors import InputError

SAMPLES = 360
RESULTS = [
    dict(mean_torque=1500.0, torque_ripple=0.08, supply_flow=2e-3, min_lift=0.001, stroke=0.0118),
    dict(mean_torque=-2100.0, torque_ripple=0.07, supply_flow=1e-3, min_lift=0.001, stroke=0.0118),
]
for powers, each in zip(((9e3, 8e3), (-9e3, -1e4)), RESULTS, strict=True):
    each["input_power"], each["output_power"] = powers


@pytest.fixture(scope="module")
def files(simulated, tmp_path_factory):
    folder = tmp_path_factory.mktemp("kinds")
    for ending in ("nc", "csv", "xlsx", "mat"):
        write_simulation(folder / f"out.{ending}", *simulated, RESULTS, samples=SAMPLES)
    return folder


@pytest.fixture(scope="module")
def dataset(simulated):
    return waveform_dataset(*simulated, samples=SAMPLES, results=RESULTS)


def test_a_dataset_says_what_the_machine_works_as(dataset):
    assert dataset.attrs["operating_mode"] == "motor, pump"


def waves(dataset):
    return [name for name in dataset.data_vars if not name.startswith(RESULT)]


def test_netcdf_has_the_results_with_their_units(files, dataset):
    with xarray.open_dataset(files / "out.nc") as opened:
        np.testing.assert_array_equal(opened[RESULT + "supply_flow"], [2e-3, 1e-3])
        assert opened[RESULT + "supply_flow"].attrs["units"] == "m3 s-1"
        assert opened["supply_flow"].dims == ("operating_point", "angle")
        assert "anticlockwise" in opened.attrs["comment"]


def parted(frame):
    """The units of the columns by name; the columns are then called by their names alone."""
    heads = [each.rstrip("]").partition(" [") for each in frame.columns]
    frame.columns = [name for name, _, _ in heads]
    return {name: unit for name, _, unit in heads}


def test_csv_has_names_units_and_a_row_for_every_angle(files, dataset):
    frame = pandas.read_csv(files / "out.csv", comment="#")
    assert len(frame) == 2 * SAMPLES
    units = parted(frame)
    assert units["chamber_pressure"] == "bar"
    assert units["angle"] == "deg"
    np.testing.assert_allclose(frame["angle"][:SAMPLES], np.degrees(dataset.angle), atol=1e-6)
    for name in waves(dataset):
        assert units[name] == EVERYDAY[name].unit
        found = frame[name].to_numpy().reshape(2, SAMPLES)
        np.testing.assert_allclose(found, EVERYDAY[name].factor * dataset[name], rtol=1e-8)
    text = (files / "out.csv").read_text()
    assert "anticlockwise" in text
    assert "camring" in text


def test_the_results_of_a_csv_stand_beside_it(files):
    frame = pandas.read_csv(files / "out_results.csv", comment="#")
    units = parted(frame)
    assert units["torque_ripple"] == "%"
    np.testing.assert_allclose(frame["torque_ripple"], [8.0, 7.0])
    assert units["min_lift"] == "mm"
    np.testing.assert_allclose(frame["min_lift"], [1.0, 1.0])
    assert units["shaft_speed"] == "rpm"
    assert all(unit.isascii() for unit in units.values())
    with open(files / "out_results.csv") as file:
        rows = [row for row in csv.reader(file) if not row[0].startswith("#")]
    assert len({len(row) for row in rows}) == 1


def test_matlab_finds_si_in_matrices_of_angle_by_point(files, dataset):
    found = loadmat(files / "out.mat", simplify_cells=True)
    np.testing.assert_array_equal(found["angle"], dataset.angle)
    for name in waves(dataset):
        np.testing.assert_array_equal(found[name], dataset[name].to_numpy().T)
        assert found["units"][name] == dataset[name].attrs["units"]
    np.testing.assert_array_equal(found["results"]["supply_flow"], [2e-3, 1e-3])
    assert found["units"]["results"]["mean_torque"] == "N m"
    np.testing.assert_array_equal(found["shaft_speed"], dataset.shaft_speed)
    assert "anticlockwise" in found["about"]


def test_the_workbook_has_a_summary_charts_and_a_sheet_for_each_point(files, dataset):
    book = openpyxl.load_workbook(files / "out.xlsx")
    assert book.sheetnames == ["Summary", "Charts", "Point 1", "Point 2"]
    summary = {row[0]: row[1:] for row in book["Summary"].iter_rows(values_only=True) if row[0]}
    assert summary["Mean torque"] == ("N m", 1500, -2100)
    assert summary["Torque ripple, one-sided"][0] == "%"
    for point, tab in enumerate(book.sheetnames[2:]):
        names, units, *rows = book[tab].iter_rows(values_only=True)
        table = dict(zip(names, np.array(rows, float).T, strict=True))
        assert units[names.index("torque")] == "N m"
        pressure = EVERYDAY["chamber_pressure"].factor * dataset.chamber_pressure[point]
        np.testing.assert_allclose(table["chamber_pressure"], pressure, rtol=1e-12)
    assert len(book["Charts"]._charts) == 6
    # Charts that a spreadsheet draws, of all the rows.
    with zipfile.ZipFile(files / "out.xlsx") as inside:
        chart = inside.read("xl/charts/chart1.xml").decode()
    assert f"'Point 1'!$A$3:$A${SAMPLES + 2}" in chart


def test_a_missing_extra_is_named(simulated, tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "xlsxwriter", None)
    with pytest.raises(InputError, match=r'pip install "camring\[excel\]"'):
        write_simulation(tmp_path / "out.xlsx", *simulated, RESULTS, samples=SAMPLES)
    assert list(tmp_path.iterdir()) == []


def test_units_are_spelt_as_other_programs_read_them():
    assert spelt_out("m3/s") == "m3 s-1"
    assert spelt_out("m/s2") == "m s-2"
    assert spelt_out("N.m") == "N m"
    assert spelt_out("1") == "1"
    assert result_units()["max_jerk"] == "m s-3"
    assert everyday_result("flow_ripple_true_rms", "1").unit == "%"
    assert everyday_result("vapour_margin", "Pa").unit == "bar"

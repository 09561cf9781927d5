"""Measured tables: every way in which a bench writes one, and a sentence for every slip."""

import numpy as np
import pytest
from motor_files import SOUND, with_line

from camring.interfaces.config import parse_motor_file
from camring.interfaces.errors import InputError
from camring.interfaces.measured_duties import duties_of
from camring.interfaces.measured_table import parse_measured_table, read_measured_table

PLAIN = """\
# Bench 3, 12 March
shaft speed [rpm],supply pressure [bar],return pressure [bar],mean torque [Nm],efficiency [%]
60,200,10,1000,91.5
120,250,10,,92

180,300,12,1500,
200,300,12,,-
"""


def test_a_table_is_read_to_si():
    found = parse_measured_table(PLAIN)
    assert found.lines == (3, 4, 6)
    assert found.left_out == 1
    np.testing.assert_allclose(found.duties["shaft_speed"], np.pi * np.array([2, 4, 6]))
    np.testing.assert_allclose(found.duties["supply_pressure"], [2e7, 2.5e7, 3e7])
    np.testing.assert_array_equal(found.values["mean_torque"], [1000, np.nan, 1500])
    np.testing.assert_allclose(found.values["efficiency"], [0.915, 0.92, np.nan])
    assert np.all(np.isnan(found.deviations["efficiency"]))


def test_a_column_without_a_value_is_no_result():
    text = PLAIN.replace("91.5", "").replace("92", "n/a")
    assert list(parse_measured_table(text).values) == ["mean_torque"]


@pytest.mark.parametrize("separator", [";", "\t"])
def test_decimal_commas_and_other_separators_say_the_same(separator):
    text = PLAIN.replace(",", separator).replace("91.5", "91,5")
    plain, found = parse_measured_table(PLAIN), parse_measured_table(text)
    for name, values in plain.values.items():
        np.testing.assert_array_equal(found.values[name], values)


def test_units_and_names_as_people_write_them():
    header = "speed [1/min]; pressure drop [MPa]; torque (kNm); torque sd [Nm]; case flow [l/min]"
    header += "; oil temperature [°C]; (date); Mechanical Efficiency"
    found = parse_measured_table(f"{header}\n60;20;1,0;5;3;50;12 March;0,9\n")
    assert found.duties["shaft_speed"][0] == pytest.approx(2 * np.pi)
    assert found.duties["pressure_drop"][0] == pytest.approx(2e7)
    assert found.values["mean_torque"][0] == pytest.approx(1000)
    assert found.deviations["mean_torque"][0] == pytest.approx(5)
    assert found.values["case_drain"][0] == pytest.approx(3e-3 / 60)
    assert found.duties["oil_temperature"][0] == pytest.approx(323.15)
    assert found.values["hydromechanical_efficiency"][0] == 0.9


@pytest.mark.parametrize("unit", ["bar gauge", "barg", "bar(g)", "bar g"])
def test_gauge_pressures_stand_above_the_atmosphere(unit):
    text = PLAIN.replace("supply pressure [bar]", f"supply pressure [{unit}]")
    assert parse_measured_table(text).duties["supply_pressure"][0] == pytest.approx(2e7 + 101325)


def test_a_table_of_another_encoding_is_read(tmp_path):
    place = tmp_path / "excel.csv"
    text = "speed [rpm];supply pressure [bar];torque [Nm];temperature [°C]\r\n60;200;1000;50\r\n"
    place.write_bytes(text.encode("cp1252"))
    assert read_measured_table(place).duties["oil_temperature"][0] == pytest.approx(323.15)


SLIPS = {
    "": "holds no table; begin with a header",
    "# only a remark\n": "holds no table",
    PLAIN.split("60,")[0]: "has a header and no rows",
    PLAIN.replace("shaft speed", "shaft sped"): "line 2, column 1, is .* meant shaft speed",
    PLAIN.replace("mean torque [Nm]", "colour"): "column 4, is .*colour.* write it in brackets",
    PLAIN.replace("[Nm]", ""): "has no unit; write it behind the name: mean torque .Nm.",
    PLAIN.replace("[Nm]", "[bar]"): "unit 'bar', which measures a pressure, not a torque",
    PLAIN.replace("[Nm]", "[Nn]"): "column 4, is .* unknown unit",
    PLAIN.replace("shaft speed [rpm]", "(speed)"): "line 2 has no column shaft speed",
    PLAIN.replace("supply pressure", "case pressure"): "has no column supply pressure",
    PLAIN.replace("return pressure", "pressure drop"): "both supply pressure and drop",
    PLAIN.replace("mean torque", "(torque)").replace("eff", "(eff"): "names no measured res",
    PLAIN.replace("efficiency [%]", "torque [kNm]"): "two columns of the same",
    PLAIN.replace("efficiency [%]", "efficiency sd [%]"): "without its result; add a column eff",
    PLAIN.replace("return pressure", "return pressure sd"): "only results have one",
    PLAIN.replace("efficiency [%]", "torque sd [Nm]"): "line 6, mean torque, has no standard dev",
    PLAIN.replace("1000", "1000 Nm"): "line 3, mean torque .Nm., is .* is no number",
    PLAIN.replace("1000", "1e999"): "line 3, mean torque .Nm., is .* is no number",
    PLAIN.replace("60,200", "60,200,1"): "line 3 has 6 cells where the header has 5.*semicolons",
    PLAIN.replace("60,200", ",200"): "line 3, shaft speed, is missing",
    PLAIN.replace("[%]", ""): "line 3, efficiency, is \"91.5\", which is 9150 %; .*efficiency .%.",
    "speed [rpm];supply pressure [bar];torque [Nm]\n60,5;200;1.000\n": "point may be of thousands",
    "speed [rpm],supply pressure [bar],torque [Nm]\n60,200,\n": "holds no measured number",
    "speed [rpm],supply pressure [bar],torque [Nm],torque sd [Nm]\n6,20,1,0\n": "above zero",
}  # fmt: skip


@pytest.mark.parametrize("text", SLIPS, ids=range(len(SLIPS)))
def test_a_slip_gets_one_sentence_with_its_place(text):
    with pytest.raises(InputError, match=r"^measured\.csv") as told:
        parse_measured_table(text)
    told.match(SLIPS[text])
    assert "\n" not in str(told.value)


def test_what_is_no_table_is_refused(tmp_path):
    workbook = tmp_path / "bench.xlsx"
    workbook.write_bytes(b"PK\x03\x04rest")
    for place, said in (
        (workbook, "is a workbook; save its sheet as CSV"),
        (tmp_path, "is a directory"),
        (tmp_path / "none.csv", "does not exist"),
    ):
        with pytest.raises(InputError, match=said):
            read_measured_table(place)


def test_a_row_says_its_operating_point_and_the_file_the_rest():
    file = parse_motor_file(SOUND)
    first = file.system.operating_points[0]
    points = [point for point, _ in duties_of(file, parse_measured_table(PLAIN))]
    assert [float(each.return_pressure) for each in points] == pytest.approx([1e6, 1e6, 1.2e6])
    assert all(float(p.case_pressure) == float(first.case_pressure) for p in points)
    drop = PLAIN.replace("supply pressure", "pressure drop")
    point, _ = duties_of(file, parse_measured_table(drop))[2]
    assert float(point.supply_pressure) == pytest.approx(3e7 + 1.2e6)


def test_an_impossible_row_is_told():
    file = parse_motor_file(SOUND)
    for text, said in (
        (PLAIN.replace("60,200", "60,9"), "line 3, supply pressure, is 9 bar, not above the ret"),
        (PLAIN.replace("60,200", "-60,200"), "line 3, shaft speed, is -6.28.* must be above zero"),
    ):
        with pytest.raises(InputError, match=said):
            duties_of(file, parse_measured_table(text))


def test_the_temperature_of_a_row_changes_a_named_oil_and_needs_one():
    warm = PLAIN.replace("efficiency [%]", "oil temperature [degC]").replace("91.5", "40")
    table = parse_measured_table(warm.replace("92", "80"))
    with pytest.raises(InputError, match=r"has no effect while .* names no oil; name it"):
        duties_of(parse_motor_file(SOUND), table)
    text = SOUND
    for key in ("density", "bulk_modulus", "vapour_pressure"):
        text = with_line(f"{key} = 0", text).replace(f"{key} = 0\n", "")
    text = text.replace("[fluid]\n", '[fluid]\noil = "ISO VG 46"\ntemperature = "50 degC"\n')
    file = parse_motor_file(text)
    fluids = [fluid for _, fluid in duties_of(file, table)]
    assert float(fluids[0].density) > float(file.system.fluid.density)
    assert fluids[1] is file.system.fluid  # that row has no temperature
    with pytest.raises(InputError, match=r"line 3, oil temperature, is .*outside the data"):
        duties_of(file, parse_measured_table(warm.replace(",40\n", ",130\n")))

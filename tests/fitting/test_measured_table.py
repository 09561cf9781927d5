"""Measured tables: every way in which a bench writes one, and a sentence for every slip."""

from io import BytesIO
from zipfile import ZIP_BZIP2, ZIP_DEFLATED, ZIP_LZMA, ZIP_STORED, ZipFile

import numpy as np
import pytest
from motor_files import SOUND, with_line

from camring.files.cells.numbers import decimal_sign, number
from camring.files.cells.workbook import workbook_rows
from camring.files.errors import InputError
from camring.files.motor import parse_motor_file
from camring.fitting.measurements.operating_points import operating_points_of
from camring.fitting.measurements.table import parse_measured_table, read_measured_table

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
    np.testing.assert_allclose(found.conditions["shaft_speed"], np.pi * np.array([2, 4, 6]))
    np.testing.assert_allclose(found.conditions["supply_pressure"], [2e7, 2.5e7, 3e7])
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
    assert found.conditions["shaft_speed"][0] == pytest.approx(2 * np.pi)
    assert found.conditions["pressure_drop"][0] == pytest.approx(2e7)
    assert found.values["mean_torque"][0] == pytest.approx(1000)
    assert found.deviations["mean_torque"][0] == pytest.approx(5)
    assert found.values["case_drain"][0] == pytest.approx(3e-3 / 60)
    assert found.conditions["oil_temperature"][0] == pytest.approx(323.15)
    assert found.values["hydromechanical_efficiency"][0] == 0.9


@pytest.mark.parametrize("unit", ["bar gauge", "barg", "bar(g)", "bar g"])
def test_gauge_pressures_stand_above_the_atmosphere(unit):
    text = PLAIN.replace("supply pressure [bar]", f"supply pressure [{unit}]")
    assert parse_measured_table(text).conditions["supply_pressure"][0] == pytest.approx(
        2e7 + 101325
    )


def test_a_table_of_another_encoding_is_read(tmp_path):
    place = tmp_path / "excel.csv"
    text = "speed [rpm];supply pressure [bar];torque [Nm];temperature [°C]\r\n60;200;1000;50\r\n"
    place.write_bytes(text.encode("cp1252"))
    assert read_measured_table(place).conditions["oil_temperature"][0] == pytest.approx(323.15)


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
    PLAIN.replace("60,200", "60,-999"): "line 3, supply pressure .bar., is .-999., a mark of",
    PLAIN.replace("60,200", ",200"): "line 3, shaft speed, is missing",
    PLAIN.replace("[%]", ""): "line 3, efficiency, is \"91.5\", which is 9150 %; .*efficiency .%.",
    "speed [rpm];supply pressure [bar];torque [Nm]\n60;200;1,430\n": "may be 1430 or 1.430; write",
    "speed [rpm];supply pressure [bar];torque [Nm]\n60,5;200;9.5\n": "has .60,5. where line 2 has",
    "speed [rpm];supply pressure [bar];torque [Nm]\n60.5;200;1,43,5\n": "is no number",
    "speed [rpm],supply pressure [bar],torque [Nm]\n60,200,\n": "holds no measured number",
    "speed [rpm],supply pressure [bar],torque [Nm],torque sd [Nm]\n6,20,1,0\n": "above zero",
}  # fmt: skip


@pytest.mark.parametrize("text", SLIPS, ids=range(len(SLIPS)))
def test_a_slip_gets_one_sentence_with_its_place(text):
    with pytest.raises(InputError, match=r"^measured\.csv") as stated:
        parse_measured_table(text)
    stated.match(SLIPS[text])
    assert "\n" not in str(stated.value)


def test_what_is_no_table_is_refused(tmp_path):
    workbook = tmp_path / "bench.xlsx"
    workbook.write_bytes(b"PK\x03\x04rest")
    for place, said in (
        (workbook, "is a damaged workbook; save its sheet as CSV"),
        (tmp_path, "is a directory"),
        (tmp_path / "none.csv", "does not exist"),
    ):
        with pytest.raises(InputError, match=said):
            read_measured_table(place)


def test_a_row_says_its_operating_point_and_the_file_the_rest():
    file = parse_motor_file(SOUND)
    first = file.system.operating_points[0]
    points = [point for point, _ in operating_points_of(file, parse_measured_table(PLAIN))]
    assert [float(each.return_pressure) for each in points] == pytest.approx([1e6, 1e6, 1.2e6])
    assert all(float(p.case_pressure) == float(first.case_pressure) for p in points)
    drop = PLAIN.replace("supply pressure", "pressure drop")
    point, _ = operating_points_of(file, parse_measured_table(drop))[2]
    assert float(point.supply_pressure) == pytest.approx(3e7 + 1.2e6)


def test_an_impossible_row_is_reported():
    file = parse_motor_file(SOUND)
    for text, said in (
        (PLAIN.replace("60,200", "60,10"), "line 3, supply pressure, is 10 bar, the return press"),
        (PLAIN.replace("60,200", "-60,200"), "line 3, shaft speed, is -6.28.* must be above zero"),
    ):
        with pytest.raises(InputError, match=said):
            operating_points_of(file, parse_measured_table(text))


def test_the_temperature_of_a_row_changes_a_named_oil_and_needs_one():
    warm = PLAIN.replace("efficiency [%]", "oil temperature [degC]").replace("91.5", "40")
    table = parse_measured_table(warm.replace("92", "80"))
    with pytest.raises(InputError, match=r"has no effect while .* names no oil; name it"):
        operating_points_of(parse_motor_file(SOUND), table)
    text = SOUND
    for key in ("density", "bulk_modulus", "vapour_pressure"):
        text = with_line(f"{key} = 0", text).replace(f"{key} = 0\n", "")
    text = text.replace("[fluid]\n", '[fluid]\noil = "ISO VG 46"\ntemperature = "50 degC"\n')
    file = parse_motor_file(text)
    fluids = [fluid for _, fluid in operating_points_of(file, table)]
    assert float(fluids[0].density) > float(file.system.fluid.density)
    assert fluids[1] is file.system.fluid  # that row has no temperature
    with pytest.raises(InputError, match=r"line 3, oil temperature, is .*outside the data"):
        operating_points_of(file, parse_measured_table(warm.replace(",40\n", ",130\n")))


BENCH = """\
shaft speed [rpm],supply pressure [bar],mean torque [Nm],supply flow [L/min],case drain [L/min]
20,250,1429.9,9.40,1.486
20,350,2046.1,10.02,1.985
60,250,1424.5,25.53,1.455
200,350,1998.3,81.90,2.041
"""


def same(found, wanted=None):
    """Whether two tables hold the same numbers."""
    plain = parse_measured_table(BENCH) if wanted is None else wanted
    for part in ("conditions", "values"):
        one, other = getattr(found, part), getattr(plain, part)
        assert list(one) == list(other)
        for name in one:
            np.testing.assert_allclose(one[name], other[name], rtol=1e-12)
    return True


def german(text):
    return text.replace(".", "!").replace(",", ";").replace("!", ",")


def headed(head, text=BENCH):
    return head + text[text.index("\n") :]


WRITTEN = {
    "a line that names the separator": "sep=;\n" + german(BENCH),
    "a title": "Motor 4711;;;;\nOperator: Miller, 12.3.2024\n\n" + german(BENCH),
    "a row of units": headed(
        "shaft speed,supply pressure,mean torque,supply flow,case drain\nrpm,bar,Nm,L/min,L/min"
    ),
    "a row of units in brackets": headed("n,p1,M,Q,QL\n[1/min],[bar],(Nm),[l/min],[LPM]"),
    "a header in several lines": headed(
        '"shaft speed\n[rpm]","supply pressure\n[bar]","mean torque\n[Nm]",'
        '"supply flow\n[L/min]","case drain\n[L/min]"'
    ),
    "tabs that the first line names": "sep=\t\n" + BENCH.replace(",", "\t"),
    "thousands after a blank": german(BENCH.replace("1429.9", "1 429.9")),
    "symbols": headed("n [1/min],p1 [bar],M [N m],Q [l/min],Q_L [l/min]"),
    "symbols of ISO 4409": headed("n [min^-1],p_1,e [bar],T [N-m],q_V1,e [L/min],q_V,d [L/min]")
    .replace("p_1,e", '"p_1,e').replace("e [bar]", 'e [bar]"')
    .replace("q_V1,e [L/min]", '"q_V1,e [L/min]"').replace("q_V,d [L/min]", '"q_V,d [L/min]"'),
    "units behind a stroke": headed("n / min-1,p_in / bara,M_d / Nm,Q_1 / lpm,Q_leak / l/min"),
    "units behind a word": headed(
        "Speed in RPM,Inlet pressure in Bar,Torque in NM,Q in L/Min,Qd in lpm"
    ),
    "thousands beside decimals": german(BENCH).replace(",", ".").replace("1429.9", "1,429.9"),
}  # fmt: skip


@pytest.mark.parametrize("how", WRITTEN)
def test_a_bench_writes_one_table_in_many_ways(how):
    assert same(parse_measured_table(WRITTEN[how]))


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-16-be", "utf-8-sig"])
def test_a_table_is_read_in_every_encoding_of_a_spreadsheet(tmp_path, encoding):
    place = tmp_path / "bench.csv"
    place.write_bytes(BENCH.encode(encoding))
    assert same(read_measured_table(place))


def test_a_workbook_is_read_as_its_first_sheet_with_numbers(tmp_path):
    xlsxwriter = pytest.importorskip("xlsxwriter")
    place = tmp_path / "bench.xlsx"
    book = xlsxwriter.Workbook(place)
    book.add_worksheet("empty")
    sheet = book.add_worksheet("rows")
    sheet.write(0, 0, "Motor 4711")
    for row, line in enumerate(BENCH.splitlines(), 2):
        for column, cell in enumerate(line.split(",")):
            sheet.write(row, column, cell if row == 2 else float(cell))
    book.close()
    found = read_measured_table(place)
    assert same(found)
    assert found.lines[0] == 4


def test_groups_of_three_digits_are_thousands_where_the_table_shows_its_decimals():
    text = german(BENCH).replace(",", ".").replace("1429.9", "1,430").replace("1424.5", "1,424")
    found = parse_measured_table(text)
    np.testing.assert_allclose(found.values["mean_torque"], [1430, 2046.1, 1424, 1998.3])
    assert "mean torque [Nm]: 1,430 in lines 2 and 4 is read as 1430" in found.notes[0]
    comma = german(BENCH).replace("1429,9", "1.430")
    assert parse_measured_table(comma).values["mean_torque"][0] == 1430
    whole = "speed [rpm];supply pressure [bar];torque [Nm]\n60;200;1.430\n"
    assert parse_measured_table(whole).values["mean_torque"][0] == 1.430  # as Python writes it


@pytest.mark.parametrize(
    "mark",
    [*("-999", "9999", "-999.0", "-99.99", "9.99E+37", "#N/A", "NaN"),
     *("9.9E37", "+9.90000000E+37", "9.91E37", "-9.9e+37", "1e30")],
)  # fmt: skip
def test_what_loggers_write_for_nothing_is_left_out_and_noted(mark):
    found = parse_measured_table(BENCH.replace("1.985", mark))
    np.testing.assert_array_equal(np.isnan(found.values["case_drain"]), [0, 1, 0, 0])
    if mark[0] not in "#N":
        assert found.notes == (
            f"case drain [L/min]: {mark} in line 3 is taken for a mark of a missing value and "
            "left out.",
        )


def test_what_answers_with_an_overload_in_every_row_was_never_there():
    head, *rows = BENCH.splitlines()
    text = "\n".join([head, *(row[: row.rindex(",")] + ",9.9E+37" for row in rows)])
    found = parse_measured_table(text)
    assert "case_drain" not in found.values
    assert found.notes == (
        "case drain [L/min]: 9.9E+37 in lines 2, 3, 4 and 5 is taken for a mark of a missing value "
        "and left out.",
    )


def test_two_groups_of_three_digits_are_thousands_and_show_the_decimals():
    for million, single, sign in (("1,430,000", "1,430", "."), ("1.430.000", "1.430", ",")):
        assert decimal_sign([million]) == sign
        assert decimal_sign([single]) == ""
        assert number(million, sign, "here") == (1.43e6, True)
    assert decimal_sign(["1,430,000", "0,5"]) == "both"


def book_of(sheet, method=ZIP_DEFLATED):
    held = BytesIO()
    with ZipFile(held, "w", method) as archive:
        archive.writestr("xl/worksheets/sheet1.xml", sheet)
    return held.getvalue()


SPACE = 'xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"'
SHEET = f"<worksheet {SPACE}>{{}}</worksheet>".format("".join(
    f'<c r="{column}{row}" t="inlineStr"><is><t>{cell}</t></is></c>'
    for row, line in enumerate(BENCH.splitlines(), 1)
    for column, cell in zip("ABCDE", line.split(","), strict=True)
))  # fmt: skip


@pytest.mark.parametrize("method", [ZIP_DEFLATED, ZIP_BZIP2, ZIP_LZMA, ZIP_STORED])
def test_a_damaged_workbook_is_a_sentence_at_every_byte(tmp_path, method):
    whole = book_of(SHEET, method)
    assert len(workbook_rows(whole, "bench.xlsx")) == 5
    said = set()
    for place in range(4, len(whole), 1 if method == ZIP_DEFLATED else 7):
        spoilt = bytearray(whole)
        spoilt[place] ^= 0x5A
        try:
            workbook_rows(bytes(spoilt), "bench.xlsx")
        except InputError as error:
            said.add(str(error).partition(";")[0])
    assert "bench.xlsx is a damaged workbook" in said


def test_a_workbook_that_would_grow_without_end_is_refused():
    laughs = '<!DOCTYPE a [<!ENTITY b "ha">]>' + SHEET
    for text in (laughs.encode(), laughs.encode("utf-16")):
        with pytest.raises(InputError, match="is no plain workbook"):
            workbook_rows(book_of(text), "bench.xlsx")
    far = (
        "".join(f'<c r="A{row}"><v>1</v></c>' for row in range(1, 2000))
        + '<c r="XFD1"><v>1</v></c>'
    )
    with pytest.raises(InputError, match="is too large a workbook"):
        workbook_rows(book_of(f"<worksheet {SPACE}>{far}</worksheet>"), "bench.xlsx")


def test_nines_among_numbers_of_their_size_are_numbers():
    found = parse_measured_table(BENCH.replace("1424.5", "999"))
    assert found.values["mean_torque"][2] == 999
    assert found.notes == ()


def test_a_row_written_twice_counts_once_and_is_noted():
    line = "60,250,1424.5,25.53,1.455\n"
    found = parse_measured_table(BENCH + line + line.replace("1.455", "1.456"))
    assert found.lines == (2, 3, 4, 5, 7)
    assert found.notes == (
        "1 row is the same as another to the last digit and counts once: line 6 as line 4.",
    )


def test_a_column_of_any_name_is_read_when_the_user_says_what_it_is():
    text = headed("Drehzahl [1/min],p1 [bar],Moment,Q [l/min],QL [l/min]")
    named = {"shaft_speed": "Drehzahl [1/min]", "torque [Nm]": "moment"}
    assert same(parse_measured_table(text, columns=named))
    for wrong, said in (
        ({"torque": "Momemt"}, r"names .momemt., which .* does not have; you prob.* moment"),
        ({"colour": "Moment"}, "--column .colour. is nothing that can be read here"),
    ):
        with pytest.raises(InputError, match=said):
            parse_measured_table(text, columns=wrong)


def test_what_stands_beside_the_numbers_is_left_out_and_noted():
    head, *rows = BENCH.splitlines()
    text = "\n".join([f"No.,{head},Remark", *(f"{n},{row},warm" for n, row in enumerate(rows))])
    found = parse_measured_table(text)
    assert same(found)
    assert found.notes == ("Columns left out: No., Remark.",)


def test_a_table_with_gauges_says_which_atmosphere_was_added():
    found = parse_measured_table(BENCH.replace("pressure [bar]", "pressure [barg]"))
    assert found.notes == (
        "Gauge pressures stand above an atmosphere of 1.01325 bar (14.696 psi).",
    )


def test_one_symbol_may_be_torque_or_temperature_as_its_unit_says():
    for unit, name in (
        ("Nm", "mean_torque"),
        ("degC", "oil_temperature"),
        ("°C", "oil_temperature"),
    ):
        found = parse_measured_table(f"n [rpm],dp [bar],Q [lpm],T [{unit}]\n60,200,25,50\n")
        assert name in {**found.values, **found.conditions}

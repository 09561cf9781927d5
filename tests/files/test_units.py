"""Text with a unit becomes an SI number, or an error that names the unit."""

import contextlib
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st
from motor_files import SOUND, with_line

from camring.analyses.ranges import axis
from camring.files.motor import parse_motor_file
from camring.files.motor.entries import Unfit
from camring.files.motor.keys import key_map
from camring.files.motor.per_turn import PerTurn
from camring.files.unit_names import EVERYDAY, SCALES, _ask_pint
from camring.files.unit_spellings import says_gauge
from camring.files.units import UnitError, difference_to_si, from_si, to_si
from camring.fitting.measurements.table import parse_measured_table

EXAMPLES = {
    ("250 bar", "Pa"): 250e5,
    ("28 deg", "rad"): 0.48869219055841229,
    ("-2°", "rad"): -0.034906585039886591,
    ("100 rpm", "rad/s"): 10.471975511965978,
    ("2 rev/s", "rad/s"): 12.566370614359172,
    ("5 cm^3", "m^3"): 5e-6,
    ("5 cm3", "m3"): 5e-6,
    ("5 cm³", "m**3"): 5e-6,
    ("5 mL", "m^3"): 5e-6,
    ("5 ccm", "m^3"): 5e-6,
    ("100 U/min", "rad/s"): 10.471975511965978,
    ("6 l/min", "m3/s"): 1e-4,
    ("2e-13 m^3/(s*Pa)", "m3/(s.Pa)"): 2e-13,
    ("80 N*s/m", "N.s/m"): 80,
    ("80 N s/m", "kg/s"): 80,
    ("80 N·s·m⁻¹", "N.s/m"): 80,
    ("210 GPa", "Pa"): 210e9,
    ("46 mm^2/s", "m2/s"): 46e-6,
    ("46 cSt", "m2/s"): 46e-6,
    ("870 kg/m^3", "kg/m3"): 870,
    ("10 %", "1"): 0.1,
    ("0.3", "1"): 0.3,
    ("0.036", "m"): 0.036,
    ("50 degC", "K"): 323.15,
    ("122 °F", "K"): 323.15,
    ("3 inch", "m"): 0.0762,
    ("3 psi", "Pa"): 20684.27187950509,
    ("6 arcmin", "rad"): 0.0017453292519943296,
    (".5e1mm", "m"): 0.005,
    ("+1 mm", "m"): 0.001,
    ("1 m/s/s", "m/s2"): 1,
    ("1 1/s", "1/s"): 1,
    ("60 1/min", "rad/s"): 6.283185307179586,
    ("60 min^-1", "rad/s"): 6.283185307179586,
    ("60 min⁻¹", "rad/s"): 6.283185307179586,
    ("60 min-1", "rad/s"): 6.283185307179586,
    ("60 r/min", "rad/s"): 6.283185307179586,
    ("60 Rev/Min", "rad/s"): 6.283185307179586,
    ("60 RPM", "rad/s"): 6.283185307179586,
    ("60 1/min", "1/s"): 1,
    ("100 psi", "Pa"): 689475.7293168361,
    ("100 PSI", "Pa"): 689475.7293168361,
    ("100 psia", "Pa"): 689475.7293168361,
    ("100 psi(a)", "Pa"): 689475.7293168361,
    ("100 lb/in2", "Pa"): 689475.7293168361,
    ("100 psig", "Pa"): 790800.7293168361,
    ("100 psi g", "Pa"): 790800.7293168361,
    ("200 barg", "Pa"): 20101325,
    ("200 bar (g)", "Pa"): 20101325,
    ("200 bar gauge", "Pa"): 20101325,
    ("200 barü", "Pa"): 20101325,
    ("200 bar_g", "Pa"): 20101325,
    ("20 MPag", "Pa"): 20101325,
    ("20000 kPa gauge", "Pa"): 20101325,
    ("-1.01325 barg", "Pa"): 0,
    ("200 Bar", "Pa"): 2e7,
    ("200 bara", "Pa"): 2e7,
    ("200 bar a", "Pa"): 2e7,
    ("200 bar abs", "Pa"): 2e7,
    ("20 Mpa", "Pa"): 2e7,
    ("20 N/mm2", "Pa"): 2e7,
    ("1 kg/cm2", "Pa"): 98066.5,
    ("1 kgf/cm²", "Pa"): 98066.5,
    ("1 kg/cm2 g", "Pa"): 199391.5,
    ("100 gpm", "m^3/s"): 0.0063090196399999995,
    ("100 GPM", "m^3/s"): 0.0063090196399999995,
    ("60 LPM", "m^3/s"): 1e-3,
    ("60 L/Min", "m^3/s"): 1e-3,
    ("60 ltr/min", "m3/s"): 1e-3,
    ("100 lbf-ft", "N*m"): 135.58179483314005,
    ("100 lb-ft", "N.m"): 135.58179483314005,
    ("100 ft-lbs", "N*m"): 135.58179483314005,
    ("100 ft lb", "N*m"): 135.58179483314005,
    ("1200 in-lb", "N*m"): 135.58179483314005,
    ("1200 lbf*in", "N*m"): 135.58179483314005,
    ("5 N-m", "N*m"): 5,
    ("5 Nm", "N*m"): 5,
    ("5 NM", "N*m"): 5,
    ("5 kNm", "N*m"): 5000,
    ("2 kgf-m", "N*m"): 19.6133,
    ("3 cid", "m^3"): 4.9161192e-05,
    ("3 cu in", "m^3"): 4.9161192e-05,
    ("5 MM", "m"): 0.005,
    ("5 CC", "m^3"): 5e-6,
    ("10 KW", "W"): 1e4,
    ("10 HP", "W"): 7456.998715822702,
    ("46 mPas", "Pa*s"): 0.046,
    ("46 mPa·s", "Pa*s"): 0.046,
    ("3e-11 MPa*s", "Pa*s"): 3e-5,
    ("50 deg C", "K"): 323.15,
    ("50 C", "K"): 323.15,
    ("80 s-1", "1/s"): 80,
}

PINTS = {"°": "degree", "%": "percent", "µm": "um", "rev": "turn", "U": "turn", "ccm": "cm**3",
         "in": "inch", "gal": "gallon", "cid": "inch**3", "gpm": "gallon/minute",
         "lpm": "liter/minute", "t": "tonne", "lbs": "lb", "kp": "kgf", "Nm": "N*m",
         "kNm": "kN*m", "at": "technical_atmosphere", "PS": "metric_horsepower"}  # fmt: skip


@pytest.mark.parametrize(("example", "value"), EXAMPLES.items(), ids=lambda each: str(each))
def test_quantities_are_what_they_say(example, value):
    assert to_si(*example) == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize("name", EVERYDAY)
def test_the_table_agrees_with_pint(name):
    asked = _ask_pint(PINTS.get(name, name))
    assert asked is not None
    assert asked.factor == pytest.approx(EVERYDAY[name].factor, rel=1e-14)
    assert asked.powers == EVERYDAY[name].powers


@pytest.mark.parametrize(
    ("text", "unit", "words"),
    [
        ("2 Hz", "rad/s", "a frequency, not a turning speed"),
        ("2 bar", "m", "a pressure, not a length"),
        ("3 baar", "Pa", "did you mean 'bar'?"),
        ("20 mpa", "Pa", "may be MPa or mPa: write its case"),
        ("3 barg/s", "Pa/s", "unknown unit 'barg'"),
        ("5 bar a", "Pa*s", "measures a pressure, not a dynamic viscosity"),
        ("5 L/Min", "m^2", "measures a flow, not an area"),
        ("5 in-lb", "m", "measures"),
        ("5 kg/cm2", "kg", "measures"),
        ("3 t/min", "Pa", "measures"),
        ("3 d", "s", "unknown unit 'd'"),
        ("3 foo", "m", "unknown unit 'foo'"),
        ("1 A", "m", "unknown unit 'A'"),
        ("1,5 mm", "m", "decimal comma"),
        ("mm", "m", "does not begin with a number"),
        ("", "m", "does not begin with a number"),
        ("1 m^^2", "m", "exponent"),
        ("1 m^99999", "m", "exponent"),
        ("1 GPa^99", "m", "beyond all numbers"),
        ("1 " + "(" * 20 + "m", "m", "nested too deeply"),
        ("1 (m", "m", "bracket"),
        ("1 m)", "m", "end properly"),
        ("1 m/", "m", "a name is missing"),
        ("1 $", "m", "means nothing"),
        ("5 degC/m", "K/m", "temperature scale"),
        ("1 " + "m" * 100, "m", "longer than"),
        ("1 __import__", "m", "unknown unit"),
    ],
)
def test_errors_name_what_is_wrong(text, unit, words):
    with pytest.raises(UnitError) as caught:
        to_si(text, unit)
    assert words in str(caught.value)


@given(text=st.text(max_size=30))
def test_any_text_is_a_number_or_a_unit_error(text):
    for candidate in (text, f"1 {text}", f"1 m{text}"):
        with contextlib.suppress(UnitError):
            assert isinstance(to_si(candidate, "m"), float)


@given(value=st.floats(-1e12, 1e12), unit=st.sampled_from([*EVERYDAY, *SCALES]))
def test_there_and_back_again(value, unit):
    si_unit = "K" if unit in SCALES else unit
    back = to_si(f"{from_si(value, unit)!r} {unit}", si_unit)
    assert back == pytest.approx(value, rel=1e-12, abs=1e-9)


@pytest.mark.parametrize("unit", ["barg", "psig", "1/min", "lb-ft", "kg/cm2", "deg C", "LPM"])
def test_spellings_lead_there_and_back(unit):
    si_unit = next(si for (text, si) in EXAMPLES if text.split(maxsplit=1)[-1] == unit)
    assert to_si(f"{from_si(3e6, unit, si_unit)!r} {unit}", si_unit) == pytest.approx(3e6)


def test_a_displacement_is_read_in_every_volume_of_a_turn():
    entry = PerTurn("a displacement", '"2.5 L/rev"', unit="m^3")
    for text in ("2.5 L/rev", "2500 cc/rev", "2500 CC/Rev", "2500 cm3/r", "2.5 l per rev"):
        assert entry.convert(text) == pytest.approx(2.5e-3, rel=1e-14)
    for text in ("100 cid/rev", "100 cid", "100 in3/rev", "100 cu in/rev", "100 in³/U"):
        assert entry.convert(text) == pytest.approx(1.6387064e-3, rel=1e-14)


def test_a_motor_file_a_table_and_a_range_read_gauges_alike():
    """One atmosphere, 1.01325 bar, wherever somebody writes barg or psig."""
    for unit in ("barg", "psig"):
        expected = to_si(f"300 {unit}", "Pa")
        plain = with_line(f'supply_pressure = "300 {unit}"')
        point = parse_motor_file(plain).system.operating_points[0]
        assert float(point.supply_pressure) == pytest.approx(expected, rel=1e-14)
        rows = f"speed [1/min],supply pressure [{unit}],torque [Nm]\n60,300,5\n"
        found = parse_measured_table(rows).conditions["supply_pressure"][0]
        assert found == pytest.approx(expected, rel=1e-14)
        entry = key_map(parse_motor_file(SOUND).choices)["operating_points.supply_pressure"]
        places = axis("supply_pressure", f"200..300 {unit}", entry, 3)
        assert to_si(f"{places.shown[-1]} {places.unit}", "Pa") == pytest.approx(expected)


def test_a_difference_is_the_same_above_any_zero():
    for text, unit, size in (
        ("5 degC", "K", 5.0),
        ("9 °F", "K", 5.0),
        ("2 barg", "Pa", 2e5),
        ("2 bar", "Pa", 2e5),
        ("0.5 MPa(g)", "Pa", 5e5),
        ("30", "K", 30.0),
    ):
        assert difference_to_si(text, unit) == pytest.approx(size, rel=1e-14)
    with pytest.raises(UnitError, match="a pressure, not a temperature"):
        difference_to_si("2 bar", "K")
    limit = key_map(parse_motor_file(SOUND).choices)["constraints.max_case_temperature_rise"]
    assert limit.read("30 degC") == 30.0
    with pytest.raises(Unfit, match=r"between 0.1 and 200 degC"):
        limit.read("300 degC")


def test_a_file_says_whether_it_has_gauge_pressures():
    for text, gauge in (("5 barg", True), ("5 bar g", True), ("5 bara", False), ("5 kg", False)):
        assert says_gauge({"a": [{"b": text}], "c": 5.0}) is gauge


def test_everyday_units_do_not_load_pint():
    code = (
        "import sys; from camring.files.units import to_si;"
        "[to_si(*q) for q in (('1 bar', 'Pa'), ('1 N*s/m', 'N.s/m'), ('1 mm²', 'm2'),"
        "('1 psig', 'Pa'), ('1 RPM', 'rad/s'),"
        "('1 Bar a', 'Pa'), ('1 lb-ft', 'N*m'), ('1 cid', 'm3'), ('1 gpm', 'm3/s'))];"
        "sys.exit('pint' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_help_loads_neither_pint_nor_jax():
    code = (
        "import sys; from typer.testing import CliRunner; from camring.cli.app import *;"
        "codes = [CliRunner().invoke(app, [*c, '--help']).exit_code for c in ([], *zip(COMMANDS))];"
        "sys.exit(any(codes) or 'pint' in sys.modules or 'jax' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0

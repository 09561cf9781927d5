"""Text with a unit becomes an SI number, or an error that names the unit."""

import contextlib
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camring.interfaces.unit_names import EVERYDAY, SCALES, _ask_pint
from camring.interfaces.units import UnitError, from_si, to_si

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
}

PINTS = {"°": "degree", "%": "percent", "µm": "um", "rev": "turn", "U": "turn", "ccm": "cm**3"}


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
        ("3 Bar", "Pa", "did you mean 'bar'?"),
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


def test_everyday_units_do_not_load_pint():
    code = (
        "import sys; from camring.interfaces.units import to_si;"
        "[to_si(*q) for q in (('1 bar', 'Pa'), ('1 N*s/m', 'N.s/m'), ('1 mm²', 'm2'))];"
        "sys.exit('pint' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0

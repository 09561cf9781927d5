"""`[thermal]` in a motor file: what it takes, what it refuses; `camring map` over temperature."""

import numpy as np
import pytest
from motor_files import SOUND, added, without_table

from camring.analyses.operating_map import operating_map
from camring.files.errors import InputError
from camring.files.motor import parse_motor_file
from camring.files.motor.document import at_temperature
from camring.files.motor.motor_file import validated
from camring.physics.oil.presets import oil_data

OIL = '\n[fluid]\noil = "ISO VG 46"\ntemperature = "50 degC"\n'
WARM = without_table("[fluid]") + OIL
TABLE = '\n[thermal]\nambient_temperature = "20 degC"\nheat_transfer = "12 W/K"\n'


def refused(text):
    with pytest.raises(InputError) as caught:
        parse_motor_file(text)
    return str(caught.value)


def test_its_numbers_stand_in_the_motor_and_the_oil_follows_its_temperature():
    system = parse_motor_file(WARM + TABLE).system
    thermal, line = system.motor.thermal, system.fluid.line
    assert float(thermal.ambient_temperature) == pytest.approx(293.15)
    assert float(thermal.heat_transfer) == 12
    assert float(thermal.specific_heat) == 1900
    assert float(line.temperature) == pytest.approx(323.15)
    at_80 = float(system.fluid.viscosity * line.ratio(30.0))
    assert at_80 == pytest.approx(oil_data("ISO VG 46", 353.15).viscosity, rel=1e-12)


def test_without_it_nothing_follows_a_temperature():
    system = parse_motor_file(WARM).system
    assert system.motor.thermal is None
    assert system.fluid.line is None


def test_the_oil_may_come_in_as_warm_as_the_table_says():
    inlet = TABLE + 'inlet_temperature = "60 degC"\n'
    system = parse_motor_file(WARM.replace('temperature = "50 degC"\n', "") + inlet).system
    assert float(system.fluid.line.temperature) == pytest.approx(333.15)
    assert float(system.fluid.viscosity) == pytest.approx(oil_data("ISO VG 46", 333.15).viscosity)
    said = refused(WARM + inlet)
    assert "thermal.inlet_temperature" in said
    assert "leave one of the two out" in said


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (SOUND + TABLE, 'name it in [fluid], oil = "ISO VG 46"'),
        (WARM + TABLE.replace("heat_transfer", "heat_transfr"), "thermal.heat_transfer"),
        (WARM + TABLE.replace('"12 W/K"', '"12 W"'), "heat_transfer"),
        (WARM + TABLE.replace('"12 W/K"', '"-1 W/K"'), "must be zero or more"),
        (WARM + TABLE.replace('heat_transfer = "12 W/K"\n', ""), "thermal.heat_transfer"),
        (added("[constraints]", 'max_case_temperature_rise = "30 K"'), "without [thermal]"),
    ],
)
def test_what_it_cannot_take_is_refused_with_the_way_out(text, said):
    assert said in refused(text)


def test_another_temperature_is_another_oil_and_the_same_cooling():
    file = parse_motor_file(WARM.replace('temperature = "50 degC"\n', "") + TABLE
                            + 'inlet_temperature = "60 degC"\n')  # fmt: skip
    _, tables = validated(at_temperature(file.document, "30 degC"))
    assert tables.fluid.temperature == pytest.approx(303.15)
    assert tables.thermal.heat_transfer == 12


def test_a_map_over_temperature_has_the_oil_of_each_and_holds_what_has_no_axis():
    file = parse_motor_file(WARM)
    found = operating_map(file, speed="50..100 rpm", temperature="20 degC..80 degC", points="2x3")
    assert [each.key for each in found.axes] == ["operating_points.speed", "fluid.temperature"]
    assert found.axes[1].label == "Oil temperature, degC"
    assert found.results["efficiency"].shape == (2, 3)
    assert "supply" in found.title
    assert np.ptp(found.results["supply_flow"][0]) > 0  # density and bulk modulus follow
    with pytest.raises(InputError, match="third axis"):
        operating_map(
            file, speed="1..2 rpm", pressure="100..200 bar", temperature="20 degC..80 degC"
        )
    with pytest.raises(InputError, match="names no oil"):
        operating_map(parse_motor_file(SOUND), temperature="20 degC..80 degC")

"""Keys of one side's ports in a motor file, and what is wrong with them."""

import jax
import motor_files
import numpy as np
import pytest

from camring.analyses.sweep import sweep
from camring.files.errors import InputError
from camring.files.motor import parse_motor_file
from camring.files.shapes.groove import groove_section
from camring.fitting.fitted_numbers import numbers_named
from camring.geometry.port_shape import ports_of
from camring.objective.envelope import conditions_of, envelope_with_slopes

PLATE = "[motor.valve_plate]"
OWN = """
supply_port_area = "50 mm^2"
return_port_area = "80 mm^2"
return_discharge_coefficient = 0.75
return_ramp = 0.8
supply_notch_angle = "0.5 deg"
supply_notch_area = 0.02
"""
TABLE = 'shape = "tabulated"\nposition = [-1, 0, 1]\nopening_share = [0, 1, 0]\n'


def parsed(lines, table=PLATE, text=motor_files.SOUND):
    return parse_motor_file(motor_files.added(table, lines, text))


def refusal(lines, text=motor_files.SOUND):
    with pytest.raises(InputError) as caught:
        parsed(lines, text=text)
    return str(caught.value)


def test_each_side_has_its_own_and_else_what_both_have():
    motor = parsed(OWN).system.motor
    plate = motor.valve_plate
    assert float(plate.area_of(plate.supply)) == pytest.approx(5e-5)
    assert float(plate.area_of(plate.return_)) == pytest.approx(8e-5)
    assert float(motor.orifice_of(plate.return_).discharge_coefficient) == 0.75
    assert motor.orifice_of(plate.supply) is motor.orifice
    assert float(plate.window_of(plate.return_).ramp) == 0.8
    assert plate.window_of(plate.supply) is plate.window
    assert float(plate.notch_of(plate.supply).area) == 0.02
    assert plate.notch_of(plate.return_) is None
    assert plate.notched


def test_without_them_a_motor_has_the_numbers_it_had():
    plate = parse_motor_file(motor_files.SOUND).system.motor.valve_plate
    assert len(jax.tree.leaves((plate.supply, plate.return_))) == 4


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ("return_discharge_coeficient = 0.7", "probably meant motor.valve_plate.return_discharge_"),
        ('suply_port_area = "50 mm^2"', "probably meant motor.valve_plate.supply_port_area"),
        ("return_ramp = 1.5", "return_ramp is 1.5 but must lie between"),
        ("supply_notch_area = 0.02", "supply_notch_angle is missing: a relief notch has an angle"),
        ('return_notch_angle = "17 deg"\nreturn_notch_area = 0.1', "return_notch_angle is"),
        (
            f"{TABLE}return_ramp = 0.5",
            'return_ramp has no effect with shape = "tabulated", which has no ramp',
        ),
    ],
)
def test_what_is_wrong_is_said_in_a_sentence(lines, said):
    text = motor_files.SOUND
    if "tabulated" in lines:
        text = motor_files.without_line("ramp", text)
        text = "\n".join(line for line in text.splitlines() if "valve_plate.ramp" not in line)
    assert said in refusal(lines, text)


def test_a_notch_of_one_side_turns_forwards_only():
    notch = 'return_notch_angle = "0.5 deg"\nreturn_notch_area = 0.1'
    text = motor_files.added("[[operating_points]]", 'rotation = "reverse"')
    assert "a relief notch lies at the opening edge" in refusal(notch, text)


def test_a_search_varies_what_the_file_gives_one_side_and_asks_for_it_otherwise():
    line = '"motor.valve_plate.return_port_area" = ["40 mm^2", "90 mm^2"]'
    text = motor_files.added("[design_space]", line)
    assert "varies a part that the motor does not have" in refusal("", text)
    file = parsed('return_port_area = "65 mm^2"', text=text)
    names = [variable.name for variable in file.design_space.variables]
    place = names.index("motor.valve_plate.return_port_area")
    at = np.full(file.design_space.dimension, 0.5)
    at[place] = 1.0
    plate = file.design_space.apply(file.system, at).motor.valve_plate
    assert float(plate.area_of(plate.return_)) == pytest.approx(9e-5)
    assert float(plate.area_of(plate.supply)) == pytest.approx(6e-5)


BOTH = 'supply_port_area = "50 mm^2"\nreturn_port_area = "80 mm^2"'
COMMON = "motor.valve_plate.port_area"


@pytest.mark.parametrize("table", ["[design_space]", "[tolerances]"])
def test_a_number_that_no_port_has_is_not_varied(table):
    bounds = '{ relative = ["-5 %", "5 %"] }' if "space" in table else '{ relative = "5 %" }'
    text = motor_files.SOUND if table in motor_files.SOUND else f"{motor_files.SOUND}\n{table}\n"
    text = motor_files.added(table, f'"{COMMON}" = {bounds}', text)
    said = refusal(BOTH, text)
    assert f'"{COMMON}" changes nothing' in said
    assert "supply_port_area and return_port_area are given" in said
    # One side alone leaves it the other one's.
    assert parsed('return_port_area = "80 mm^2"', text=text)


def test_a_number_that_no_port_has_is_neither_swept_nor_fitted():
    file = parsed(BOTH + "\nsupply_discharge_coefficient = 0.6\nreturn_discharge_coefficient = 0.7")
    with pytest.raises(InputError, match=r"changes nothing.*sweep those"):
        sweep(file, {COMMON: "50 mm^2..70 mm^2"})
    with pytest.raises(InputError, match=r"changes nothing.*fit those"):
        numbers_named(file, [COMMON])
    usual = [each.key for each in numbers_named(file, None)]
    assert "motor.valve_plate.discharge_coefficient" not in usual
    assert "motor.valve_plate.return_discharge_coefficient" in usual


def test_of_two_swept_keys_the_common_one_may_lose_its_last_port():
    file = parsed('return_port_area = "80 mm^2"')
    with pytest.raises(InputError, match="port_area changes nothing"):
        sweep(file, {COMMON: "50..70 mm^2", "motor.valve_plate.supply_port_area": "40..60 mm^2"})


def test_a_groove_is_the_same_section_in_ports_of_either_area():
    groove = """
    groove_depth_angle = "15 deg"
    groove_width_angle = "90 deg"
    groove_length = "0.7 mm"
    groove_circle = "42 mm"
    return_port_area = "80 mm^2"
    """
    plate = parsed(groove).system.motor.valve_plate
    section = groove_section(np.radians(15), np.radians(90), 0.7e-3)
    for port in (plate.supply, plate.return_):
        found = float(plate.notch_of(port).area * plate.area_of(port))
        assert found == pytest.approx(section, rel=1e-12)


def test_one_batch_holds_both_directions_of_a_motor_with_one_sides_numbers():
    """Shapes only, nothing is computed: slopes lie beside the numbers that they belong to."""
    envelope = '[envelope]\nspeed = ["60 rpm", "300 rpm"]\nsupply_pressure = ["90 bar", "350 bar"]'
    text = f'{motor_files.SOUND}\n{envelope}\nrotation = "both"\n'
    file = parsed('return_port_area = "65 mm^2"\nsupply_ramp = 0.4', text=text)
    asked = conditions_of(file.envelope, file.envelope.grid(2, 2))
    points = jax.ShapeDtypeStruct((3, file.design_space.dimension), float)
    found, slopes = jax.eval_shape(
        lambda at: envelope_with_slopes(file.design_space, file.system, at, asked), points
    )
    ports = found.motor.valve_plate.supply, found.motor.valve_plate.return_
    assert [port.area.shape for port in ports] == [(3 * asked.count,)] * 2
    assert [port.ramp.shape for port in ports] == [(3 * asked.count,)] * 2
    # Of the file's design space only the common ramp moves them, and that the return's own copy.
    kept = slopes.motor.valve_plate
    assert kept.supply.area is None
    assert kept.return_.ramp.shape == (file.design_space.dimension, 3 * asked.count)


def test_ports_of_two_areas_are_drawn_by_their_angles():
    plate = parsed('return_port_area = "80 mm^2"').system.motor.valve_plate
    ports = ports_of(plate, 0.0425)
    assert ports.shape == "timing"
    assert {slot.kind for slot in ports.slots} == {"supply", "return"}

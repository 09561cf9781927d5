"""[motor.manifold] and [motor.return_manifold] in a motor file."""

import numpy as np
import pytest
from motor_files import SOUND, added

from camring.files.errors import InputError
from camring.files.motor import parse_motor_file

MANIFOLD = 'supply_volume = "200 cm^3"\nline_conductance = "40 L/min/bar"'
FED = added("[motor.manifold]", MANIFOLD)
EMPTIED = added("[motor.return_manifold]", MANIFOLD.replace("supply", "return"))


def complaint(text):
    with pytest.raises(InputError) as caught:
        parse_motor_file(text)
    return str(caught.value)


def test_a_manifold_and_its_line_are_read_in_si():
    manifold = parse_motor_file(FED).system.motor.manifold
    assert float(manifold.volume) == pytest.approx(200e-6, rel=1e-15)
    assert float(manifold.line_conductance) == pytest.approx(40e-3 / 60 / 1e5, rel=1e-15)


def test_a_motor_without_the_table_has_none():
    assert parse_motor_file(SOUND).system.motor.manifold is None
    assert parse_motor_file(SOUND).system.motor.return_manifold is None


def test_either_manifold_may_stand_alone_or_both_with_numbers_of_their_own():
    alone = parse_motor_file(EMPTIED).system.motor
    assert alone.manifold is None
    assert float(alone.return_manifold.volume) == pytest.approx(200e-6, rel=1e-15)
    wider = EMPTIED.replace("40 L/min/bar", "80 L/min/bar")
    both = parse_motor_file(added("[motor.manifold]", MANIFOLD, wider)).system.motor
    supply, back = (float(each.line_conductance) for each in (both.manifold, both.return_manifold))
    assert back == pytest.approx(2 * supply, rel=1e-15)


@pytest.mark.parametrize(("text", "table"), [(FED, "manifold"), (EMPTIED, "return_manifold")])
def test_no_manifold_goes_with_modes_or_a_leaking_plate(text, table):
    modes = added("[motor.modes.half]", "idle_lobes = [1, 2, 3]", text)
    assert f"[motor.{table}] puts a volume before them" in complaint(modes)
    lands = 'gap = "8 um"\nland_radii = ["30 mm", "35 mm", "45 mm", "50 mm"]'
    thin = added("[fluid]", 'viscosity = "46 mm^2/s"', text)
    leaking = added("[motor.valve_plate]", lands, thin)
    assert f"leaks past [motor.{table}]" in complaint(leaking)


@pytest.mark.parametrize("key", ["supply_volume", "line_conductance"])
def test_a_manifold_wants_both_its_numbers(key):
    line = next(each for each in MANIFOLD.split("\n") if each.startswith(key))
    sentence = complaint(FED.replace(line + "\n", ""))
    assert f"motor.manifold.{key}" in sentence


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ('supply_volum = "200 cm^3"', ["motor.manifold.supply_volum ", "supply_volume"]),
        ('supply_volume = "200 cm^2"', ["motor.manifold.supply_volume", "not a volume"]),
        ('supply_volume = "0 cm^3"', ["motor.manifold.supply_volume"]),
    ],
)
def test_a_fault_of_the_manifold_names_its_key(line, words):
    sentence = complaint(FED.replace('supply_volume = "200 cm^3"', line))
    assert all(word in sentence for word in words), sentence
    line, words = (line.replace("supply", "return"), [w.replace("supply", "return") for w in words])
    sentence = complaint(EMPTIED.replace('return_volume = "200 cm^3"', line))
    assert all(w.replace(".manifold", ".return_manifold") in sentence for w in words), sentence


def test_the_supplys_key_in_the_returns_table_is_answered_with_the_right_one():
    sentence = complaint(EMPTIED.replace("return_volume", "supply_volume"))
    assert "motor.return_manifold.supply_volume" in sentence
    assert "return_volume" in sentence


def test_manifold_and_line_may_vary():
    space = '"motor.manifold.supply_volume" = ["50 cm^3", "500 cm^3"]'
    space += '\n"motor.manifold.line_conductance" = ["20 L/min/bar", "60 L/min/bar"]'
    file = parse_motor_file(added("[design_space]", space, FED))
    names = list(file.design_space.names)
    design = np.zeros(file.design_space.dimension)
    design[names.index("motor.manifold.supply_volume")] = 1.0
    design[names.index("motor.manifold.line_conductance")] = 0.0
    manifold = file.design_space.apply(file.system, design).motor.manifold
    assert float(manifold.volume) == pytest.approx(500e-6, rel=1e-12)
    assert float(manifold.line_conductance) == pytest.approx(20e-3 / 60 / 1e5, rel=1e-12)
    written = parse_motor_file(file.with_design(design)).system.motor.manifold
    assert float(written.volume) == pytest.approx(500e-6, rel=1e-12)


def test_a_manifold_that_is_not_there_may_not_vary():
    space = '"motor.manifold.supply_volume" = ["50 cm^3", "500 cm^3"]'
    assert "motor.manifold" in complaint(added("[design_space]", space))

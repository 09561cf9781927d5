"""[motor.manifold] in a motor file."""

import numpy as np
import pytest
from motor_files import SOUND, added

from camring.interfaces.config import parse_motor_file
from camring.interfaces.errors import InputError

MANIFOLD = 'supply_volume = "200 cm^3"\nline_conductance = "40 L/min/bar"'
FED = added("[motor.manifold]", MANIFOLD)


def told(text):
    with pytest.raises(InputError) as caught:
        parse_motor_file(text)
    return str(caught.value)


def test_a_gallery_and_its_line_are_read_in_si():
    manifold = parse_motor_file(FED).system.motor.manifold
    assert float(manifold.volume) == pytest.approx(200e-6, rel=1e-15)
    assert float(manifold.line_conductance) == pytest.approx(40e-3 / 60 / 1e5, rel=1e-15)


def test_a_motor_without_the_table_has_none():
    assert parse_motor_file(SOUND).system.motor.manifold is None


@pytest.mark.parametrize("key", ["supply_volume", "line_conductance"])
def test_a_gallery_wants_both_its_numbers(key):
    line = next(each for each in MANIFOLD.split("\n") if each.startswith(key))
    sentence = told(FED.replace(line + "\n", ""))
    assert f"motor.manifold.{key}" in sentence


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ('supply_volum = "200 cm^3"', ["motor.manifold.supply_volum ", "supply_volume"]),
        ('supply_volume = "200 cm^2"', ["motor.manifold.supply_volume", "not a volume"]),
        ('supply_volume = "0 cm^3"', ["motor.manifold.supply_volume"]),
    ],
)
def test_a_fault_of_the_gallery_names_its_key(line, words):
    sentence = told(FED.replace('supply_volume = "200 cm^3"', line))
    assert all(word in sentence for word in words), sentence


def test_gallery_and_line_may_vary():
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


def test_a_gallery_that_is_not_there_may_not_vary():
    space = '"motor.manifold.supply_volume" = ["50 cm^3", "500 cm^3"]'
    assert "motor.manifold" in told(added("[design_space]", space))

"""A sound motor file becomes the nouns it describes, in SI."""

import json
import subprocess
import sys
from math import pi
from pathlib import Path
from typing import get_args, get_type_hints

import jax
import numpy as np
import pytest
from motor_files import SOUND, added, planar, ring, with_line, without_line, without_table

from camring.files.errors import InputError
from camring.files.motor import parse_motor_file, read_motor_file
from camring.files.motor.entries import Number
from camring.files.motor.keys import CAMS, Choices, key_map
from camring.files.motor.laws import SLOTS, law_keys, law_name, laws_of
from camring.files.motor.table import part
from camring.files.motor.writer import whole_text
from camring.files.starting.template import PROFILES, template
from camring.files.units import parse_unit
from camring.geometry.window import LinearWindow, RoundWindow
from camring.objective.design_space import leaf
from camring.physics.oil.fluid import AbstractFluid, ConstantFluid

NEW_LAW = """
import equinox as eqx
from jaxtyping import Array, Float

from camring.files.motor import parse_motor_file
from camring.numerics.quantity import Q, real
from camring.physics.leakage import AbstractLeakage


class LeakyLeakage(AbstractLeakage):
    bypass: Q[Float[Array, ""], "Pa"] = eqx.field(converter=real, default=3.0)

    def flow(self, ends, piston, fluid):
        return ends.drop / self.bypass


class UnfinishedLeakage(AbstractLeakage):
    pass


text = '''{}'''.replace('leakage_coefficient = "1.6e-13 m^3/(s*Pa)"', 'leakage = "leaky"')
text = text.replace("[design_space]", '[design_space]\\n"motor.bypass" = [1, "5 Pa"]')
file = parse_motor_file(text)
design = file.design_space.apply(file.system, [1.0] * file.design_space.dimension)
leakage = file.system.motor.leakage
try:
    parse_motor_file(text.replace("leaky", "unfinished"))
except Exception as error:
    assert "whose class UnfinishedLeakage has no flow" in str(error), error
print(type(leakage).__name__.removesuffix("Leakage"), leakage.bypass, design.motor.leakage.bypass)
"""

EXAMPLES = Path(__file__).parents[2] / "examples"
FILE = parse_motor_file(SOUND)


def test_numbers_arrive_in_si():
    motor, fluid = FILE.system.motor, FILE.system.fluid
    assert (motor.pistons, motor.lobes) == (8, 6)
    assert float(motor.piston.bore) == pytest.approx(0.03)
    assert float(motor.leakage.coefficient) == pytest.approx(1.6e-13)
    assert float(motor.valve_plate.supply.width) == pytest.approx(28.4 * pi / 180)
    assert float(fluid.bulk_modulus) == pytest.approx(1.4e9)
    first, second = FILE.system.operating_points
    assert float(first.shaft_speed) == pytest.approx(10 * pi)
    assert float(second.supply_pressure) == pytest.approx(35e6)
    assert float(first.case_pressure) == pytest.approx(2e5)
    assert [float(p.weight) for p in (first, second)] == [0.6, 0.4]


def test_goal_and_search_arrive():
    goal = FILE.goal
    assert goal.weights.torque_ripple == 100
    assert goal.constraints.max_pressure == pytest.approx(420e5)
    assert goal.constraints.displacement == pytest.approx((396.36e-6, 404.36e-6))
    assert goal.constraints.max_jerk is None
    assert goal.harmonics == 600
    assert (FILE.search.budget, FILE.search.seed) == (300, 0)


def test_what_is_left_out_has_its_default():
    text = without_table("[objective]", without_table("[constraints]"))
    for key in ("shift", "ramp", "degree"):
        text = without_line(key, text)
    text = text.replace('case_pressure = "2 bar"\n', "").replace("weight = 0.6\n", "")
    text = text[: text.index("[design_space]")]
    file = parse_motor_file(text)
    plate = file.system.motor.valve_plate
    assert float(plate.shift) == 0
    assert float(plate.window.ramp) == 1
    assert float(plate.supply.centre) == pytest.approx(pi / 12)
    assert float(plate.return_.centre) == pytest.approx(pi / 4)
    assert file.system.motor.cam.degree == 3
    assert file.system.motor.reference == "minimum"
    assert isinstance(file.system.fluid, ConstantFluid)
    assert float(file.system.fluid.transition_pressure) == 1e5
    assert float(file.system.operating_points[0].case_pressure) == pytest.approx(1e6)
    assert float(file.system.operating_points[0].weight) == 1
    assert file.goal.weights.torque_ripple == 10
    assert file.goal.constraints.min_pressure is None  # then the vapour pressure
    assert file.design_space is None


def test_bare_numbers_are_si():
    same = parse_motor_file(with_line("bore = 0.03"))
    assert float(same.system.motor.piston.bore) == 0.03


BY_THE_DERIVATION = {
    "wheel_motor": EXAMPLES / "derivation_motor.toml",
    "winch_motor": EXAMPLES.parent / "tests" / "derivation" / "winch_motor.toml",
    "mill_motor": EXAMPLES.parent / "tests" / "derivation" / "mill_motor.toml",
}


@pytest.mark.parametrize("name", BY_THE_DERIVATION)
def test_files_of_the_derivation_hold_the_motors_of_the_references(name):
    published = Path(__file__).parents[1] / "published" / "data"
    example = read_motor_file(BY_THE_DERIVATION[name])
    reference = read_motor_file(published / f"{name}.toml")
    same = jax.tree.map(np.array_equal, example.system, reference.system)
    skipped = {"given_reference_radius"}
    for path, equal in jax.tree_util.tree_leaves_with_path(same):
        assert equal or any(word in jax.tree_util.keystr(path) for word in skipped)
    assert example.goal.constraints == reference.goal.constraints
    assert 8 <= example.design_space.dimension <= 12


def test_reference_radius_has_three_forms():
    def reference(line):
        motor = parse_motor_file(added("[motor.cam]", line)).system.motor
        return motor.reference, float(motor.given_reference_radius)

    assert reference('reference_radius = "minimum"')[0] == "minimum"
    assert reference('reference_radius = "84 mm"') == ("given", pytest.approx(0.084))
    text = added("[motor.cam]", 'reference_radius = "mean"', with_line('dead_volume = "9 cm^3"'))
    assert parse_motor_file(text).system.motor.reference == "mean"


def test_a_free_ring_has_a_period_of_a_revolution():
    cam = parse_motor_file(ring(96)).system.motor.cam
    assert cam.repeats == 1
    assert cam.control_count == 96


def test_a_planar_cam_is_the_curve_of_its_points():
    cam = parse_motor_file(planar()).system.motor.cam
    assert cam.repeats == 6
    assert float(cam.least_turning()) > 0.5


def test_points_may_begin_anywhere_on_the_ring():
    def turned(points):
        back = np.array([[np.cos(3.0), np.sin(3.0)], [-np.sin(3.0), np.cos(3.0)]])
        return points @ back

    text = planar(spoil=turned).replace("mirror = true", "mirror = false")
    cam = parse_motor_file(text).system.motor.cam
    straight = parse_motor_file(planar()).system.motor.cam
    angle = np.linspace(0, 1, 7)
    np.testing.assert_allclose(
        cam.pitch_radius(angle + 3.0).value, straight.pitch_radius(angle).value, rtol=1e-9
    )


class TestLaws:
    @pytest.mark.parametrize("slot", SLOTS, ids=lambda slot: slot.parent.__name__)
    def test_every_law_can_be_named_in_a_file(self, slot):
        names = laws_of(slot)
        assert next(iter(names)) == slot.default
        for name, law in names.items():
            assert law_name(law, slot.parent) == name
            place = SLOTS.index(slot)
            words = Choices().laws
            choices = Choices((*words[:place], name, *words[place + 1 :]))
            for path, entry, _ in law_keys(slot, law).values():
                assert path in key_map(choices)
                assert entry.leaves

    def test_a_law_is_chosen_by_its_name(self):
        plate = parse_motor_file(added("[motor.valve_plate]", 'shape = "round"'))
        assert isinstance(plate.system.motor.valve_plate.window, RoundWindow)
        assert isinstance(FILE.system.motor.valve_plate.window, LinearWindow)

    def test_a_new_law_is_in_the_file_at_once(self):
        # In a process of its own: the class would stay a law of all tests that follow.
        done = subprocess.run(
            [sys.executable, "-c", NEW_LAW.format(SOUND)], capture_output=True, text=True
        )
        assert done.stdout == "Leaky 3.0 5.0\n", done.stderr

    def test_a_key_of_another_law_says_which(self):
        with pytest.raises(InputError, match=r"has no effect with fluid\.law"):
            parse_motor_file(added("[fluid]", "air_fraction = 0.01"))

    def test_every_fluid_has_a_vapour_pressure_key(self):
        (slot,) = (each for each in SLOTS if each.parent is AbstractFluid)
        for law in laws_of(slot).values():
            assert "vapour_pressure" in law_keys(slot, law)


def present(way):
    """Whether the nouns on a way through the system are there."""
    here = FILE.system
    for each in way:
        here = getattr(here, each)
        if here is None:
            return False
    return True


class TestKeys:
    @pytest.mark.parametrize("representation", CAMS)
    def test_every_unit_means_something(self, representation):
        for path, entry in key_map(Choices(representation=representation)).items():
            assert entry.meaning, path
            assert entry.example, path
            if isinstance(entry, Number):
                parse_unit(entry.unit)

    def test_every_example_is_within_its_limits(self):
        for path, entry in key_map(Choices()).items():
            if type(entry) is Number:
                entry.read(json.loads(entry.example)), path

    def test_every_leaf_is_in_the_system(self):
        present = {
            "motor.valve_plate.notch",
            "motor.gap",
            "motor.manifold",
            "motor.return_manifold",
            "motor.piston.spring",
            "motor.plate_gap",
            "motor.thermal",
            "motor.churning",
            "motor.cam.control_points",
            *(
                f"motor.valve_plate.{side}.{own}"
                for side in ("supply", "return_")
                for own in ("area", "discharge_coefficient", "ramp", "notch")
            ),
        }
        for path, entry in key_map(Choices()).items():
            for found in entry.leaves:
                if not any(found.startswith(absent) for absent in present):
                    assert leaf(found)(FILE.system) is not None, path

    def test_every_number_is_read_in_the_unit_of_its_noun(self):
        compared = set()
        for entry in key_map(Choices()).values():
            for path in entry.leaves if isinstance(entry, Number) else ():
                *way, name = path.split(".")
                owner = leaf(".".join(way))(FILE.system) if present(way) else None
                if owner is None:
                    continue
                unit = get_args(get_type_hints(type(owner), include_extras=True)[name])[1]
                assert parse_unit(entry.unit).powers == parse_unit(unit).powers, path
                compared.add(path)
        assert {"motor.piston.bore", "motor.roller.material.elastic_modulus"} < compared

    def test_a_number_that_no_noun_has_cannot_be_a_key(self):
        with pytest.raises(TypeError, match="PistonGap has no width"):
            part("motor.gap.width", "a width", '"1 mm"')

    def test_leaves_hold_what_the_file_says(self):
        for path, entry in key_map(Choices()).items():
            here = FILE.document
            for step in path.split("."):
                here = here.get(step) if isinstance(here, dict) else None
            if type(entry) is Number and entry.leaves and here is not None:
                for found in entry.leaves:
                    assert float(leaf(found)(FILE.system)) == entry.read(here), path


class TestDesignSpace:
    def test_paths_may_be_quoted_or_not(self):
        quoted = added("[design_space]", '"motor.bore" = ["29 mm", "31 mm"]')
        bare = added("[design_space]", 'motor.bore = ["29 mm", "31 mm"]')
        nested = SOUND + '[design_space.motor]\nbore = ["29 mm", "31 mm"]\n'
        names = [parse_motor_file(text).design_space.names for text in (quoted, bare, nested)]
        assert all("motor.bore" in each for each in names)
        assert len(names[0]) == len(names[1]) == len(names[2])

    def test_numbers_move_together(self):
        text = without_table("[design_space]")
        line = (
            '"motor.valve_plate.supply_width" = { relative = ["-5 %", "5 %"],'
            ' together_with = ["motor.valve_plate.return_width"] }'
        )
        file = parse_motor_file(added("[design_space]", line, text))
        system = file.design_space.apply(file.system, np.ones(file.design_space.dimension))
        plate = system.motor.valve_plate
        assert float(plate.supply.width) == pytest.approx(28.4 * 1.05 * pi / 180)
        assert float(plate.return_.width) == float(plate.supply.width)
        again = parse_motor_file(file.with_design(np.ones(file.design_space.dimension)))
        assert float(again.system.motor.valve_plate.return_.width) == pytest.approx(
            float(plate.return_.width), rel=1e-15
        )

    def test_modes_may_be_listed(self):
        text = SOUND.replace("modes = 8", "modes = [3, 5, 7]")
        assert parse_motor_file(text).design_space.cam.harmonics == (3, 5, 7)

    def test_without_mirror_there_are_sines(self):
        text = SOUND.replace("mirror = true", "mirror = false")
        assert parse_motor_file(text).design_space.cam.dimension == 13

    def test_numbers_of_the_oil_may_vary(self):
        text = added("[design_space]", '"fluid.bulk_modulus" = ["1 GPa", "2 GPa"]')
        assert "fluid.bulk_modulus" in parse_motor_file(text).design_space.names


class TestWriter:
    @pytest.mark.parametrize("profile", PROFILES)
    def test_whole_text_says_the_same(self, profile):
        file = parse_motor_file(template(profile))
        assert parse_motor_file(whole_text(file.document)).document == file.document

    def test_inline_tables_are_written_anew(self):
        document = FILE.document
        motor = ", ".join(f"{k} = {json.dumps(v)}" for k, v in document["motor"]["roller"].items())
        text = without_table("[motor.roller]")
        text = text.replace("[motor]\n", f"[motor]\nroller = {{ {motor} }}\n", 1)
        text = added("[design_space]", '"motor.roller.radius" = ["11 mm", "13 mm"]', text)
        file = parse_motor_file(text)
        point = np.zeros(file.design_space.dimension)
        again = parse_motor_file(file.with_design(point))
        assert float(again.system.motor.roller.radius) == pytest.approx(0.011)
        assert again.system.motor.name == file.system.motor.name

    def test_a_key_that_was_left_out_is_put_in(self):
        file = parse_motor_file(without_line("shift"))
        written = file.with_design(np.zeros(file.design_space.dimension))
        assert 'shift = "-2 deg"' in written

    def test_a_motor_without_design_space_cannot_be_changed(self):
        text = SOUND[: SOUND.index("[design_space]")]
        with pytest.raises(InputError, match=r"has no table \[design_space\]"):
            parse_motor_file(text).with_design([])

    def test_one_remark_says_where_a_design_comes_from(self):
        """Comments of the given file stay, and may be untrue of the numbers found."""
        file = parse_motor_file(SOUND)
        half = np.full(file.design_space.dimension, 0.5)
        first = parse_motor_file(file.with_design(half, "camring optimise"))
        again = first.with_design(half, "camring pareto")
        assert again.startswith("# A design found by `camring pareto`. Remarks below")
        assert again.count("A design found by") == 1
        assert again.split("\n", 2)[2] == file.with_design(half)

    def test_comments_behind_lists_stay(self):
        text = SOUND.replace("]\ndegree", "]  # the ring\ndegree")
        file = parse_motor_file(text)
        assert "]  # the ring" in file.with_design(np.full(file.design_space.dimension, 0.3))

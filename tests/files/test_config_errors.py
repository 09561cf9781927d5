"""Bad input: one sentence that names field, value, limit and way out, and nothing else."""

import os
import re

import numpy as np
import pytest
from motor_files import SOUND, added, planar, ring, with_line, without_line, without_table

from camring.files.errors import InputError
from camring.files.motor import parse_motor_file, read_motor_file

CONTROL = re.search(r"control_radii = \[[^\]]*\]", SOUND)[0]


def controls(values):
    return SOUND.replace(CONTROL, f"control_radii = {values}")


def cos_ring(points):
    return points[::-1]


# Name of the fault: the text, then words that the sentence must hold.
FAULTS = {
    "unknown unit": (with_line('bore = "30 mmm"'), ['motor.bore is "30 mmm"', "mmm", "mm"]),
    "wrong dimension": (with_line('bore = "30 s"'), ["motor.bore", "a time, not a length"]),
    "no dimension": (with_line('bore = "30 %"'), ["motor.bore", "not a length"]),
    "gauge length": (with_line('bore = "30 barg"'), ["motor.bore", "a pressure, not a length"]),
    "operating points in single brackets": (
        SOUND.replace("[[operating_points]]", "[operating_points]"),
        ["write [[operating_points]]"],
    ),
    "frequency for a speed": (
        with_line('speed = "2 Hz"'),
        ["[[operating_points]] 1, speed", "turning speed"],
    ),
    "decimal comma": (with_line('bore = "30,5 mm"'), ["motor.bore", "decimal point"]),
    "words": (with_line('bore = "thirty"'), ["motor.bore", "number", '"30 mm"']),
    "a table for a number": (with_line("bore = {}"), ["motor.bore is a table"]),
    "a list for a number": (with_line("bore = [1]"), ["motor.bore is a list of 1"]),
    "true for a number": (with_line("bore = true"), ["motor.bore is true"]),
    "a date for a number": (with_line("bore = 2020-01-01"), ["motor.bore"]),
    "misspelt key": (
        SOUND.replace("bore =", "boar ="),
        ["motor.boar is not a key of [motor]", "motor.bore"],
    ),
    "misspelt deep key": (
        SOUND.replace("\nlength =", "\nlenght ="),
        ["motor.roller.lenght", "motor.roller.length"],
    ),
    "misspelt in a list of tables": (
        SOUND.replace("speed = ", "sped = ", 1),
        ["[[operating_points]] 1, sped", "probably meant [[operating_points]] 1, speed"],
    ),
    "unknown key": (added("[motor]", "colour = 1"), ["motor.colour", "known are"]),
    "key of another table": (added("[fluid]", "bore = 1"), ["fluid.bore", "motor.bore"]),
    "unknown table": (added("[gearbox]", "ratio = 1"), ["gearbox is not a key"]),
    "misspelt table": (SOUND.replace("[fluid]", "[fluids]"), ["fluids", "fluid"]),
    "misspelt constraint": (
        SOUND.replace("max_pressure =", "maximum_pressure ="),
        ["constraints.maximum_pressure", "constraints.max_pressure"],
    ),
    "odd key": (added("[motor]", '"a\\nb" = 1'), ["motor."]),
    "no effect: points of a radial cam": (
        added("[motor.cam]", "control_points = [[1, 0]]"),
        ["motor.cam.control_points has no effect", 'representation = "planar"'],
    ),
    "no effect: radii of a planar cam": (
        added("[motor.cam]", "control_radii = [1, 2]", planar()),
        ["motor.cam.control_radii has no effect"],
    ),
    "no effect: search without a space": (
        without_table("[design_space.cam]", without_table("[design_space]")),
        ["[search] has no effect without [design_space]"],
    ),
    "no effect: weight of an empty sum": (
        added("[objective]", "spectral_torque = 1", with_line("spectrum = 0")),
        ["objective.spectral_torque has no effect"],
    ),
    "unknown law": (added("[fluid]", 'law = "constnat"'), ["fluid.law", "constnat", "constant"]),
    "unknown window": (added("[motor.valve_plate]", "shape = 3"), ["motor.valve_plate.shape"]),
    "unknown representation": (
        added("[motor.cam]", 'representation = "polar"'),
        ["motor.cam.representation", '"radial"'],
    ),
    "unknown symmetry": (added("[motor.cam]", 'symmetry = "lobe"'), ["symmetry", "lobes"]),
    "unknown reference": (
        added("[motor.cam]", 'reference_radius = "minimal"'),
        ["motor.cam.reference_radius", "minimum"],
    ),
    "degree 2": (with_line("degree = 2"), ["motor.cam.degree is 2", "between 3 and 5"]),
    "degree 6": (with_line("degree = 6"), ["motor.cam.degree is 6"]),
    "missing key": (without_line("bore"), ["motor.bore is missing", '"30 mm"']),
    "missing table": (without_table("[fluid]"), ["[fluid] is missing"]),
    "missing deep table": (without_table("[motor.roller]"), ["[motor.roller] is missing"]),
    "missing points": (
        without_table("[[operating_points]]"),
        ["[[operating_points]] is missing"],
    ),
    "empty points": (
        "operating_points = []\n" + without_table("[[operating_points]]"),
        ["operating_points"],
    ),
    "table for a list": (
        without_table("[[operating_points]]") + "\n[operating_points]\nspeed = 1\n",
        ["operating_points is a table but must be a list", "[[operating_points]]"],
    ),
    "list for a table": ("motor = []", ["motor is a list of 0 but must be a table"]),
    "number for a table": ("motor = 3", ["motor is 3 but must be a table"]),
    "nothing": ("", ["missing"]),
    "negative size": (with_line('bore = "-30 mm"'), ["motor.bore", "above zero"]),
    "millimetres without saying so": (
        with_line("bore = 30"),
        [
            "motor.bore is 30, without a unit and so in m, but must lie between 0.0001 and 2 m",
            '"30 mm"',
        ],
    ),
    "zero size": (with_line("bore = 0"), ["motor.bore is 0 but must be above zero"]),
    "zero speed": (with_line('speed = "0 rpm"'), ["[[operating_points]] 1, speed", "above zero"]),
    "negative speed": (with_line('speed = "-9 rpm"'), ["[[operating_points]] 1, speed"]),
    "negative leakage": (with_line("leakage_coefficient = -1"), ["zero or more"]),
    "nan": (with_line("bore = nan"), ["motor.bore is nan", "finite"]),
    "infinity": (with_line("bore = -inf"), ["motor.bore", "finite"]),
    "infinity in text": (with_line('bore = "1e999 mm"'), ["motor.bore", "finite"]),
    "absurd": (with_line("bore = 1e300"), ["motor.bore", "between 0.0001 and 2 m"]),
    "tiny": (with_line("bore = 1e-300"), ["motor.bore", "between"]),
    "a whole number beyond floats": (with_line("bore = 1" + "0" * 400), ["motor.bore"]),
    "ramp zero": (with_line("ramp = 0"), ["motor.valve_plate.ramp", "above zero"]),
    "ramp beyond one": (with_line("ramp = 1.5"), ["motor.valve_plate.ramp", "1"]),
    "no pistons": (with_line("pistons = 0"), ["motor.pistons is 0", "between 1 and 200"]),
    "half a piston": (with_line("pistons = 7.5"), ["motor.pistons", "whole number"]),
    "pistons with a unit": (with_line('pistons = "8"'), ["motor.pistons", "whole number"]),
    "too many pistons": (with_line("pistons = 1000000"), ["motor.pistons"]),
    "too few control values": (controls([0.09, 0.1, 0.09]), ["control_radii has 3", "4"]),
    "no control values": (controls([]), ["motor.cam.control_radii has 0"]),
    "too many control values": (controls([0.09] * 5000), ["5000", "720"]),
    "bad control value": (
        SOUND.replace('"86.6195 mm"', '"86.6195 bar"'),
        ["motor.cam.control_radii, 3rd value", "a pressure, not a length"],
    ),
    "circle": (controls([0.09] * 8), ["motor.cam is a circle", "stroke is zero"]),
    "dead volume at the mean": (
        with_line('dead_volume = "3 cm^3"', added("[motor.cam]", 'reference_radius = "mean"')),
        ["motor.dead_volume", "chamber volume falls to -1.1", "at 0 deg", "give more than 4.1"],
    ),
    "dead volume at a number": (
        added("[motor.cam]", 'reference_radius = "99 mm"'),
        ["motor.dead_volume", "chamber volume falls to"],
    ),
    "window wider than the pitch": (
        with_line('supply_width = "61 deg"'),
        ["motor.valve_plate.supply_width", "wider than the pitch of 60 deg", "at most 60 deg"],
    ),
    "supply as high as return": (
        with_line('supply_pressure = "10 bar"'),
        ["[[operating_points]] 1, supply_pressure", "the return pressure itself"],
    ),
    "misspelt direction": (
        SOUND.replace("weight = 0.6", 'rotation = "revers"'),
        ["[[operating_points]] 1, rotation", "did you mean 'reverse'"],
    ),
    "a notch backwards": (
        added("[motor.valve_plate]", 'notch_angle = "0.5 deg"\nnotch_area = 0.03').replace(
            "weight = 0.4", 'weight = 0.4\nrotation = "reverse"'
        ),
        ["[[operating_points]] 2, rotation", "opening edge", "leave motor.valve_plate.notch_angle"],
    ),
    "too fast in the user's unit": (
        with_line('speed = "9e5 rpm"'),
        ["[[operating_points]] 1, speed", "must lie between 0.0009549 and 9.549e+04 rpm"],
    ),
    "too hot in the user's unit": (
        added("[fluid]", 'oil = "ISO VG 46"\ntemperature = "400 degC"'),
        ["fluid.temperature", "must lie between -43.15 and 146.9 degC"],
    ),
    "no weight": (
        SOUND.replace("weight = 0.6", "weight = 0").replace("weight = 0.4", "weight = 0"),
        ["[[operating_points]] 1, weight"],
    ),
    "crossed band": (
        with_line('displacement = ["404 cm^3", "396 cm^3"]'),
        ["constraints.displacement", "crossed"],
    ),
    "empty band": (with_line("displacement = [1, 1]"), ["constraints.displacement", "empty"]),
    "half a band": (with_line("displacement = [1]"), ["constraints.displacement", "[low, high]"]),
    "crossed pressures": (
        with_line('min_pressure = "500 bar"'),
        ["constraints.min_pressure", "max_pressure"],
    ),
    "self-crossing curve": (
        planar(spoil=lambda points: points[[0, 1, 2, 3, 7, 5, 6, 4, 8, 9, 10, 11]]),
        ["motor.cam.control_points", "not star-shaped"],
    ),
    "clockwise lobe": (planar(spoil=lambda points: points[::-1]), ["motor.cam.control_points"]),
    "clockwise ring": (
        planar(1, 72, spoil=lambda points: points[::-1]),
        ["motor.cam.control_points", "clockwise", "reverse"],
    ),
    "shaft outside the curve": (
        planar(1, 72, spoil=lambda points: points + np.array([0.5, 0])),
        ["motor.cam.control_points", "0 times round the shaft"],
    ),
    "too few points": (planar(count=3), ["motor.cam.control_points has 3"]),
    "a point of three": (
        SOUND.replace(CONTROL, 'representation = "planar"\ncontrol_points = [[1, 2, 3]]'),
        ["motor.cam.control_points, 1st value has 3"],
    ),
    "harmonics beyond reason": (added("[objective]", "harmonics = 10000000"), ["harmonics"]),
    "negative weight": (with_line("torque_ripple = -1"), ["objective.torque_ripple"]),
    "no aim": (
        SOUND.replace("torque_ripple = 100", "torque_ripple = 0")
        .replace("pressure_ripple = 0.02", "pressure_ripple = 0")
        .replace("efficiency = 1", "efficiency = 0")
        .replace("spectrum = 1", "spectrum = 0")
        .replace("jerk = 0.02", "jerk = 0"),
        ["[objective]", "above zero"],
    ),
    "no budget": (with_line("budget = 0"), ["search.budget"]),
}

SPACE_FAULTS = {
    "path that does not exist": (
        '"motor.valve_plate.supply_wdith" = [0.4, 0.5]',
        ["supply_wdith", "no number of the motor", "motor.valve_plate.supply_width"],
    ),
    "count": ('"motor.pistons" = [7, 9]', ["motor.pistons", "count", "one study for each"]),
    "list": ('"motor.cam.control_radii" = [0, 1]', ["[design_space.cam]"]),
    "word": ('"motor.cam.symmetry" = [0, 1]', ["motor.cam.symmetry", "not a number"]),
    "rule": ('"motor.cam.reference_radius" = [0.08, 0.09]', ["rule", "minimum"]),
    "operating point": ('"operating_points.speed" = [1, 2]', ["not a number of motor or oil"]),
    "limit": ('"constraints.max_pressure" = [1, 2]', ["not a number of motor or oil"]),
    "crossed bounds": ('"motor.bore" = ["31 mm", "29 mm"]', ["motor.bore", "crossed"]),
    "empty bounds": ('"motor.bore" = ["30 mm", "30 mm"]', ["motor.bore", "empty"]),
    "one bound": ('"motor.bore" = ["30 mm"]', ["motor.bore", "[low, high]"]),
    "no bounds": ('"motor.bore" = 3', ["motor.bore", "[low, high]"]),
    "bound of wrong dimension": (
        '"motor.bore" = ["3 s", "4 s"]',
        ['motor.bore", 1st value', "a time"],
    ),
    "bound of nothing": ('"motor.bore" = [0, "40 mm"]', ['motor.bore", 1st value', "above zero"]),
    "bound beyond the pitch": (
        '"motor.valve_plate.supply_centre" = [0, 1]\n"motor.bore" = ["29 mm", "200 m"]',
        ['motor.bore", 2nd value'],
    ),
    "given motor outside": (
        '"motor.bore" = ["31 mm", "32 mm"]',
        ["motor.bore", "leave out the given value 30 mm", "widen"],
    ),
    "given motor outside a share": (
        '"motor.bore" = { relative = ["1 %", "2 %"] }',
        ["motor.bore", "leave out no change"],
    ),
    "share of nothing": (
        '"motor.valve_plate.supply.centre" = [0, 1]',
        ["no number of the motor"],
    ),
    "share in metres": (
        '"motor.bore" = { relative = ["-1 mm", "1 mm"] }',
        ['motor.bore", 1st value', "a length, not a plain number"],
    ),
    "share with companions at zero": (
        '"motor.bore" = { relative = ["-1 %", "1 %"],'
        ' together_with = ["motor.valve_plate.shift"] }',
        ["relative bounds but the given value is zero"],
    ),
    "share beyond the pitch": (
        '"motor.dead_volume" = { relative = ["-1 %", "1 %"],'
        ' together_with = ["motor.bore", "motor.boar"] }',
        ["motor.boar", "motor.bore"],
    ),
    "different companions": (
        '"motor.bore" = { bounds = [0.01, 0.04], together_with = ["motor.roller.length"] }',
        ["given differently"],
    ),
    "neither bounds nor share": ('"motor.bore" = {}', ["either bounds or relative"]),
    "both": ('"motor.bore" = { bounds = [0, 1], relative = [0, 1] }', ["either"]),
    "misspelt part": ('"motor.bore" = { relativ = [0, 1] }', ["relativ", "relative"]),
    "companions in one text": (
        '"motor.bore" = { bounds = [0.01, 1], together_with = "motor.roller.length" }',
        ["together_with", "list of paths"],
    ),
    "twice": ('motor.valve_plate.shift = ["-1 deg", "1 deg"]', ["appears twice"]),
}

CAM_FAULTS = {
    "misspelt": ("mode = 3", ["design_space.cam.mode ", "modes"]),
    "no amplitude": ("", ["design_space.cam.amplitude is missing"]),
    "modes beyond the control values": (
        "modes = 9\namplitude = 0.001",
        ["harmonic 9", "at most 8"],
    ),
    "harmonic 1": ("modes = [1, 2]\namplitude = 0.001", ["harmonic 1"]),
    "only harmonic 1": ("modes = 1\namplitude = 0.001", ["keep_displacement"]),
    "no modes": ("modes = []\namplitude = 0.001", ["design_space.cam.modes has 0"]),
    "one mode twice": ("modes = [2, 2]\namplitude = 0.001", ["twice"]),
    "modes in words": ('modes = "all"\namplitude = 0.001', ["design_space.cam.modes"]),
    "amplitude zero": ("modes = 8\namplitude = 0", ["amplitude", "above zero"]),
    "amplitude beyond the ring": ("modes = 8\namplitude = 0.2", ["amplitude", "half"]),
    "amplitude in bar": ('modes = 8\namplitude = "2 bar"', ["not a length"]),
    "mirror in words": ('modes = 8\namplitude = 0.001\nmirror = "yes"', ["true or false"]),
}


def complaint(text):
    with pytest.raises(InputError) as caught:
        parse_motor_file(text)
    return str(caught.value)


def is_one_sentence(sentence):
    assert sentence.isprintable()
    assert sentence.endswith(".")
    assert "; " in sentence, "no way out"
    assert len(sentence) < 400
    return True


@pytest.mark.parametrize(("text", "words"), FAULTS.values(), ids=FAULTS)
def test_a_fault_is_reported_in_one_sentence(text, words):
    sentence = complaint(text)
    assert is_one_sentence(sentence)
    assert all(word in sentence for word in words), sentence


@pytest.mark.parametrize(("line", "words"), SPACE_FAULTS.values(), ids=SPACE_FAULTS)
def test_a_fault_of_the_design_space_is_reported_in_one_sentence(line, words):
    sentence = complaint(added("[design_space]", line))
    assert is_one_sentence(sentence)
    assert all(word in sentence for word in words), sentence


@pytest.mark.parametrize(("lines", "words"), CAM_FAULTS.values(), ids=CAM_FAULTS)
def test_a_fault_of_the_cams_modes_is_reported_in_one_sentence(lines, words):
    text = added("[design_space.cam]", lines, without_table("[design_space.cam]"))
    if "modes" not in lines and "mode " not in lines:
        text += "modes = 8\n"
    sentence = complaint(text)
    assert is_one_sentence(sentence)
    assert all(word in sentence for word in words), sentence


def test_mirror_wants_a_symmetric_cam():
    sentence = complaint(SOUND.replace('"85.3072 mm"', '"85.4 mm"', 1))
    assert "mirror" in sentence
    assert "control values 1 and 15 are 85.4 and 85.3072 mm" in sentence


def test_a_space_that_lets_nothing_change_is_refused():
    text = re.sub(r"\[design_space\]\n(\".*\n)+", "[design_space]\n", SOUND)
    assert "lets nothing change" in complaint(without_table("[design_space.cam]", text))


def test_a_free_ring_may_not_ask_for_more_than_a_lobe_carries():
    assert "at most 8" in complaint(ring(96).replace("modes = 8", "modes = 9"))
    assert parse_motor_file(ring(96)).design_space.cam.lobes == 6


class TestFiles:
    def complaint(self, path):
        with pytest.raises(InputError) as caught:
            read_motor_file(path)
        assert is_one_sentence(str(caught.value))
        return str(caught.value)

    def test_that_do_not_exist_have_a_neighbour(self, tmp_path):
        (tmp_path / "motor.toml").write_text(SOUND)
        assert str(tmp_path / "motor.toml") in self.complaint(tmp_path / "moter.toml")
        assert "camring new" in self.complaint(tmp_path / "x")
        assert "does not exist" in self.complaint(tmp_path / "a" / "b.toml")

    def test_that_are_folders_name_a_motor_in_them(self, tmp_path):
        assert self.complaint(tmp_path).endswith("is a directory; name a motor file in it.")
        for name in ("a.toml", "best.toml"):
            (tmp_path / name).write_text(SOUND)
            assert f"in it, such as {tmp_path / name}" in self.complaint(tmp_path)

    def test_that_may_not_be_read(self, tmp_path):
        path = tmp_path / "secret.toml"
        path.write_text(SOUND)
        path.chmod(0)
        if not os.access(path, os.R_OK):
            assert "cannot be read" in self.complaint(path)

    def test_that_are_pipes_are_not_waited_for(self, tmp_path):
        os.mkfifo(tmp_path / "pipe")
        assert "regular file" in self.complaint(tmp_path / "pipe")

    def test_of_a_hundred_megabytes_are_not_read(self, tmp_path):
        with open(tmp_path / "big.toml", "wb") as file:
            file.truncate(100_000_000)
        assert "100,000,000 bytes" in self.complaint(tmp_path / "big.toml")

    def test_that_are_no_utf8_name_line_and_byte(self, tmp_path):
        (tmp_path / "latin.toml").write_bytes(b"[motor]\nname = 'B\xf6hm'\n")
        sentence = self.complaint(tmp_path / "latin.toml")
        assert "line 2" in sentence
        assert "0xf6" in sentence

    def test_that_are_no_toml_name_the_line(self, tmp_path):
        (tmp_path / "broken.toml").write_text("[motor]\nbore = 30 mm\n")
        assert "line 2" in self.complaint(tmp_path / "broken.toml")

    def test_with_a_key_twice_name_the_line(self, tmp_path):
        (tmp_path / "twice.toml").write_text("[motor]\nbore = 1\nbore = 2\n")
        assert "line 3" in self.complaint(tmp_path / "twice.toml")

    @pytest.mark.parametrize(
        "text",
        ["a = " + "[" * 190_000, "a = " + "{a=" * 60_000, ".".join("a" * 90_000) + " = 1"],
    )
    def test_nested_beyond_reason(self, tmp_path, text):
        (tmp_path / "deep.toml").write_text(text)
        self.complaint(tmp_path / "deep.toml")

    def test_with_names_no_terminal_shows(self, tmp_path):
        self.complaint(tmp_path / "a\nb\x1b[31m.toml")
        self.complaint(tmp_path / ("long" * 200))
        self.complaint("with\0zero.toml")

    def test_with_a_byte_order_mark_are_read(self, tmp_path):
        (tmp_path / "bom.toml").write_bytes(b"\xef\xbb\xbf" + SOUND.encode())
        assert read_motor_file(tmp_path / "bom.toml").system.motor.pistons == 8

    def test_with_line_ends_of_windows_are_read(self, tmp_path):
        (tmp_path / "dos.toml").write_bytes(SOUND.replace("\n", "\r\n").encode())
        file = read_motor_file(tmp_path / "dos.toml")
        point = np.full(file.design_space.dimension, 0.4)
        assert parse_motor_file(file.with_design(point)).system.motor.pistons == 8


FIRST_KEY = next(line for line in SOUND.splitlines() if line.startswith("bore"))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            f"{SOUND}\n[motor.cam]\n",
            r"has the table \[motor.cam\] twice, again in line \d+",
        ),
        (
            SOUND.replace(FIRST_KEY, f"{FIRST_KEY}\n{FIRST_KEY}", 1),
            r"has the key 'bore' twice in one table, again in line \d+; keep one",
        ),
    ],
    ids=["a table", "a key"],
)
def test_what_stands_twice_is_named_with_its_line(text, said):
    with pytest.raises(InputError, match=said):
        parse_motor_file(text)

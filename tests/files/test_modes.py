"""[motor.modes.NAME]: read, refused, printed."""

import re

import numpy as np
import pytest
from motor_files import SOUND, added, ring

from camring.analyses.modes import balanced_splits, cam_repeats, modes
from camring.files.errors import InputError
from camring.files.motor import parse_motor_file
from camring.files.motor.writer import whole_text

HALF = "\n[motor.modes.half]\nidle_lobes = [1, 3, 5]\n"
IN_HALF = SOUND.replace("weight = 0.6", 'weight = 0.6\nmode = "half"') + HALF


def test_an_operating_point_runs_in_the_mode_that_it_names():
    assert IN_HALF.count('mode = "half"') == 1
    file = parse_motor_file(IN_HALF)
    named = [point for point in file.system.operating_points if point.mode]
    assert [point.idle_lobes for point in named] == [(0, 2, 4)]
    assert parse_motor_file(whole_text(file.document)).system.operating_points[0].mode == (
        file.system.operating_points[0].mode
    )


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (IN_HALF.replace('mode = "half"', 'mode = "hlaf"'), ["mode", "you probably meant half"]),
        (IN_HALF.replace("idle_lobes", "idle_lobs"), ["idle_lobs", "meant motor.modes.half.idle"]),
        (IN_HALF.replace("[1, 3, 5]", "[0, 3, 5]"), ["idle_lobes[0]", "counted from 1 to 6"]),
        (IN_HALF.replace("[1, 3, 5]", "[1, 3, 3]"), ["idle_lobes[2]", "there already"]),
        (IN_HALF.replace("[1, 3, 5]", "[1, 2, 3, 4, 5, 6]"), ["all 6 lobes"]),
        (IN_HALF.replace("[1, 3, 5]", "3"), ["a list of lobes"]),
        (IN_HALF.replace("[1, 3, 5]", '["1"]'), ["idle_lobes[0]", "whole number"]),
        (
            SOUND.replace("weight = 0.6", 'weight = 0.6\nmode = "half"'),
            ["write [motor.modes.half]"],
        ),
        (added("[motor]", "modes = 3"), ["motor.modes"]),
    ],
)
def test_what_is_no_mode_is_refused_with_a_way_out(text, words):
    with pytest.raises(InputError) as refused:
        parse_motor_file(text)
    for each in words:
        assert each in str(refused.value)


def test_counts_say_what_survives_and_what_balances():
    (mode,) = modes(parse_motor_file(IN_HALF))
    assert (mode.repeats, mode.order, mode.balanced, mode.share) == (3, 24, False, 0.5)
    assert "when 2 of 6 lobes (no torque at some angles) or 4 of 6 lobes (" in mode.sentence
    assert mode.sentence.endswith(" idle.")
    other = IN_HALF.replace("[1, 3, 5]", "[1, 4]")
    (mode,) = modes(parse_motor_file(other))
    assert (mode.repeats, mode.order, mode.balanced) == (2, 8, True)
    assert "and radial forces cancel. At some angles no piston" in mode.sentence


def test_equal_lobes_of_a_free_ring_are_counted_as_equal():
    (mode,) = modes(parse_motor_file(ring(text=IN_HALF)))
    assert (mode.cam_repeats, mode.repeats, mode.share) == (6, 3, 0.5)


def test_lobes_by_turns_of_two_strokes_repeat_half_as_often_and_share_by_what_they_rise():
    """Nine pistons are balanced on them with the smaller ones idle, eight with none."""
    radius = 0.0909 - 0.0061 * np.cos(6 * 2 * np.pi * np.arange(96) / 96)
    taller = (np.arange(96) // 16) % 2 == 0
    radius = np.where(taller, radius, 0.0848 + 0.5 * (radius - 0.0848))
    text = ring(text=IN_HALF.replace("[1, 3, 5]", "[2, 4, 6]"))
    text = re.sub(r"control_radii = .*", f"control_radii = {radius.tolist()}", text)
    text = text.replace("mirror = true", "mirror = false")
    file = parse_motor_file(text.replace("pistons = 8", "pistons = 9"))
    assert cam_repeats(file.system.motor.cam, 6) == 3
    (mode,) = modes(file)
    assert mode.share == pytest.approx(2 / 3, rel=5e-3)
    assert (mode.repeats, mode.order, mode.balanced) == (3, 9, True)
    assert "of the displacement. The pattern" in mode.sentence
    assert balanced_splits(9, 6, 3) == ((3, 3),)
    assert balanced_splits(8, 6, 3) == ()

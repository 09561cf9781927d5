"""What a hand does to the cam."""

import numpy as np
import pytest

from camring.files.motor import parse_motor_file
from camring.files.starting.library import library
from camring.objective.cam_modes import sum_of_rises, with_control_values
from camring.studio.cam_hand import CamHand, Grip


@pytest.fixture(scope="module")
def file():
    return parse_motor_file(library()["wheel"])


@pytest.fixture(scope="module")
def hand(file):
    return CamHand.of(file)


def test_a_handle_alone_goes_where_the_hand_is_and_the_others_stay(hand):
    moved = hand.moved(Grip("handle", 3, hand.given[3] + 1e-4))
    assert moved[3] == pytest.approx(hand.given[3] + 1e-4)
    np.testing.assert_array_equal(np.delete(moved, 3), np.delete(hand.given, 3))


def test_neighbours_follow_less_the_further_they_are(hand):
    change = hand.moved(Grip("handle", 5, hand.given[5] + 1e-4, reach=3)) - hand.given
    assert np.all(np.diff(change[5:9]) < 0)
    assert np.count_nonzero(change) == 7


def test_a_mirrored_cam_stays_alike_on_both_sides(hand):
    moved = hand.moved(Grip("handle", 4, hand.given[4] + 2e-4, reach=2, mirror=True))
    np.testing.assert_allclose(moved, np.roll(moved[::-1], 1), rtol=0, atol=1e-9)


@pytest.mark.parametrize("grip", [("handle", 6), ("cos", 2), ("sin", 3)])
def test_a_kept_displacement_is_that_of_the_search_space(file, hand, grip):
    kind, number = grip
    start = hand.given[number] if kind == "handle" else hand.amplitude(kind, number)
    moved = hand.moved(Grip(kind, number, start + 3e-4, reach=2, keep=True))
    cam = file.system.motor.cam
    before, after = (float(sum_of_rises(with_control_values(cam, v))) for v in (hand.given, moved))
    assert after == pytest.approx(before, rel=1e-9)


def test_a_wave_has_the_amplitude_that_it_is_given(hand):
    moved = hand.moved(Grip("cos", 3, 2e-4))
    there = CamHand(moved, hand.degree, hand.lobes)
    assert there.amplitude("cos", 3) == pytest.approx(2e-4)
    assert there.amplitude("cos", 2) == pytest.approx(hand.amplitude("cos", 2))

"""A relief groove by depth angle, width angle and length is the notch with its section."""

from math import cos, degrees, pi, radians, sin, tan

import motor_files
import numpy as np
import pytest

from camring.files.errors import InputError
from camring.files.motor import parse_motor_file
from camring.files.shapes.groove import groove_section

GROOVE = (
    'groove_depth_angle = "15 deg"',
    'groove_width_angle = "90 deg"',
    'groove_length = "1.2 mm"',
    'groove_circle = "42 mm"',
)


def with_groove(*lines):
    return motor_files.added("[motor.valve_plate]", "\n".join(lines))


def refusal(*lines):
    with pytest.raises(InputError) as caught:
        parse_motor_file(with_groove(*lines))
    return str(caught.value)


def test_the_section_is_that_of_the_prism_cut_across():
    """By the corners of the triangle between the plate's face and the groove's two flanks."""
    depth, width, distance = radians(15), radians(80), 2e-3
    bottom = distance * sin(depth) / cos(depth)
    half = bottom * sin(width / 2) / cos(width / 2)
    x, y = np.array([-half, half, 0.0]), np.array([0.0, 0.0, -bottom])
    area = abs(np.dot(x, np.roll(y, 1)) - np.dot(y, np.roll(x, 1))) / 2
    assert groove_section(depth, width, distance) == pytest.approx(area, rel=1e-12)


def test_its_opening_grows_as_the_groove_does_from_its_tip():
    motor = parse_motor_file(with_groove(*GROOVE)).system.motor
    plate, notch = motor.valve_plate, motor.valve_plate.notch
    assert float(notch.angle) == pytest.approx(1.2 / 42)
    from_tip = np.array([0.3, 0.6, 1.2]) * 1e-3
    width = float(plate.supply.width)
    place = -width / 2 - float(notch.angle) + from_tip / 42e-3
    opening = notch.opening(plate.window, place, plate.supply.width)
    expected = [groove_section(pi / 12, pi / 2, x) for x in from_tip]
    np.testing.assert_allclose(opening * plate.port_area, expected, rtol=1e-9)
    assert expected[-1] == pytest.approx((1.2e-3 * tan(pi / 12)) ** 2)


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        (GROOVE[:3], "groove_circle is missing: a groove needs all four of its keys"),
        ((*GROOVE, 'notch_angle = "1 deg"'), "notch_angle stands beside a groove"),
        ((*GROOVE[:2], 'groove_length = "40 mm"', GROOVE[3]), "more than port_area of"),
        ((*GROOVE[:3], 'groove_circle = "4 mm"'), f'is "{degrees(0.3):.4g} deg", more than the'),
        (('groove_depth_angle = "15"', *GROOVE[1:]), 'groove_depth_angle is "15" but must lie'),
    ],
)
def test_a_groove_that_cannot_be_is_refused(lines, said):
    assert said in refusal(*lines)

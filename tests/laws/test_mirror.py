"""A motor turned backwards is its mirror image turned forwards, whatever its parts."""

import equinox as eqx
import jax
import numpy as np
import pytest
from motors import STRUCTURES, sound_case

from camring.geometry.notch import ReliefNotch
from camring.geometry.window import TabulatedWindow
from camring.physics.chamber import chamber_at
from camring.physics.force import radial_force
from camring.physics.mirror import has_mirror_image, mirrored
from camring.physics.pressure import pressure_slope

LOPSIDED = TabulatedWindow(np.array([-1.0, -0.5, 0.6, 1.0]), np.array([0.0, 0.9, 1.0, 0.0]))


KINDS = {
    "lobes": (STRUCTURES[0], None),
    "lopsided windows": (STRUCTURES[0], LOPSIDED),
    "ring": (STRUCTURES[1], None),
    "planar": (STRUCTURES[3], None),
}


@pytest.mark.parametrize("kind", KINDS)
def test_the_mirror_image_obeys_the_mirrored_equation_at_the_opposite_speed(kind):
    structure, window = KINDS[kind]
    motor, fluid, point = sound_case(5, structure)
    if window is not None:
        motor = eqx.tree_at(lambda m: m.valve_plate.window, motor, window)
    backwards = eqx.tree_at(lambda p: p.shaft_speed, point, -point.shaft_speed)
    angle = np.linspace(-2, 5, 301)  # meets no knot, where jerk has two sides
    pressure = np.random.default_rng(1).uniform(0, 3e7, angle.shape)
    sides = []
    for one, reverse, sign in ((motor, backwards, 1.0), (mirrored(motor), point, -1.0)):
        radius = one.cam.pitch_radius(sign * angle)
        chamber = chamber_at(one, 0.1, sign * angle, radius)
        slope = pressure_slope(one, fluid, reverse, chamber, pressure)
        force = radial_force(one.piston, pressure, 1e5, radius, reverse.shaft_speed, 12.0)
        even = [radius.value, radius.second, chamber.supply_area, chamber.return_area, force]
        odd = [radius.first, slope, force * radius.first]
        sides.append([np.asarray(x) for x in even] + [sign * np.asarray(x) for x in odd])
    for one, two in zip(*sides, strict=True):
        np.testing.assert_allclose(one, two, rtol=0, atol=1e-9 * np.abs(one).max())


def test_twice_in_a_mirror_is_the_motor_itself():
    for structure in STRUCTURES:
        motor = sound_case(5, structure).motor
        again = mirrored(mirrored(motor))
        for one, two in zip(jax.tree.leaves(motor), jax.tree.leaves(again), strict=True):
            np.testing.assert_allclose(np.asarray(one), np.asarray(two), rtol=0, atol=1e-15)


def test_a_notch_at_the_opening_edge_has_no_mirror_image():
    motor = sound_case(0).motor
    assert has_mirror_image(motor)
    notched = eqx.tree_at(
        lambda m: m.valve_plate.notch, motor, ReliefNotch(0.03, 0.05), is_leaf=lambda x: x is None
    )
    assert not has_mirror_image(notched)

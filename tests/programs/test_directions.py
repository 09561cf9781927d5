"""Directions of change are seen as the operating point sees the motor: its mode, from behind."""

import jax
import numpy as np
import pytest
from motor_files import SOUND

from camring.files.motor import parse_motor_file
from camring.physics.rotation import turned
from camring.programs.compiled import _operated

MODE = "\n[motor.modes.half]\nidle_lobes = [1, 3, 5]\n"
POINTS = {
    "plain": "",
    "in a mode": '\nmode = "half"',
    "backwards": '\nrotation = "reverse"',
    "backwards in a mode": '\nmode = "half"\nrotation = "reverse"',
}
STEP = 0.5  # of the coordinate: applying a direction is straight, so any step will do


@pytest.mark.parametrize("lines", POINTS.values(), ids=POINTS)
def test_a_direction_is_turned_as_the_motor_is(lines):
    file = parse_motor_file(SOUND.replace("weight = 0.6", f"weight = 0.6{lines}") + MODE)
    point, motor = file.system.operating_points[0], file.system.motor
    assert bool(point.idle_lobes or point.reverse) is bool(lines)
    random = np.random.default_rng(0)
    leaves, structure = jax.tree.flatten(file.system)
    changes = [random.normal(size=(1, *np.shape(leaf))) * 1e-3 for leaf in leaves]
    along = jax.tree.unflatten(structure, changes)
    moved = jax.tree.map(lambda number, change: number + STEP * change[0], motor, along.motor)
    found = _operated(along, point).motor
    assert jax.tree.structure(found) == jax.tree.structure(turned(motor, point))
    for change, before, after in zip(
        *map(jax.tree.leaves, (found, turned(motor, point), turned(moved, point))), strict=True
    ):
        np.testing.assert_allclose(before + STEP * change[0], after, rtol=1e-12, atol=1e-15)

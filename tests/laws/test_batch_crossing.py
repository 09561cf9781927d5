"""A solution's own kinks become nodes, in every member those of its own."""

import jax
import numpy as np

from camring.numerics.batch_crossing import with_nodes_at_kinks
from camring.numerics.mesh import Mesh
from camring.numerics.quantity import real
from camring.numerics.radau import STAGES, element_powers

ELEMENTS, MEMBERS, LEVEL = 24, 8, 0.3
PHASE = np.linspace(0, 1.9, MEMBERS)


def wave(place):
    return np.sin(2 * np.pi * place + PHASE)


def even(elements):
    start = np.arange(elements)[:, None] / elements + np.zeros(MEMBERS)
    first = np.arange(elements)[:, None] % 6 == 0
    return Mesh(start, np.full(start.shape, 1 / elements), first & np.ones(MEMBERS, bool))


def found(levels):
    """From a solution on twice as many elements."""
    before, mesh = even(2 * ELEMENTS), even(ELEMENTS)
    stages = wave(before.start + STAGES[:, None, None] * before.width)
    powers = element_powers(wave(before.start), stages)
    within = 2 * np.arange(ELEMENTS, dtype=np.int32)[:, None] + np.zeros(MEMBERS, np.int32)
    levels = tuple(real(np.full(MEMBERS, level)) for level in levels)
    moved, state = jax.jit(with_nodes_at_kinks)(
        mesh, within, wave(mesh.start), before, powers, levels
    )
    return mesh, jax.device_get(moved), np.asarray(state)


def test_every_crossing_is_a_node():
    _, moved, state = found([LEVEL])
    ends = np.concatenate([moved.start[1:], np.ones((1, MEMBERS))])
    height = wave(moved.start) - LEVEL
    on_node = np.abs(height) < 1e-5
    assert np.all(np.sum(on_node, axis=0) == 2)  # a sine passes a level twice in a period
    across = height * (wave(ends) - LEVEL) < 0
    near = on_node | np.roll(on_node, -1, axis=0)
    assert not np.any(across & ~near)
    np.testing.assert_array_equal(state[on_node], LEVEL)
    np.testing.assert_allclose(state, wave(moved.start), atol=1e-5)


def test_breakpoints_stay_and_the_period_stays_filled():
    mesh, moved, _ = found([LEVEL, -0.8, 0.95])
    np.testing.assert_array_equal(moved.start[mesh.is_first], mesh.start[mesh.is_first])
    np.testing.assert_array_equal(moved.is_first, mesh.is_first)
    assert np.all(moved.width >= 0)
    np.testing.assert_allclose(np.sum(moved.width, axis=0), 1, rtol=1e-14)


def test_a_level_that_nothing_passes_moves_nothing():
    mesh, moved, state = found([1.5])
    np.testing.assert_array_equal(moved.start, mesh.start)
    np.testing.assert_array_equal(state, wave(mesh.start))

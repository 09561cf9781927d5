"""Whether some piston pushes at every angle: counted, and by the slopes of a ring."""

import numpy as np
import pytest

from camring.analyses.modes import splits_in_words
from camring.analyses.pushing import pushes_everywhere

COUNTS = [(5, 4), (7, 6), (8, 4), (8, 6), (9, 6), (10, 6), (10, 8)]
PATTERNS = [(), (0,), (0, 3), (0, 2, 4), (0, 1, 3, 4), (0, 1)]


def least_torque(pistons, lobes, idle):
    """Of all angles, with the slopes of a sine ring on rising flanks that are fed."""
    # Dead centres of every piston are among these angles.
    angle = np.arange(2 * pistons * lobes)[:, None] / (2 * pistons)
    place = (angle + lobes / pistons * np.arange(pistons)) % lobes
    fed = ~np.isin(np.floor(place + 1e-9) % lobes, idle)
    return (np.maximum(np.sin(2 * np.pi * place), 0) * fed).sum(axis=1).min()


@pytest.mark.parametrize(("pistons", "lobes"), COUNTS)
@pytest.mark.parametrize("idle", PATTERNS)
def test_where_nothing_pushes_there_is_an_angle_without_torque(pistons, lobes, idle):
    if max(idle, default=0) < lobes and len(idle) < lobes:
        torque = least_torque(pistons, lobes, idle)
        assert pushes_everywhere(pistons, lobes, idle) == (torque > 1e-6)


def test_splits_that_balance_radial_forces_say_where_they_leave_the_shaft_without_torque():
    assert splits_in_words(8, 6) == (
        "2 of 6 lobes (no torque at some angles) or 4 of 6 lobes (no torque at some angles)"
    )
    assert splits_in_words(10, 8).startswith("2 of 8 lobes (torque orders 10, 20, ...) or ")
    assert splits_in_words(7, 6) == "no split of 7 pistons on 6 lobes"


def test_a_ring_with_very_many_patterns_is_answered_at_once():
    assert splits_in_words(100, 100).startswith("2 of 100 lobes (no torque at some angles)")
    assert pushes_everywhere(99, 98)

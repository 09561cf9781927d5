"""Looking more finely until it is fine enough, and saying so when it is not."""

import dataclasses

import equinox as eqx
import jax.numpy as jnp
import pytest
from both_roads import run_all, single
from motors import STRUCTURES, sound_case

from camring.metrics.accuracy import Look, climb
from camring.metrics.error_estimate import relative_error
from camring.numerics.verdict import Fault
from camring.physics.resolution import Resolution

LADDER = Resolution.ladder()


@pytest.fixture(scope="module")
def seen():
    cycles, metrics = run_all([sound_case(seed, STRUCTURES[0]) for seed in range(8)])
    return Look(single(cycles, 0), single(metrics, 0))


def refused(look: Look, fault: Fault) -> Look:
    cycle = eqx.tree_at(lambda each: each.verdict.code, look.cycle, jnp.asarray(int(fault)))
    return Look(cycle, look.metrics)


def off_by(look: Look, share: float, name: str = "flow_ripple") -> Look:
    """The look with one result wrong by a share of itself."""
    value = getattr(look.metrics, name) * (1 + share)
    return Look(look.cycle, dataclasses.replace(look.metrics, **{name: value}))


def eyes(exact: Look, error_of_default: float):
    """Sees one result with an error of the fourth order in the elements, and counts the looks."""
    asked = []

    def look(resolution: Resolution) -> Look:
        used = round(resolution.filled * resolution.elements)
        asked.append(used)
        return off_by(exact, error_of_default * (320 / used) ** 4)

    return look, asked


def test_a_motor_that_is_accurate_enough_costs_two_looks(seen):
    look, asked = eyes(seen, 1e-7)
    found = climb(look, 1e-5)
    assert found.reached
    assert asked == [320, 224]


@pytest.mark.parametrize(("error", "rung"), [(5e-6, 640), (5e-5, 1280)])
def test_it_climbs_until_the_accuracy_is_reached_and_no_further(seen, error, rung):
    look, _ = eyes(seen, error)
    found = climb(look, 1e-5)
    assert found.reached
    assert found.resolution.elements == rung
    assert found.worst_result in ("flow_ripple", "flow_ripple_true_rms")
    true = abs(found.metrics.flow_ripple / seen.metrics.flow_ripple - 1)
    assert true < found.relative_errors["flow_ripple"] <= 1e-5


def test_the_end_of_the_ladder_is_no_success(seen):
    look, asked = eyes(seen, 0.01)
    found = climb(look, 1e-5)
    assert not found.reached
    assert found.largest_error > 1e-5
    assert asked == [320, 224, 640, 1280]


def test_what_no_mesh_can_mend_is_looked_at_no_finer(seen):
    look, asked = eyes(refused(seen, Fault.ORBIT_NOT_UNIQUE), 1e-3)
    assert not climb(look, 1e-5).reached
    assert asked == [320, 224]


def test_a_finer_mesh_that_does_not_converge_takes_nothing_away(seen):
    def look(resolution: Resolution) -> Look:
        if resolution in LADDER[1:]:
            return refused(off_by(seen, 0.5), Fault.NOT_CONVERGED)
        return off_by(seen, 0.01 if resolution == LADDER[0] else 0.02)

    found = climb(look, 1e-5)
    assert not found.reached
    assert found.cycle.verdict.sound
    assert found.resolution == LADDER[0]


def test_an_error_that_is_no_number_is_not_small(seen):
    unknown = dataclasses.replace(seen.metrics, mean_torque=jnp.nan)
    assert relative_error(seen.metrics, unknown)["mean_torque"] == float("inf")


def test_results_without_a_size_of_their_own_do_not_count(seen):
    assert "power_residual" not in relative_error(seen.metrics, seen.metrics)
    assert "line_loss" not in relative_error(seen.metrics, seen.metrics)  # nil

"""Looking more finely until it is fine enough, and saying so when it is not."""

import dataclasses

import equinox as eqx
import jax.numpy as jnp
import pytest
from both_solvers import run_all, single
from motors import STRUCTURES, sound_case

from camring.metrics.accuracy import Solution, climb
from camring.metrics.error_estimate import relative_error
from camring.numerics.verdict import Fault
from camring.physics.resolution import Resolution

LADDER = Resolution.ladder()


@pytest.fixture(scope="module")
def seen():
    cycles, metrics = run_all([sound_case(seed, STRUCTURES[0]) for seed in range(8)])
    return Solution(single(cycles, 0), single(metrics, 0))


def refused(solution: Solution, fault: Fault) -> Solution:
    cycle = eqx.tree_at(lambda each: each.verdict.code, solution.cycle, jnp.asarray(int(fault)))
    return Solution(cycle, solution.metrics)


def off_by(solution: Solution, share: float, name: str = "flow_ripple") -> Solution:
    """The solution with one result wrong by a share of itself."""
    value = getattr(solution.metrics, name) * (1 + share)
    return Solution(solution.cycle, dataclasses.replace(solution.metrics, **{name: value}))


def eyes(exact: Solution, error_of_default: float):
    """Sees one result with an error of the fourth order in the elements; counts the solutions."""
    asked = []

    def solution_at(resolution: Resolution) -> Solution:
        used = round(resolution.filled * resolution.elements)
        asked.append(used)
        return off_by(exact, error_of_default * (320 / used) ** 4)

    return solution_at, asked


def test_a_motor_that_is_accurate_enough_costs_three_solutions(seen):
    solution_at, asked = eyes(seen, 1e-7)
    found = climb(solution_at, 1e-5)
    assert found.reached
    assert asked == [320, 224, 272]


@pytest.mark.parametrize(("error", "reached"), [(5e-6, 640), (5e-5, 1280)])
def test_it_climbs_until_the_accuracy_is_reached_and_no_further(seen, error, reached):
    solution_at, _ = eyes(seen, error)
    found = climb(solution_at, 1e-5)
    assert found.reached
    assert found.resolution.elements == reached
    assert found.worst_result in ("flow_ripple", "flow_ripple_true_rms")
    true = abs(found.metrics.flow_ripple / seen.metrics.flow_ripple - 1)
    assert true < found.relative_errors["flow_ripple"] <= 1e-5


def test_the_end_of_the_ladder_is_no_success(seen):
    solution_at, asked = eyes(seen, 0.01)
    found = climb(solution_at, 1e-5)
    assert not found.reached
    assert found.largest_error > 1e-5
    assert asked == [320, 224, 272, 640, 448, 544, 1280, 896, 1088]


@pytest.mark.parametrize("agreeing", [224, 272, 320, 448, 544])
def test_two_meshes_that_agree_by_chance_do_not_hide_an_error(seen, agreeing):
    """One solution as wrong as the mesh that is assessed: the other tells them apart."""
    error = {224: 1e-4, 272: 8e-5, 320: 6e-5, 448: 3e-5, 544: 2.4e-5, 640: 1.8e-5}
    error[agreeing] = error[320 if agreeing < 320 else 640]

    def solution_at(resolution: Resolution) -> Solution:
        used = round(resolution.filled * resolution.elements)
        return off_by(seen, error[used])

    found = climb(solution_at, 1e-5, LADDER[:2])
    assert found.relative_errors["flow_ripple"] > error[640]
    assert not found.reached


def test_a_motor_whose_meshes_did_agree_by_chance_claims_what_it_is_off(seen):
    """Errors of the smallest contact force of a motor with round ports, notches, air and a
    ripple-free cam: 224 and 320 elements agree to 2.2e-6 and are both off by 1e-5."""
    error = {224: 8.9e-6, 272: -2.2e-5, 320: 1.11e-5, 448: -1.7e-6, 544: -1.9e-6, 640: 5.3e-7}

    def solution_at(resolution: Resolution) -> Solution:
        return off_by(seen, error[round(resolution.filled * resolution.elements)])

    for ladder in (LADDER[:1], LADDER[:2]):
        found = climb(solution_at, 1e-5, ladder)
        true = abs(error[found.resolution.elements])
        assert true < found.relative_errors["flow_ripple"]


def test_what_no_mesh_can_mend_is_looked_at_no_finer(seen):
    solution_at, asked = eyes(refused(seen, Fault.ORBIT_NOT_UNIQUE), 1e-3)
    assert not climb(solution_at, 1e-5).reached
    assert asked == [320, 224, 272]


def test_a_finer_mesh_that_does_not_converge_takes_nothing_away(seen):
    def solution_at(resolution: Resolution) -> Solution:
        if resolution.elements > 320:
            return refused(off_by(seen, 0.5), Fault.NOT_CONVERGED)
        return off_by(seen, 0.01 if resolution == LADDER[0] else 0.02)

    found = climb(solution_at, 1e-5)
    assert not found.reached
    assert found.cycle.verdict.sound
    assert found.resolution == LADDER[0]


def test_an_error_that_is_no_number_is_not_small(seen):
    unknown = dataclasses.replace(seen.metrics, mean_torque=jnp.nan)
    assert relative_error(seen.metrics, unknown)["mean_torque"] == float("inf")


def test_results_without_a_size_of_their_own_do_not_count(seen):
    assert "power_residual" not in relative_error(seen.metrics, seen.metrics)
    assert "line_loss" not in relative_error(seen.metrics, seen.metrics)  # nil

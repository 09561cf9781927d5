"""A motor over its envelope: points, one batch for all, limits against the given motor."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from camring.evaluation.envelope_batch import _OneByOne, at_points
from camring.evaluation.evaluator import MotorEvaluator, model_of
from camring.evaluation.outcome import ENVELOPE_SAFETY, envelope_safety
from camring.evaluation.record import Record
from camring.files.motor import parse_motor_file
from camring.objective.envelope import EFFICIENCY_LOSS, Reference, against_given
from camring.physics.envelope import Envelope
from camring.studies.coordinator import as_seen_by_search
from camring.studies.envelope_gradients import (
    DesignsInEnvelope,
    EnvelopedDesigns,
    EnvelopedFunction,
)

DERIVATION = Path(__file__).parents[2] / "examples" / "derivation_motor.toml"
TABLE = """
[envelope]
speed = ["60 rpm", "300 rpm"]
supply_pressure = ["90 bar", "350 bar"]
rotation = "both"
max_ripple_ratio = 1
max_efficiency_loss = "0.5 %"
"""


def envelope(**changed):
    given = dict(speed=(1.0, 16.0), supply_pressure=(5e6, 25e6), return_pressure=(1e6, 1e6))
    return Envelope(**{**given, **changed})


def test_a_grid_holds_the_corners_and_backwards_comes_last():
    grid = envelope(both_directions=True).grid(5, 3)
    assert grid.count == 30
    assert grid.shaft_speed[:15:3] == pytest.approx([1, 2, 4, 8, 16])
    assert grid.supply_pressure[:3] == pytest.approx([5e6, 15e6, 25e6])
    assert not grid.backwards[:15].any()
    assert grid.backwards[15:].all()
    assert grid.corners() == [0, 2, 12, 14, 15, 17, 27, 29]


def test_every_end_of_the_other_ranges_has_the_whole_grid():
    both = envelope(return_pressure=(1e6, 2e6), fluids=("cold", "hot"), temperatures=(280, 350))
    grid = both.grid(2, 2)
    assert grid.count == 16
    conditions = set(zip(grid.return_pressure.tolist(), grid.fluid.tolist(), strict=True))
    assert conditions == {(1e6, 0), (1e6, 1), (2e6, 0), (2e6, 1)}


def test_a_range_of_one_value_is_one_value():
    assert envelope(speed=(3.0, 3.0)).grid(6, 2).count == 2


def test_the_case_has_the_return_pressure_unless_it_has_its_own():
    back = (1e6, 2e6)
    assert (envelope(return_pressure=back).grid(2, 2).case_pressure.max()) == 2e6
    assert set(envelope(case_pressure=2e5).grid(2, 2).case_pressure) == {2e5}


def test_limits_against_the_given_motor_are_counted_in_themselves():
    given = Reference(np.array([0.08, 0.04]), np.array([0.9, 0.8]))
    asked = envelope(ripple_ratio=0.5, efficiency_loss=0.01)
    found = against_given(asked, given, np.array([0.02, 0.04]), np.array([0.9, 0.78]))
    assert found["max_ripple_ratio"] == pytest.approx([-0.5, 1.0])
    assert found["max_efficiency_loss"] == pytest.approx([-1.0, 1.0])
    none_lost = envelope(efficiency_loss=0.0)
    lost = against_given(none_lost, given, np.zeros(2), np.array([0.9, 0.78]))
    assert lost["max_efficiency_loss"] == pytest.approx([0.0, 0.02])


@pytest.fixture(scope="module")
def file():
    text = DERIVATION.read_text()
    return parse_motor_file(
        text.replace("[objective]\n", "[objective]\nenvelope_ripple = 50\n") + TABLE
    )


def test_all_points_side_by_side_are_each_point_by_itself(file):
    grid = file.envelope.grid(2, 2)
    together = at_points(file.system, file.goal, file.envelope, grid)
    alone = _OneByOne(file.system, file.goal, file.envelope, grid).found
    assert not together.faults.any()
    for name, limit in alone.limits.items():
        assert together.limits[name] == pytest.approx(limit, abs=1e-3), name
    for name in ("torque_ripple", "efficiency", "mean_torque", "supply_flow"):
        values = getattr(alone.metrics, name)
        assert getattr(together.metrics, name) == pytest.approx(values, rel=2e-4), name


def test_gradients_over_the_envelope_are_differences(file):
    evaluate, model = MotorEvaluator(file.text), model_of(file.text)
    names = evaluate.names_by_point
    random = np.random.default_rng(1)
    point = model.space.locate(model.system) + random.normal(size=model.space.dimension) * 0.03
    point = np.clip(point, 0.05, 0.95)
    way = random.normal(size=point.shape)
    way /= np.linalg.norm(way)

    def values(at):
        found = evaluate(at)
        known = {**found.constraints, **found.envelope.pointwise()}
        return np.array([found.physical_objective, *(known[name] for name in names)])

    step = 1e-4
    measured = (values(point + step * way) - values(point - step * way)) / (2 * step)
    objective, limits = evaluate.slopes(point)
    exact = np.array([objective @ way, *(limits @ way)])
    scale = 0.05 + np.abs(exact)
    # Highest stresses and lowest pressures are extremes of cubics: their differences scatter.
    assert np.quantile(np.abs(measured - exact) / scale, 0.9) < 5e-3
    assert exact[0] == pytest.approx(measured[0], rel=1e-4)


def test_an_outcome_holds_the_worst_of_all_points_and_the_mean_ripple(file):
    found = MotorEvaluator(file.text)(model_of(file.text).space.locate(file.system))
    inside = found.envelope
    for name, values in inside.limits.items():
        everywhere = [*values, inside.operating.get(name, -np.inf)]
        assert found.constraints[name] == max(everywhere)
    ripple = np.array(inside.results["torque_ripple"])
    assert inside.share == pytest.approx(50 * np.mean(ripple**2))
    # The given motor is its own reference.
    assert np.abs(inside.limits["max_ripple_ratio"]).max() < 1e-12
    assert inside.limits["max_efficiency_loss"] == pytest.approx(np.full(24, -1.0))


def test_fronts_and_robust_searches_see_the_limits_that_an_evaluation_has(file):
    evaluate, inside = MotorEvaluator(file.text), DesignsInEnvelope(file)
    point = np.clip(model_of(file.text).space.locate(file.system) + 0.02, 0, 1)
    kept = evaluate(point).envelope.limits
    expected = np.concatenate([np.array(kept[name]) + envelope_safety(name) for name in kept])
    assert inside.sound(point)
    assert inside.values(point) == pytest.approx(expected, abs=1e-12)
    assert inside.count == len(expected)
    names = evaluate.names_by_point
    rows = [k for k, name in enumerate(names) if name.endswith("of the envelope")]
    gradients = inside.slopes(point)
    assert gradients == pytest.approx(evaluate.slopes(point)[1][rows], abs=1e-9)

    class Alone:
        """A function and designs of one limit, which know no envelope."""

        def outputs(self, point):
            return 2.0, np.array([-0.5]), np.nan, None

        def slopes(self, point):
            return np.ones(point.size), np.zeros((1, point.size))

    searched = EnvelopedFunction(Alone(), inside)
    problem = searched.problem(point.size, 1)
    ((objective, limits, _, failure),) = problem.evaluate(point[None])
    assert (failure, problem.constraint_count) == (None, 1 + inside.count)
    assert objective == pytest.approx(2.0 + evaluate(point).envelope.share, rel=1e-9)
    assert limits == pytest.approx([-0.5, *expected], abs=1e-12)
    of_objective, of_limits = searched.slopes(point)
    assert of_limits == pytest.approx(np.vstack([np.zeros(point.size), gradients]))
    step = 1e-4 * np.sign(of_objective - 1)
    above, below = (inside.ripple_term(point + way) for way in (step, -step))
    assert (of_objective - 1) @ step == pytest.approx((above - below) / 2, rel=1e-3)

    class Designs:
        def values(self, points):
            return np.ones((1, 1, 1)), np.array([[-0.5]])

    results, limits = EnvelopedDesigns(Designs(), file).values(point[None])
    assert results.tolist() == [[[1.0]]]
    assert limits[0] == pytest.approx([-0.5, *expected], abs=1e-12)


def test_every_search_keeps_farther_from_the_limit_that_its_resolution_knows_least(file):
    found = MotorEvaluator(file.text)(model_of(file.text).space.locate(file.system))
    assert EFFICIENCY_LOSS in found.envelope.limits
    assert {name: envelope_safety(name) for name in found.envelope.limits} == {
        name: ENVELOPE_SAFETY * (2 if name == EFFICIENCY_LOSS else 1)
        for name in found.envelope.limits
    }
    # A coordinator hands the search what it keeps, a record says whether all is kept.
    names = MotorEvaluator(file.text).names_by_point
    _, seen, _, _ = as_seen_by_search(found, names)
    for name in found.envelope.limits:
        place = names.index(f"{name} at point 7 of the envelope")
        assert seen[place] == found.envelope.limits[name][6] + envelope_safety(name)
    for loss, safe in ((-1.9 * ENVELOPE_SAFETY, False), (-2.1 * ENVELOPE_SAFETY, True)):
        limits = {EFFICIENCY_LOSS: [loss], "min_pressure": [-1.1 * ENVELOPE_SAFETY]}
        outcome = replace(
            found, constraints={}, envelope=replace(found.envelope, limits=limits, operating={})
        )
        assert Record(0, "", np.zeros(1), outcome).safe == safe

"""Slopes of objective and constraints are central differences, whatever laws the motor has."""

import dataclasses

import equinox as eqx
import numpy as np
import pytest
from detailed_motors import detailed_case
from motor_files import SOUND

from camring.files.motor import parse_motor_file
from camring.objective.design_space import DesignSpace, Variable
from camring.objective.objective import Goal, assessment_of
from camring.objective.slopes import results_used
from camring.physics.system import System
from camring.programs.compiled import assess, slopes, solve

STEP = 2e-3  # of the unit box
LEAST_SCALE = 0.1  # constraints are counted in their limits; a slope of nil is compared with this
OF_PRESSURE = ("min_pressure", "max_pressure", "min_contact_force", "max_contact_stress")
"""Their differences are noisy: each simulation lays its mesh anew."""
apply = eqx.filter_jit(DesignSpace.apply)


def values(space, system, goal, point):
    """Objective, and constraints in their order."""
    found = assess(apply(space, system, point), goal)
    assert not np.any(found.faults)
    limits = [float(found.constraints[name]) for name in goal.constraints.names()]
    return np.array([float(found.physical_objective), *limits])


def exact(space, system, goal, point):
    design = solve(apply(space, system, point), goal)
    found = slopes(space, system, point, design, goal)
    rows = [found.objective, *(found.constraints[name] for name in goal.constraints.names())]
    return np.array(rows)


def differences(space, system, goal, point, first_step=STEP):
    """Central differences freed of their third-order term, and how sure they are."""
    found = []
    for step in (first_step, first_step / 2):
        rise = [
            (values(space, system, goal, point + way) - values(space, system, goal, point - way))
            / (2 * step)
            for way in step * np.eye(space.dimension)
        ]
        found.append(np.array(rise).T)
    wide, narrow = found
    return (4 * narrow - wide) / 3, np.abs(narrow - wide)


def test_at_random_designs_of_a_motor_file():
    motor_file = parse_motor_file(SOUND)
    space, system, goal = motor_file.design_space, motor_file.system, motor_file.goal
    names = ("objective", *goal.constraints.names())
    allowed = np.array([1e-4 if name in OF_PRESSURE else 1e-6 for name in names])[:, None]
    random = np.random.default_rng(4)
    for point in random.uniform(0.1, 0.9, (2, space.dimension)):
        found = exact(space, system, goal, point)
        expected, doubt = differences(space, system, goal, point)
        scale = np.max(np.abs(found), axis=1, keepdims=True) + LEAST_SCALE
        smooth = doubt < 1e-4 * scale  # else a kink lies between, and differences mean nothing
        assert np.all(smooth[0])
        assert np.mean(smooth) > 0.9
        error = np.where(smooth, np.abs(found - expected), 0) / scale
        for name, worst in zip(names, error.max(1), strict=True):
            print(f"{name}: {worst:.0e}")
        assert np.all(error < allowed)


def test_along_random_directions_at_many_designs():
    """The same at more designs for the same time; `benchmarks/gradient_check.py` looks at 300."""
    motor_file = parse_motor_file(SOUND)
    space, system, goal = motor_file.design_space, motor_file.system, motor_file.goal
    random = np.random.default_rng(5)

    def along(point, way):
        with np.errstate(invalid="ignore"):  # an undercut ring's stress is infinite
            return values(space, system, goal, point + way) - values(
                space, system, goal, point - way
            )

    errors, doubts = [], []
    for point in random.uniform(0.1, 0.9, (60, space.dimension)):
        way = random.normal(size=space.dimension)
        way /= np.linalg.norm(way)
        found = exact(space, system, goal, point)
        wide, narrow = (along(point, step * way) / (2 * step) for step in (STEP, STEP / 2))
        scale = np.linalg.norm(found, axis=1) + LEAST_SCALE
        errors.append(np.abs(found @ way - (4 * narrow - wide) / 3) / scale)
        doubts.append(np.abs(narrow - wide) / scale)
    smooth = np.array(doubts) < 1e-4
    error = np.where(smooth, errors, np.nan)
    assert np.all(np.mean(smooth, axis=0) > 0.9)
    # A kink just outside of the narrow step spoils the differences of few.
    assert np.nanquantile(error[:, 0], 0.98) < 1e-6
    assert np.nanmax(error[:, 0]) < 1e-4
    assert np.all(np.nanmedian(error, axis=0) < 1e-6)
    assert np.all(np.nanquantile(error, 0.9, axis=0) < 1e-4)


@pytest.mark.slow
def test_with_air_notches_and_gaps():
    """Numbers that only the detailed laws has as variables; a manifold's are in tests/laws."""
    case = detailed_case(0)
    system = System(case.motor, case.fluid, (case.point,))
    paths = (
        "motor.valve_plate.notch.area",
        "motor.valve_plate.notch.angle",
        "motor.gap.clearance",
        "motor.valve_plate.shift",
        "fluid.air_fraction",
    )
    variables = tuple(Variable((path,), ((path,),), -0.05, 0.05, relative=True) for path in paths)
    space = DesignSpace(variables)
    point = np.full(len(paths), 0.4)
    found = exact(space, system, Goal(), point)[0]
    # Steps ten times as long: the mesh is laid anew for each, to 1e-7 of the results.
    expected, doubt = differences(space, system, Goal(), point, first_step=10 * STEP)
    scale = np.max(np.abs(found))
    assert np.all(doubt[0] < 1e-5 * scale)
    np.testing.assert_allclose(found, expected[0], atol=1e-5 * scale)


def test_what_the_goal_uses_is_what_it_is_made_of():
    """Every other result may be anything: the judgement does not change."""
    motor_file = parse_motor_file(SOUND)
    system, goal = motor_file.system, motor_file.goal
    found = assess(system, goal)
    used = results_used(goal)
    spoiled = tuple(
        dataclasses.replace(
            each, **{name: each.mean_torque * np.nan for name in vars(each) if name not in used}
        )
        for each in found.metrics
    )
    again = assessment_of(system, goal, spoiled, found.faults)
    assert float(again.objective) == pytest.approx(float(found.objective), rel=1e-12)
    for name, value in found.constraints.items():
        assert float(again.constraints[name]) == pytest.approx(float(value), rel=1e-12)

"""A thousand designs at once are evaluated as each by itself."""

from pathlib import Path

import jax
import numpy as np
import pytest

from camring.evaluation import batch as many
from camring.files.errors import InputError
from camring.files.motor import read_motor_file
from camring.programs.compiled import assess

DERIVATION = Path(__file__).parents[1] / "derivation"


@pytest.fixture(scope="module")
def motor_file():
    return read_motor_file(DERIVATION / "mill_motor.toml")


@pytest.fixture(scope="module")
def assessed(motor_file):
    space = motor_file.design_space
    points = np.random.default_rng(3).uniform(0.4, 0.6, size=(many.CHUNK + 3, space.dimension))
    return points, many.evaluate_many(space, motor_file.system, motor_file.goal, points)


def test_there_is_one_answer_for_each_design(assessed):
    points, found = assessed
    assert {leaf.shape[-1] for leaf in jax.tree.leaves(found)} == {len(points)}


def test_they_run_as_machine_code_of_our_own(assessed):
    """Under each version of JAX that `.ci/jax-versions` tries, or a step has other words there."""
    assert many.measure_batch.hindrances == []


def test_each_is_what_it_is_alone(motor_file, assessed):
    points, found = assessed
    for place in (0, len(points) - 1):
        alone = assess(
            motor_file.design_space.apply(motor_file.system, points[place]), motor_file.goal
        )
        assert found.physical_objective[place] == pytest.approx(
            float(alone.physical_objective), rel=1e-3
        )
        for name, value in alone.constraints.items():
            assert found.constraints[name][place] == pytest.approx(float(value), abs=2e-2), name


def test_nothing_depends_on_how_many_are_asked(motor_file, assessed):
    points, found = assessed
    space = motor_file.design_space
    few = many.evaluate_many(space, motor_file.system, motor_file.goal, points[-3:], threads=1)
    np.testing.assert_allclose(few.objective, found.objective[-3:], rtol=1e-6)


@pytest.mark.parametrize("points", [np.zeros((0, 11)), np.zeros((3, 2)), np.zeros(11)])
def test_points_of_another_shape_are_refused(motor_file, points):
    with pytest.raises(InputError, match="give \\(designs, "):
        many.evaluate_many(motor_file.design_space, motor_file.system, motor_file.goal, points)

"""Three motors by the derivation's laws with design spaces, evaluated as a study evaluates them.

Objective without penalty and constraints each drawn in by `SAFETY`, at search resolution:
what `camring optimise` shows its own search.
"""

from functools import partial
from pathlib import Path

import numpy as np

import camring
from benchmarks.search.problem import Point, SearchProblem, ValueAt
from camring.evaluation.evaluator import MotorEvaluator
from camring.evaluation.outcome import SAFETY

ROOT = Path(__file__).parents[2]
FILES = {
    "wheel": "examples/derivation_motor.toml",
    "winch": "tests/derivation/winch_motor.toml",
    "mill": "tests/derivation/mill_motor.toml",
}
BUDGET, LONG_BUDGET = 200, 1000
BEST = {"wheel": 0.0576141, "winch": 0.0650180, "mill": 0.0380432}
"""Where descents with exact slopes end from every start: `--methods gradient` ends there."""


def motor(name: str) -> SearchProblem:
    """The motor of one of `FILES`; its own design is given, which each seed moves."""
    file = camring.read_motor_file(ROOT / FILES[name])
    space, limits = file.design_space, file.goal.constraints.names()
    assert space is not None
    evaluator = MotorEvaluator(file.text)

    def evaluate(point: Point) -> ValueAt:
        found = evaluator(point)
        constraints = np.array([found.constraints[each] for each in limits]) + SAFETY
        sound = np.isfinite(found.physical_objective) and np.all(np.isfinite(constraints))
        failure = found.failure or (None if sound else "a constraint is not finite")
        return ValueAt(found.physical_objective, constraints, failure)

    given = tuple(map(float, space.locate(file.system)))
    return SearchProblem(
        name,
        space.dimension,
        len(limits),
        BUDGET,
        evaluate,
        evaluator.slopes,
        evaluator.approximate,
        (given,),
        best=BEST[name],
        source=FILES[name],
        long_budget=LONG_BUDGET,
    )


MOTORS = {name: partial(motor, name) for name in FILES}

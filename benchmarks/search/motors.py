"""The three example motors: their shipped design spaces, judged as a study judges them.

Objective without penalty and constraints each drawn in by `SAFETY`, at search resolution:
what `camring optimise` shows its own search.
"""

from functools import partial
from pathlib import Path

import numpy as np

import camring
from benchmarks.search.problem import Outcome, Point, SearchProblem
from camring.interfaces.evaluator import MotorEvaluator
from camring.interfaces.record import SAFETY

EXAMPLES = Path(__file__).parents[2] / "examples"
BUDGET, LONG_BUDGET = 200, 1000
BEST = {"wheel": 0.0576141, "winch": 0.0650180, "mill": 0.0380432}
"""Where descents with exact slopes end from every start: `--methods gradient` ends there."""


def motor(name: str) -> SearchProblem:
    """The motor of `examples/NAME_motor.toml`; its own design is given, which each seed moves."""
    file = camring.read_motor_file(EXAMPLES / f"{name}_motor.toml")
    space, limits = file.design_space, file.goal.constraints.names()
    assert space is not None
    evaluator = MotorEvaluator(file.text)

    def evaluate(point: Point) -> Outcome:
        found = evaluator(point)
        constraints = np.array([found.constraints[each] for each in limits]) + SAFETY
        sound = np.isfinite(found.physical_objective) and np.all(np.isfinite(constraints))
        failure = found.failure or (None if sound else "a constraint is not finite")
        return Outcome(found.physical_objective, constraints, failure)

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
        source=f"examples/{name}_motor.toml",
        long_budget=LONG_BUDGET,
    )


MOTORS = {name: partial(motor, name) for name in ("wheel", "winch", "mill")}

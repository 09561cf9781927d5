"""Which strategy searches a motor's design space."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from camring.evaluation.evaluator import MotorEvaluator
from camring.evaluation.user_programs.evaluator import UserEvaluator
from camring.files.motor import MotorFile, missing_design_space
from camring.files.motor.goal_tables import BAYESIAN, GRADIENT, SCBO
from camring.objective.theory import theory_designs
from camring.search.bayesian import Bayesian
from camring.search.descent.gradient import GradientSearch
from camring.search.problem import AbstractStrategy
from camring.search.scbo import Scbo
from camring.search.strategies import Task, strategy_named, then_descent

MOST_THEORY_DESIGNS = 6
FEWEST_TO_LEAN = 8
"""Evaluations before a search that leans on our whole simulation begins to lean."""


def first_points(motor_file: MotorFile, *, theory: bool) -> Float[np.ndarray, "points dimension"]:
    """The given motor, always, and what theory recommends."""
    space = motor_file.design_space
    if space is None:
        raise missing_design_space(motor_file.path)
    given = space.locate(motor_file.system)[None]
    if not theory:
        return given
    recommended = theory_designs(
        motor_file.system, space, motor_file.goal.constraints, MOST_THEORY_DESIGNS
    )
    return np.concatenate([given, recommended])


def strategy_for(
    motor_file: MotorFile,
    method: str,
    evaluator: MotorEvaluator | UserEvaluator,
    first: Sequence[Float[np.ndarray, " dimension"]],
    budget: int,
    batch: int = 1,
) -> AbstractStrategy:
    """Descent by exact gradients, or a search that learns from evaluations, in batches."""
    space = motor_file.design_space
    assert space is not None
    settings = motor_file.search
    given = tuple(tuple(map(float, point)) for point in first)
    if method == GRADIENT:
        assert isinstance(evaluator, MotorEvaluator), "a user's own program has no slopes"
        return GradientSearch(space.dimension, evaluator.slopes, given)
    initial = FEWEST_TO_LEAN if isinstance(evaluator, UserEvaluator) else None
    if method == SCBO:
        return Scbo(space.dimension, evaluator.approximate, given, initial, batch)
    if method != BAYESIAN:
        task = Task(space.dimension, budget, given, evaluator.approximate, batch=batch)
        return strategy_named(method, task)
    learning = Bayesian(
        dimension=space.dimension,
        approximate=evaluator.approximate,
        given=given,
        initial=initial,
        mode="penalised" if settings.mode == "penalised" else "separate",
        penalty_weight=motor_file.goal.weights.penalty,
        kappa=settings.kappa,
        batch=batch,
    )
    return then_descent(learning, budget, settings.refinement)

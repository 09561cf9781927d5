"""A search driven from outside is the search that `minimise` drives."""

import json

import numpy as np
import pytest

from camring.search.ask_tell import AskTell
from camring.search.minimise import minimise
from camring.search.problem import Problem, Stop
from camring.search.strategies import STRATEGIES, Task, strategy_named

BUDGET = 12
ENOUGH = {"cma-es": 200}
"""Evaluations to 0.01 in two dimensions, where 60 are too few: after them pycma's median of
40 seeds is 0.016, ours 0.018."""


def bayesian():
    return strategy_named("bayesian", Task(2, BUDGET, given=((0.5, 0.5),)))


def driven(problem, asking, count):
    for _ in range(count):
        point = asking.ask()
        if isinstance(point, Stop):
            break
        objective, constraints, approximation, failure = problem.evaluate(point[None])[0]
        asking.tell(objective, constraints, failure, approximation=approximation)
    return asking


def bits(history):
    return [
        (one.point.tobytes(), one.objective, one.constraints.tobytes(), one.phase)
        for one in history
    ]


def test_it_is_minimise_bit_for_bit(townsend):
    asking = driven(townsend, AskTell(bayesian(), 1, seed=3), BUDGET)
    outcome = minimise(townsend, bayesian(), BUDGET, seed=3)
    assert bits(asking.history) == bits(outcome.history)
    assert asking.best() is asking.history[outcome.best.trial]


def test_it_goes_on_from_history_and_memory(townsend):
    first = driven(townsend, AskTell(bayesian(), 1, seed=3), 8)
    memory = json.loads(json.dumps(first.memory))
    again = AskTell(bayesian(), 1, seed=3, history=first.history, memory=memory)
    assert driven(townsend, again, 2).history[-1].point.tobytes() == (
        driven(townsend, first, 2).history[-1].point.tobytes()
    )


def test_asking_twice_asks_for_the_same_point(townsend):
    asking = AskTell(bayesian(), 1)
    first = asking.ask()
    first[:] = -1.0  # what is done to the answer does not matter
    np.testing.assert_array_equal(asking.ask(), [0.5, 0.5])


def test_a_failure_is_kept_with_its_reason():
    asking = AskTell(bayesian(), 2)
    asking.ask()
    assert asking.tell(np.nan, failure="the rig leaked").failure == "the rig leaked"
    asking.ask()
    assert asking.tell(np.nan, [0.0, 0.0]).failure == "the objective is nan"
    asking.ask()
    assert asking.tell(1.0, [0.0, np.inf]).failure == "constraint 1 is not finite"
    assert asking.best() is None
    assert all(len(one.constraints) == 2 for one in asking.history)


def test_an_answer_needs_a_question_and_every_constraint():
    asking = AskTell(bayesian(), 1)
    with pytest.raises(ValueError, match="ask"):
        asking.tell(1.0, [0.0])
    asking.ask()
    with pytest.raises(ValueError, match="2 constraints"):
        asking.tell(1.0, [0.0, 0.0])


@pytest.mark.parametrize("name", STRATEGIES)
def test_every_strategy_is_had_by_its_name(name):
    centre = np.array([0.3, 0.6])

    def evaluate(points):
        return [(float(np.sum((x - centre) ** 2)), np.zeros(0), np.nan, None) for x in points]

    budget = ENOUGH.get(name, 60)
    task = Task(2, budget, slopes=lambda point: (2 * (point - centre), np.zeros((0, 2))))
    found = minimise(Problem(2, 0, evaluate), strategy_named(name, task), budget)
    np.testing.assert_allclose(found.best.point, centre, atol=0.01)


def test_a_misspelt_strategy_gets_its_neighbour():
    with pytest.raises(ValueError, match="did you mean 'bayesian'"):
        strategy_named("baysian", Task(2, 10))
    with pytest.raises(ValueError, match="needs slopes"):
        strategy_named("gradient", Task(2, 10))

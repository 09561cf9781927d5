"""Points chosen together: what is ahead comes, and a stop in the middle changes no bit."""

import json

import numpy as np
import pytest

from camring.search.bayesian import Bayesian
from camring.search.cma_es import CmaEs
from camring.search.descent.gradient import GradientSearch
from camring.search.hybrid import Hybrid, Stage
from camring.search.minimise import minimise
from camring.search.nelder_mead import NelderMead
from camring.search.problem import Problem
from camring.search.scbo import Scbo

BUDGET = 18


def no_slopes(point):
    raise AssertionError("the initial design needs none")


STRATEGIES = {
    "scbo": lambda: Scbo(2, batch=4),
    "cma-es": lambda: CmaEs(2, batch=4),
    "bayesian": lambda: Bayesian(2, batch=4, convergence=None),
    "penalised": lambda: Bayesian(2, batch=3, mode="penalised", convergence=None),
    "simplex": lambda: NelderMead(2, start=(0.4, 0.6)),
    # Its first stage ends in the middle of a batch.
    "hybrid": lambda: Hybrid((Stage(CmaEs(2, batch=4), 6), Stage(NelderMead(2)))),
    "gradient": lambda: Hybrid((Stage(GradientSearch(2, no_slopes), 8), Stage(NelderMead(2)))),
    "differences": lambda: Hybrid((Stage(CmaEs(2, batch=3), 4), Stage(GradientSearch(2)))),
}


@pytest.fixture(scope="module", params=STRATEGIES)
def searched(request, townsend):
    memories = []
    strategy = STRATEGIES[request.param]()  # whose loop waits no longer than these tests
    found = minimise(
        townsend,
        strategy,
        BUDGET,
        seed=5,
        on_evaluation=lambda _, memory: memories.append(json.dumps(memory)),
    )
    return strategy, [one.point.tobytes() for one in found.history], memories, found.history


def test_points_ahead_are_those_that_come(searched):
    strategy, points, memories, _ = searched
    sometimes = False
    for place, memory in enumerate(memories, start=1):
        ahead = [point.tobytes() for point in strategy.ahead(place, json.loads(memory))]
        assert ahead[: BUDGET - place] == points[place : place + len(ahead)]
        sometimes |= len(ahead) > 0
    assert sometimes


def test_a_batch_goes_on_with_the_same_bits_after_a_stop(searched):
    strategy, points, memories, history = searched
    for cut in range(1, BUDGET):
        again = strategy.propose(history[:cut], json.loads(memories[cut - 1]), 5)
        assert again.point.tobytes() == points[cut], cut
        assert json.dumps(again.memory) == memories[cut], cut


def test_no_point_of_a_batch_is_another(searched):
    _, points, _, _ = searched
    assert len(set(points)) == BUDGET


def test_a_bayesian_search_in_batches_finds_a_minimum_of_branin(branin):
    best = minimise(branin, Bayesian(2, batch=4, convergence=None), 42, seed=0).best
    assert best.objective == pytest.approx(0.397887, rel=1e-3)


@pytest.mark.parametrize("batch", [1, 2, 3, 5, 8])
def test_a_generation_is_a_whole_number_of_batches(batch):
    flat = Problem(2, 0, lambda points: [(0.0, np.zeros(0), np.nan, None)])
    memory = minimise(flat, CmaEs(2, initial=3, batch=batch), 4).memory
    generation = 1 + len(memory["ahead"])
    assert generation % batch == 0
    assert generation >= 6

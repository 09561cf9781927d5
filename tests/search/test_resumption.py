"""A search stopped anywhere goes on with the same bits, in another process too."""

import json
import subprocess
import sys

import numpy as np
import pytest

from camring.search.bayesian import Bayesian
from camring.search.convergence import Convergence
from camring.search.hybrid import Hybrid, Stage
from camring.search.minimise import minimise
from camring.search.nelder_mead import NelderMead
from camring.search.problem import Evaluation

BAYESIAN, REFINEMENT = 30, 8


def hybrid():
    return Hybrid(
        (
            Stage(Bayesian(2, given=((0.5, 0.5),), convergence=None), BAYESIAN),
            Stage(NelderMead(2), REFINEMENT),
        )
    )


@pytest.fixture(scope="module")
def whole(townsend):
    memories = []
    outcome = minimise(
        townsend,
        hybrid(),
        60,
        seed=7,
        on_evaluation=lambda evaluation, memory: memories.append(json.dumps(memory)),
    )
    return outcome, memories


def test_any_trial_is_proposed_again_with_the_same_bits(whole):
    outcome, memories = whole
    for cut in range(len(outcome.history)):
        memory = json.loads(memories[cut - 1]) if cut else {}
        again = hybrid().propose(outcome.history[:cut], memory, 7)
        assert again.point.tobytes() == outcome.history[cut].point.tobytes(), cut
        assert json.dumps(again.memory) == memories[cut], cut


def test_phases_follow_each_other_within_their_budgets(whole):
    outcome, _ = whole
    phases = [one.phase for one in outcome.history]
    assert phases == (
        ["initial"] * 6 + ["bayesian"] * (BAYESIAN - 6) + ["nelder-mead"] * REFINEMENT
    )
    assert "budget of 30" in outcome.stop_reason
    assert "budget of 8" in outcome.stop_reason


def test_refinement_only_improves(whole):
    outcome, _ = whole
    before = minimise_best(outcome.history[:BAYESIAN])
    assert outcome.best.rank() <= before.rank()


def minimise_best(history):
    return min(history, key=Evaluation.rank)


ELSEWHERE = """
import json, sys
import numpy as np
from camring.search.bayesian import Bayesian
from camring.search.problem import Evaluation
rows, memory = json.loads(sys.stdin.read())
history = [
    Evaluation(trial, np.array(point), value, np.array(constraints), phase=phase)
    for trial, (point, value, constraints, phase) in enumerate(rows)
]
proposal = Bayesian(2, convergence=None).propose(history, memory, 7)
print(json.dumps([proposal.point.tolist(), proposal.memory]))
"""


def test_another_process_proposes_the_same_bits(townsend):
    memories = []
    outcome = minimise(
        townsend,
        Bayesian(2, convergence=None),
        26,
        seed=7,
        on_evaluation=lambda evaluation, memory: memories.append(memory),
    )
    cut = 25
    rows = [
        [one.point.tolist(), one.objective, one.constraints.tolist(), one.phase]
        for one in outcome.history[:cut]
    ]
    answer = subprocess.run(
        [sys.executable, "-c", ELSEWHERE],
        input=json.dumps([rows, memories[cut - 1]]),
        capture_output=True,
        text=True,
        check=True,
    )
    point, memory = json.loads(answer.stdout)
    assert point == outcome.history[cut].point.tolist()
    assert memory == memories[cut]


def test_minimise_continues_where_it_stopped(branin):
    strategy = Bayesian(2, convergence=None)
    at_once = minimise(branin, strategy, 14, seed=2)
    half = minimise(branin, strategy, 9, seed=2)
    rest = minimise(branin, strategy, 14, seed=2, history=half.history, memory=half.memory)
    assert [one.point.tolist() for one in rest.history] == [
        one.point.tolist() for one in at_once.history
    ]
    assert rest.memory == at_once.memory


def test_another_seed_searches_elsewhere(branin):
    first, second = (minimise(branin, Bayesian(2), 6, seed=seed) for seed in (0, 1))
    assert not np.array_equal(first.history[3].point, second.history[3].point)


def test_a_converged_stage_hands_over(branin):
    strategy = Hybrid(
        (
            Stage(Bayesian(2, convergence=Convergence(window=15, gain=1e-3))),
            Stage(NelderMead(2, step=0.01)),
        )
    )
    outcome = minimise(branin, strategy, 300)
    assert "Converged by objective" in outcome.stop_reason
    assert "simplex" in outcome.stop_reason
    assert outcome.best.objective == pytest.approx(0.3978873577, abs=1e-7)

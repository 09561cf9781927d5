"""A cheap study that runs through the real store, folder, lock and loop.

Also a program: `python fake_study.py FOLDER BUDGET SECONDS_PER_EVALUATION [WORKERS]`
creates the study, or goes on with it, and ends with the exit code of `camring`. With
workers it searches in batches of four.
"""

import functools
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from camring.evaluation.executors import InThisProcess, Workers
from camring.evaluation.interrupt import Interruption
from camring.evaluation.outcome import Outcome
from camring.files.errors import CamringError
from camring.search.problem import AbstractStrategy, Proposal, Stop
from camring.studies.coordinator import Search, search
from camring.studies.study_folder import StudyFolder

GIVEN = b"# a motor file is only bytes to the store\n[motor]\npistons = 8\n"
DIMENSION = 3


class Wanderer(AbstractStrategy):
    """Steps from the best point so far; every step leans on history, memory and seed."""

    def propose(self, history, memory, seed):
        if len(history) >= 400:
            return Stop("the wanderer is tired")
        random = np.random.default_rng([seed, len(history)])
        if not history:
            return Proposal(np.full(DIMENSION, 0.5), "given", {"step": 0.3, "drift": 0.1})
        usable = [evaluation for evaluation in history if not evaluation.failed]
        best = min(usable, key=lambda evaluation: evaluation.rank())
        # An irrational-looking number that would show any lost bit.
        drift = (memory["drift"] * np.pi + history[-1].point[0]) % 1.0
        step = memory["step"] * (1.1 if best is history[-1] else 0.97)
        point = best.point + step * (random.random(DIMENSION) - drift)
        return Proposal(np.clip(point, 0, 1), "walk", {"step": step, "drift": drift})


def evaluate(point, seconds=0.0):
    time.sleep(seconds)
    if point[0] > 0.55:
        raise ValueError("the first number is too large")
    distance = float(np.sum((point - [0.3, 0.6, 0.1]) ** 2))
    limits = {"edge": float(0.2 - point[0]), "sum": float(np.sum(point) - 1.4)}
    terms = [{"distance": distance, "edge": float(point[k])} for k in range(2)]
    return Outcome(
        objective=distance + sum(max(0.0, limit) for limit in limits.values()),
        physical_objective=distance,
        approximation=distance**2,
        constraints=limits,
        terms=terms,
        results=[{"torque_ripple": distance / 3}, {"torque_ripple": float("nan")}],
        design={"motor.bore": float(point[0]), "motor.cam.control_radii": [0.1, float(point[1])]},
    )


def in_batches():
    """Its first stage ends in the middle of a batch, the second proposes one point or several."""
    # Here, for they bring SciPy's statistics, and processes are started by the dozen.
    from camring.search.cma_es import CmaEs
    from camring.search.hybrid import Hybrid, Stage
    from camring.search.nelder_mead import NelderMead

    return Hybrid((Stage(CmaEs(DIMENSION, batch=4), 26), Stage(NelderMead(DIMENSION))))


def task(budget=60, seed=7, seconds=0.0, strategy=None):
    return Search(
        evaluate=functools.partial(evaluate, seconds=seconds),
        constraints=("edge", "sum"),
        strategy=strategy or Wanderer(),
        budget=budget,
        seed=seed,
    )


def open_or_create(path):
    if path.exists():
        return StudyFolder.open(path, write=True)
    return StudyFolder.create(path, GIVEN, {"seed": "7"})


def run(path, budget=60, seed=7, seconds=0.0, strategy=None, executor=None, evaluator=None):
    """Goes on with the study at `path`, creating it when there is none; its reason to stop."""
    folder, what = open_or_create(path), task(budget, seed, seconds, strategy)
    if evaluator is not None:
        what = replace(what, evaluate=evaluator)
    try:
        with Interruption() as interruption:
            return search(what, folder.store, executor or InThisProcess(), interruption)
    finally:
        folder.close()


def sequence(path):
    """Everything that must be the same bits after an interruption; times are not."""
    folder = StudyFolder.open(path, write=False)
    try:
        records, memory = folder.store.records(), folder.store.memory()
    finally:
        folder.close()
    rows = [
        (record.trial, record.phase, record.point.tobytes(), repr(record.outcome))
        for record in records
    ]
    return rows, memory


if __name__ == "__main__":
    where, evaluations, pause = Path(sys.argv[1]), int(sys.argv[2]), float(sys.argv[3])
    try:
        if len(sys.argv) > 4:
            with Workers(int(sys.argv[4])) as workers:
                run(where, evaluations, seconds=pause, strategy=in_batches(), executor=workers)
        else:
            run(where, evaluations, seconds=pause)
    except CamringError as error:
        print(error, file=sys.stderr)
        sys.exit(error.exit_code)

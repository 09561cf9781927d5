"""camring's searches, by their names in `search/strategies.py` and with their own defaults."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.search.oracle import Oracle
from camring.search.ask_tell import AskTell
from camring.search.hybrid import Hybrid, Stage
from camring.search.nelder_mead import NelderMead
from camring.search.problem import AbstractStrategy, Evaluation, Memory, Proposal, Stop
from camring.search.sampling import initial_point
from camring.search.strategies import Task, strategy_named


@dataclass(frozen=True)
class FirstPoints(AbstractStrategy):
    """The points given, then Sobol's: for a strategy that has no initial design of its own."""

    dimension: int
    given: tuple[tuple[float, ...], ...]

    def propose(self, history: Sequence[Evaluation], memory: Memory, seed: int) -> Proposal | Stop:
        point = initial_point(len(history), self.dimension, seed, self.given)
        return Proposal(point, "initial")


def run(oracle: Oracle, name: str, reduced_model: bool = False) -> str:
    """Asks and tells until the strategy stops, which it says why, or the budget is spent."""
    problem = oracle.problem
    guess = problem.approximate if reduced_model else None
    task = Task(oracle.dimension, oracle.budget, oracle.given, guess, oracle.slopes)
    strategy = strategy_named(name, task)
    if name == "nelder-mead":
        first = FirstPoints(oracle.dimension, oracle.given)
        simplex = NelderMead(oracle.dimension)
        strategy = Hybrid((Stage(first, oracle.dimension + 2), Stage(simplex, None)))
    asking = AskTell(strategy, oracle.constraint_count, oracle.seed)
    while True:
        point = asking.ask()
        if isinstance(point, Stop):
            return point.reason
        found = oracle.outcome(point)
        near = np.nan if guess is None else float(guess(np.asarray(point)[None])[0])
        asking.tell(found.objective, found.constraints, found.failure, approximation=near)

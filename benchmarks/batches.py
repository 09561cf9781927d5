"""What it costs to choose several designs at once, none of which knows the others' results.

Hartmann's function of six variables (minimum -3.32237; Dixon and Szego 1978): evaluations
until the best is within 1 % of it, and rounds, in which a worker for each of a batch evaluates
once.

    python -m benchmarks.batches [SEEDS] [BUDGET]
"""

import sys

import numpy as np

from benchmarks.search.published import hartmann6
from camring.search.bayesian import Bayesian
from camring.search.minimise import minimise
from camring.search.problem import Problem
from camring.search.scbo import Scbo


def main():
    published = hartmann6()

    def evaluate(points):
        found = published.evaluate(points[0])
        return [(found.objective, found.constraints, np.nan, found.failure)]

    problem = Problem(published.dimension, 0, evaluate)
    seeds, budget = (int(each) for each in (*sys.argv[1:], "3", "100")[:2])
    print("| method | batch | evaluations to 1 %, seed by seed | rounds | best at the end |")
    print("|---|---|---|---|---|")
    for name, method in {
        "bayesian": lambda batch: Bayesian(6, batch=batch, convergence=None),
        "scbo": lambda batch: Scbo(6, batch=batch),
    }.items():
        for batch in (1, 2, 4, 8):
            needed, ends = [], []
            for seed in range(seeds):
                history = minimise(problem, method(batch), budget, seed).history
                best = np.minimum.accumulate([one.objective for one in history])
                reached = np.flatnonzero(best <= 0.99 * published.best)
                needed.append(int(reached[0]) + 1 if len(reached) else None)
                ends.append(f"{best[-1]:.4f}")
            rounds = [str(-(-each // batch)) if each else "-" for each in needed]
            counts = [str(each) if each else "never" for each in needed]
            print(
                f"| {name} | {batch} | {', '.join(counts)} | {', '.join(rounds)} "
                f"| {', '.join(ends)} |",
                flush=True,
            )


if __name__ == "__main__":
    main()

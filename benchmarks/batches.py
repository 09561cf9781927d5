"""What it costs to choose several designs at once, none of which knows the others' results.

Hartmann's function of six variables (minimum -3.32237; Dixon and Szego 1978): evaluations
until the best is within 1 % of it, and rounds, in which a worker for each of a batch evaluates
once.

    python benchmarks/batches.py [SEEDS] [BUDGET]
"""

import sys

import numpy as np

from camring.search.bayesian import Bayesian
from camring.search.minimise import minimise
from camring.search.problem import Problem
from camring.search.scbo import Scbo

MINIMUM = -3.32237
WEIGHTS = np.array([1.0, 1.2, 3.0, 3.2])
CURVATURE = np.array(
    [
        [10, 3, 17, 3.5, 1.7, 8],
        [0.05, 10, 17, 0.1, 8, 14],
        [3, 3.5, 1.7, 10, 17, 8],
        [17, 8, 0.05, 10, 0.1, 14],
    ]
)
CENTRES = 1e-4 * np.array(
    [
        [1312, 1696, 5569, 124, 8283, 5886],
        [2329, 4135, 8307, 3736, 1004, 9991],
        [2348, 1451, 3522, 2883, 3047, 6650],
        [4047, 8828, 8732, 5743, 1091, 381],
    ]
)


def hartmann(points):
    exponents = np.sum(CURVATURE * (points[0] - CENTRES) ** 2, axis=1)
    return [(float(-WEIGHTS @ np.exp(-exponents)), np.zeros(0), np.nan, None)]


def main():
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
                history = minimise(Problem(6, 0, hartmann), method(batch), budget, seed).history
                best = np.minimum.accumulate([one.objective for one in history])
                reached = np.flatnonzero(best <= 0.99 * MINIMUM)
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

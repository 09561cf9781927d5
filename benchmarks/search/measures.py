"""What a set of runs says: best so far, expected running time, success, quartiles."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from benchmarks.search.traces import Trace

TARGETS = (0.1, 0.01, 0.001)
"""Excess over the best known value, relative to it."""
SLOPES_COST = 2.0
"""Evaluations that the slopes at one point count for where they are not free."""


def reached_after(trace: Trace, best: float, target: float, slopes_cost: float = 0.0) -> float:
    """Evaluations until a feasible point is so near the best known value; infinite if never.

    Parameters
    ----------
    slopes_cost
        What the slopes asked for until then count for, each.
    """
    limit = best + target * abs(best)
    for place, (value, violation) in enumerate(zip(trace.objective, trace.violation, strict=True)):
        if value is not None and violation == 0 and value <= limit:
            return place + 1 + slopes_cost * (trace.slopes[place] if trace.slopes else 0)
    return math.inf


def spent(trace: Trace, slopes_cost: float = 0.0) -> float:
    """Evaluations of the whole run."""
    return len(trace.objective) + slopes_cost * (trace.slopes[-1] if trace.slopes else 0)


@dataclass(frozen=True)
class RunningTime:
    """How long a method takes to a target.

    Attributes
    ----------
    expected
        Evaluations of all runs until the target or their end, over the runs that
        reached it: what independent restarts would need on average. Infinite when none
        did. Auger and Hansen (2005).
    longest
        Evaluations of the longest run: where none got there, more than these are needed.
    """

    expected: float
    successes: int
    runs: int
    longest: float = 0.0


def running_time(
    traces: Sequence[Trace], best: float, target: float, slopes_cost: float = 0.0
) -> RunningTime:
    """Of one method on one problem."""
    hits = [reached_after(each, best, target, slopes_cost) for each in traces]
    cost = [
        hit if math.isfinite(hit) else spent(each, slopes_cost)
        for hit, each in zip(hits, traces, strict=True)
    ]
    successes = sum(map(math.isfinite, hits))
    expected = sum(cost) / successes if successes else math.inf
    longest = max((spent(each, slopes_cost) for each in traces), default=0.0)
    return RunningTime(expected, successes, len(traces), longest)


def best_so_far(trace: Trace, length: int) -> Float[np.ndarray, " length"]:
    """Lowest feasible objective after each evaluation; infinite before the first feasible one.

    A run that ended earlier keeps its last value.
    """
    values = [
        value if value is not None and violation == 0 else math.inf
        for value, violation in zip(trace.objective, trace.violation, strict=True)
    ][:length]
    values += [math.inf] * (length - len(values))
    return np.minimum.accumulate(values)


def quartiles(traces: Sequence[Trace], best: float, length: int) -> Float[np.ndarray, "3 length"]:
    """First quartile, median and third of the excess over the best known, relative.

    Order statistics that exist (no mean of a number and infinity).
    """
    excess = np.array([best_so_far(each, length) for each in traces])
    excess = np.sort((excess - best) / abs(best), axis=0)
    places = [round(share * (len(traces) - 1)) for share in (0.25, 0.5, 0.75)]
    return excess[places]


def profile(
    groups: Sequence[tuple[Sequence[Trace], float, int]],
    target: float,
    budgets: Float[np.ndarray, " budget"],
    slopes_cost: float = 0.0,
) -> Float[np.ndarray, " budget"]:
    """Share of all runs that are within the target after so many evaluations of each variable.

    Parameters
    ----------
    groups
        For each problem the runs, the best known value and the number of variables; every
        problem counts alike, however many its runs. More and Wild (2009).
    """
    shares = []
    for traces, best, dimension in groups:
        hits = [reached_after(t, best, target, slopes_cost) / (dimension + 1) for t in traces]
        shares.append(np.mean(np.array(hits)[:, None] <= budgets, axis=0))
    return np.mean(shares, axis=0)

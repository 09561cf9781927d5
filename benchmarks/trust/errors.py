"""Whether the error that `simulate` states of itself is honest: against the second solver.

Of every result of every motor the true error over the claimed one. Nothing may lie above 1, for
then the claim was too small. What is nearer to the second solver than that knows itself is counted
apart. The largest of each motor shall not lie far below 1 either, for a claim that is always far
too large says nothing: half of the motors have one above `MEDIAN`.
"""

import argparse
import time
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from both_solvers import RESULTS
from detailed_motors import quiet_case
from motors import STRUCTURES, Case, sound_case, with_drawn_manifold

from benchmarks.accuracy import awkward, hard, sound
from camring.programs.compiled import simulate_to
from camring.reference import OrbitError, independent_results

TOLERANCE = 1e-9  # of the second solver
KNOWN_TO = 2e-8  # its own error, relative to a result
EDGES = (0, 0.01, 0.03, 0.1, 0.3, 1, np.inf)
"""Of the histogram of true error over claimed error."""
MEDIAN = 0.05  # at least, of the largest ratio of each motor of which one is known


def kinds(place: int) -> Iterator[tuple[str, Case]]:
    """The motor of this number of every kind."""
    for group in (sound, awkward, hard):
        for kind in group([place]):
            yield kind.name, kind.cases[0]
    yield "hardly any ripple", quiet_case(place)
    random = np.random.default_rng([606, place])
    yield "manifold", with_drawn_manifold(sound_case(place, STRUCTURES[0]), random)


def ratios(case: Case) -> dict[str, float] | None:
    """Of every result; NaN where the second solver cannot tell. None for a motor refused.

    Raises
    ------
    OrbitError
        Where the second solver finds no orbit.
    """
    found = simulate_to(*case)
    if int(found.cycle.verdict.code):
        return None
    truth = independent_results(case.motor, case.fluid, case.point, tolerance=TOLERANCE)
    ratio = {}
    for name in RESULTS:
        off = abs(float(getattr(found.metrics, name)) - truth[name])
        claim = float(getattr(found.error, name))
        unsure = KNOWN_TO * abs(truth[name])
        # The second solver's own error is not held against the claim.
        if off <= unsure or not np.isfinite(truth[name]):
            ratio[name] = np.nan
        else:
            ratio[name] = (off - unsure) / claim if claim > 0 else np.inf
    return ratio


def errors(asked: argparse.Namespace) -> int:
    """So many motors of each kind; how many claims were too small."""
    began = time.process_time()
    found: dict[str, list[float]] = defaultdict(list)
    greatest: list[float] = []
    counts, wrong = Counter[str](), 0
    for place in range(asked.first, asked.count):
        for kind, case in kinds(place + 10_000 * asked.seed):
            try:
                ratio = ratios(case)
            except OrbitError as error:
                counts["without an orbit of the second solver"] += 1
                print(f"{kind}, {place}: the second solver: {error}")
                continue
            if ratio is None:
                counts["refused, nothing claimed"] += 1
                continue
            counts["compared"] += 1
            found[kind] += ratio.values()
            known = [each for each in ratio.values() if not np.isnan(each)]
            greatest += [max(known)] if known else []
            for name, value in ratio.items():
                if value > 1:
                    wrong += 1
                    print(f"{kind}, {place}: {name} is wrong by {value:.3g} times what it says")
    _print(found)
    print(f"{dict(counts)}; {time.process_time() - began:.0f} s of processor time")
    median, of_results = (
        float(np.median([each for each in values if not np.isnan(each)]))
        for values in (greatest, [each for row in found.values() for each in row])
    )
    print(
        f"median {median:.3g} of the largest of {len(greatest)} motors, {of_results:.3g} of results"
    )
    print(f"{wrong} claims too small")
    return wrong + (median < MEDIAN)


def _print(found: Mapping[str, Sequence[float]]) -> None:
    """How many results of each kind lie in each class of the ratio."""
    words = [f"to {edge:g}" if np.isfinite(edge) else "above" for edge in EDGES[1:]]
    print("kind".ljust(44) + "".join(each.rjust(9) for each in ["not known", *words, "largest"]))
    for kind, values in found.items():
        row = np.array(values)
        known = row[~np.isnan(row)]
        counted = np.histogram(known, EDGES)[0]
        cells = [len(row) - len(known), *counted.tolist()]
        greatest = f"{np.max(known):.3g}" if len(known) else "-"
        print(kind.ljust(44) + "".join(f"{each:9d}" for each in cells) + greatest.rjust(9))


__all__ = ["errors", "kinds", "ratios"]

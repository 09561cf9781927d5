"""Runs what is missing of the campaign: every problem, method and seed, once each.

    pip install --constraint constraints.txt ".[rivals-search]"
    python -m benchmarks.search [--problems wheel g07 ...] [--methods scbo "Optuna TPE" ...]
        [--seeds 15] [--minutes 45] [--out benchmarks/results/search]

Stopped at any time it goes on where it was. Five seeds of every method come first, cheap
methods before expensive ones, then five more. A library that is not installed is left out
with a word.
"""

import argparse
import sys
import time
from pathlib import Path

from camring.programs.compilation_cache import keep_compiled_programs

SEEDS_TOGETHER = 5


def main() -> None:
    keep_compiled_programs()  # before JAX is imported

    from benchmarks.search.methods import METHODS
    from benchmarks.search.motors import MOTORS
    from benchmarks.search.oracle import Oracle, Reached, Spent
    from benchmarks.search.published import PUBLISHED
    from benchmarks.search.traces import RESULTS, keep, kept, pack, trace_of
    from camring.search.threads import one_linear_algebra_thread

    makers = {**PUBLISHED, **MOTORS}
    parser = argparse.ArgumentParser(prog="python -m benchmarks.search", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--problems", nargs="+", choices=list(makers), default=list(makers))
    parser.add_argument("--methods", nargs="+", choices=list(METHODS), default=list(METHODS))
    parser.add_argument("--seeds", type=int, default=15)
    parser.add_argument("--minutes", type=float, default=45.0, help="begin no run after these")
    parser.add_argument("--out", type=Path, default=RESULTS, help="folder of the traces")
    asked = parser.parse_args()

    done = kept(asked.out)
    problems = {name: makers[name]() for name in asked.problems}
    missing: set[str] = set()
    started = time.monotonic()
    for seed, problem, name in in_turn(asked.seeds, problems, asked.methods):
        method = METHODS[name]
        if (problem.name, name, seed) in done or name in missing:
            continue
        if time.monotonic() - started > 60 * asked.minutes:
            print(f"{asked.minutes:g} minutes are over; run again to go on.")
            break
        oracle = Oracle(problem, seed, method.budget(problem))
        clock, processor = time.perf_counter(), time.process_time()
        try:
            with one_linear_algebra_thread():
                ended = method.run(oracle)
        except Reached:
            ended = "As good as the best known."
        except Spent:
            ended = "The budget is spent."
        except ImportError as error:
            missing.add(name)
            print(f"{name} is left out: {error}", file=sys.stderr)
            continue
        seconds, processor = time.perf_counter() - clock, time.process_time() - processor
        trace = trace_of(oracle, name, seconds, ended, processor)
        keep(trace, asked.out)
        print(said(trace), file=sys.stderr, flush=True)
    pack(asked.out)


def in_turn(seeds: int, problems, names):
    """Runs in the order of the campaign: some seeds of all that is cheap, then the expensive."""
    from benchmarks.search.methods import METHODS

    runs = [
        (seed, problem, name)
        for seed in range(seeds)
        for problem in problems.values()
        for name in names
        if problem.approximate is not None or not METHODS[name].only_motors
    ]
    return sorted(runs, key=lambda run: (run[0] // SEEDS_TOGETHER, METHODS[run[2]].cost))


def said(trace) -> str:
    sound = zip(trace.objective, trace.violation, strict=True)
    best = min((j for j, v in sound if j is not None and v == 0), default=None)
    return (
        f"{trace.problem:16} {trace.method:20} {trace.seed:2d}  "
        f"{len(trace.objective):3d} evaluations, {trace.seconds:7.2f} s, best {best}"
    )


if __name__ == "__main__":
    main()

"""What a second worker is worth: whole studies with an evaluator of 50 ms, kept on disk.

The evaluator waits, as for a licence, a test rig or another machine; with --computes it
keeps a core busy instead. Time is that of the study: proposals, evaluations, database. The
start of the workers is left out; they have evaluated one point each before the clock runs.

    python benchmarks/workers.py [--computes] [--dask] [--evaluations 160]
"""

import argparse
import functools
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from camring.evaluation.executors import Workers
from camring.evaluation.interrupt import Interruption
from camring.evaluation.outcome import Outcome
from camring.search.strategies import Task, strategy_named
from camring.studies.coordinator import Search, search
from camring.studies.study_folder import StudyFolder

SECONDS, DIMENSION = 0.05, 6
GIVEN = b"# no motor: the study's loop and its database only\n"


def evaluate(point, computes):
    if computes:
        end = time.thread_time() + SECONDS  # of a core, however many others want it
        while time.thread_time() < end:
            pass
    else:
        time.sleep(SECONDS)
    value = float(np.sum((np.asarray(point) - 0.3) ** 2))
    return Outcome(value, {"edge": 0.2 - float(point[0])}, value)


@contextmanager
def local_cluster(count):
    from distributed import LocalCluster

    from camring.evaluation.dask_cluster import Cluster

    with (
        LocalCluster(n_workers=count, threads_per_worker=1, dashboard_address=":0") as local,
        Cluster(local.scheduler_address) as cluster,
    ):
        yield cluster


def seconds(executors, count, method, batch, evaluations, computes):
    """Wall time of a study, the workers being awake."""
    asked = functools.partial(evaluate, computes=computes)
    strategy = strategy_named(method, Task(DIMENSION, evaluations, batch=batch))
    task = Search(asked, ("edge",), strategy, evaluations, seed=1)
    with executors(count) as executor, tempfile.TemporaryDirectory() as place:
        wake = [executor.submit(asked, np.full(DIMENSION, 0.5)) for _ in range(2 * count)]
        for future in wake:
            future.result()
        folder = StudyFolder.create(Path(place) / "study", GIVEN, {})
        began = time.perf_counter()
        with Interruption() as interruption:
            search(task, folder.store, executor, interruption)
        took = time.perf_counter() - began
        folder.close()
    return took


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--computes", action="store_true")
    parser.add_argument("--dask", action="store_true")
    parser.add_argument("--evaluations", type=int, default=160)
    parser.add_argument("--methods", nargs="*", default=["cma-es", "scbo", "bayesian"])
    chosen = parser.parse_args()
    executors = local_cluster if chosen.dask else Workers
    print("| method | one worker | two, batches of 2 | ratio | two, batches of 4 | ratio |")
    print("|---|---|---|---|---|---|")
    for method in chosen.methods:
        run = functools.partial(
            seconds,
            executors,
            method=method,
            evaluations=chosen.evaluations,
            computes=chosen.computes,
        )
        if method in ("scbo", "bayesian"):  # what their proposals need is compiled first
            run(2, batch=2)
        alone = run(1, batch=1)
        pair, four = run(2, batch=2), run(2, batch=4)
        print(
            f"| {method} | {alone:.2f} s | {pair:.2f} s | {alone / pair:.2f} "
            f"| {four:.2f} s | {alone / four:.2f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()

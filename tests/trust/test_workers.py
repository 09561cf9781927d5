"""Workers that are frozen, answer late, or lose their scheduler: the study is that of one alone."""

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import fake_study
import pytest
from processes import lives, note_first_then, note_process, wait_for

from camring.evaluation.dask_cluster import Cluster
from camring.evaluation.executors import Workers
from camring.evaluation.queue import WorkersGone
from camring.evaluation.user_programs.process import FunctionFailed

BUDGET = 40
PAUSE = 0.02  # s an evaluation


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    folder = tmp_path_factory.mktemp("alone") / "study"
    fake_study.run(folder, BUDGET, strategy=fake_study.in_batches())
    return fake_study.sequence(folder)


def study(folder, executor):
    fake_study.run(
        folder, BUDGET, seconds=PAUSE, strategy=fake_study.in_batches(), executor=executor
    )


def rows_kept(folder):
    return len(fake_study.sequence(folder)[0]) if (folder / "study.sqlite").exists() else 0


class FrozenInTurn:
    """Stops one process after the other, each for a while, as long as the block runs."""

    def __init__(self, processes, seconds):
        self._processes, self._seconds = processes, seconds
        self._over, self.times = threading.Event(), 0
        self._thread = threading.Thread(target=self._freeze, daemon=True)

    def _freeze(self):
        while not self._over.wait(0.05):
            found = self._processes()
            if not found:
                continue
            process = found[self.times % len(found)]
            os.kill(process, signal.SIGSTOP)
            time.sleep(self._seconds)
            os.kill(process, signal.SIGCONT)
            self.times += 1

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._over.set()
        self._thread.join()


def test_a_study_is_the_same_whoever_is_frozen_for_a_while(tmp_path, alone):
    before = {each.pid for each in multiprocessing.active_children()}

    def workers():
        return sorted({each.pid for each in multiprocessing.active_children()} - before)

    with Workers(2) as executor, FrozenInTurn(workers, 0.2) as frozen:
        study(tmp_path / "study", executor)
    assert frozen.times >= 2
    assert fake_study.sequence(tmp_path / "study") == alone


def note_then(path, seconds):
    note_process(path)
    time.sleep(seconds)
    return os.getpid()


def test_a_worker_that_never_thaws_is_ended_when_its_time_is_up(tmp_path):
    with Workers(1, timeout=1.0) as executor:
        executor.submit(abs, -2).result()  # until it has started
        call = executor.submit(note_then, tmp_path / "process", 0.2)
        wait_for((tmp_path / "process").exists)
        frozen = int((tmp_path / "process").read_text())
        os.kill(frozen, signal.SIGSTOP)
        with pytest.raises(FunctionFailed, match="1 s"):
            call.result()
        assert executor.submit(os.getpid).result() != frozen
    wait_for(lambda: not lives(frozen))


@pytest.fixture
def cluster():
    """A scheduler that gives up who is silent for 2 s, and two workers that nobody restarts."""
    distributed = pytest.importorskip("distributed")
    import dask

    settings = {"distributed.scheduler.worker-ttl": "2s"}
    with (
        dask.config.set(settings),
        distributed.LocalCluster(n_workers=0, dashboard_address=":0") as scheduler,
    ):
        address = scheduler.scheduler_address
        line = [sys.executable, "-m", "distributed.cli.dask_worker", address, "--no-nanny"]
        line += ["--nthreads", "1", "--no-dashboard"]
        paths = [str(Path(fake_study.__file__).parent), os.environ.get("PYTHONPATH", "")]
        known = {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}
        workers = [subprocess.Popen(line, stderr=subprocess.DEVNULL, env=known) for _ in range(2)]
        try:
            with distributed.Client(address, set_as_default=False) as client:
                client.wait_for_workers(2, timeout=60)
            yield address, [each.pid for each in workers]
        finally:
            for each in workers:
                each.kill()
                each.wait()


def test_what_a_frozen_worker_of_a_cluster_had_is_given_to_another(tmp_path, cluster):
    """It answers when another has long done it; nobody asks it any more."""
    address, workers = cluster
    with Cluster(address) as executor:
        calls = [executor.submit(note_first_then, tmp_path, k, 1.0) for k in range(2)]
        wait_for((tmp_path / "0.process").exists)
        frozen = int((tmp_path / "0.process").read_text())
        assert frozen in workers
        os.kill(frozen, signal.SIGSTOP)
        number, process = calls[0].result(timeout=60)
        os.kill(frozen, signal.SIGCONT)
        assert number == 0
        assert process in workers
        assert process != frozen
        assert calls[1].result(timeout=60)[0] == 1
        # What the thawed one says late goes nowhere: further calls are answered as they are.
        later = [executor.submit(note_first_then, tmp_path, 10 + k, 0.2) for k in range(8)]
        assert [call.result(timeout=60)[0] for call in later] == list(range(10, 18))


def test_a_study_on_a_cluster_is_the_same_whoever_is_frozen(tmp_path, alone, cluster):
    address, processes = cluster
    where = tmp_path / "study"

    def first():
        # Once, while the study runs, and for longer than the scheduler waits.
        return processes[:1] if rows_kept(where) > 3 and not frozen.times else []

    with Cluster(address) as executor, FrozenInTurn(first, 4.0) as frozen:
        study(where, executor)
    assert frozen.times == 1
    assert fake_study.sequence(where) == alone


def test_a_study_goes_on_bit_for_bit_when_the_scheduler_is_back(tmp_path, alone):
    distributed = pytest.importorskip("distributed")

    def local():
        return distributed.LocalCluster(
            n_workers=1, threads_per_worker=2, processes=False, dashboard_address=":0"
        )

    first, where = local(), tmp_path / "study"

    def lost():
        wait_for(lambda: rows_kept(where) > 5)
        first.close()

    with Cluster(first.scheduler_address, patience=1.0) as executor:
        losing = threading.Thread(target=lost)
        losing.start()
        with pytest.raises(WorkersGone, match="can evaluate nothing"):
            study(where, executor)
        losing.join()
    kept = rows_kept(where)
    assert 5 < kept < BUDGET
    with local() as second, Cluster(second.scheduler_address) as executor:
        study(where, executor)
    assert fake_study.sequence(where) == alone

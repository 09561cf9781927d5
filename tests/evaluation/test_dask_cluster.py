"""Evaluations on a cluster of dask.distributed: the same study, and workers that may die."""

import asyncio
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import CancelledError

import fake_study
import pytest
from processes import lives, wait_for

from camring.evaluation import dask_cluster
from camring.evaluation.dask_cluster import Cluster
from camring.evaluation.executors import batch_of, chosen_executor
from camring.evaluation.queue import WorkersGone
from camring.evaluation.user_programs.process import FunctionFailed
from camring.files.errors import InputError

BUDGET = 30


@pytest.fixture(scope="module")
def address():
    distributed = pytest.importorskip("distributed")
    import dask

    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 1}),
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=":0"
        ) as cluster,
    ):
        yield cluster.scheduler_address


def test_a_study_is_the_same_on_a_cluster(tmp_path, address):
    fake_study.run(tmp_path / "here", BUDGET, strategy=fake_study.in_batches())
    with chosen_executor(None, address) as executor:
        assert batch_of(None, executor) == 2
        fake_study.run(
            tmp_path / "there", BUDGET, strategy=fake_study.in_batches(), executor=executor
        )
    assert fake_study.sequence(tmp_path / "there") == fake_study.sequence(tmp_path / "here")


def die(path):
    """The first time only, when a path is given."""
    if path is None or not path.exists():
        if path is not None:
            path.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return os.getpid()


def test_a_call_whose_worker_died_is_repeated_until_too_many_have(tmp_path, address):
    with Cluster(address) as cluster:
        assert cluster.submit(die, tmp_path / "died").result() != os.getpid()
        with pytest.raises(FunctionFailed, match="2 workers died at it"):
            cluster.submit(die, None).result()
        with pytest.raises(ValueError, match="invalid literal"):
            cluster.submit(int, "twelve").result()


STAYING = """
import os, sys
from camring.evaluation.dask_cluster import Cluster
from camring.evaluation.user_programs.command import UserCommand
stay = "import os, time; open('noted', 'w').write(str(os.getpid()) + '.'); time.sleep(3600)"
command = UserCommand((sys.executable, "-S", "-c", stay), 3600.0, os.getcwd())
Cluster(sys.argv[1]).submit(command.results, {}, (), 0).result()
"""


def test_a_kill_leaves_no_program_behind_on_a_cluster(tmp_path, address):
    process = subprocess.Popen([sys.executable, "-c", STAYING, address], cwd=tmp_path)
    noted = tmp_path / "noted"
    try:
        wait_for(lambda: noted.exists() and noted.read_text().endswith("."))
        staying = int(float(noted.read_text()))
        assert lives(staying)
    finally:
        process.kill()
        process.wait()
    wait_for(lambda: not lives(staying))


def test_a_study_stops_in_a_sentence_when_the_scheduler_is_gone(tmp_path):
    distributed = pytest.importorskip("distributed")
    local = distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, dashboard_address=":0"
    )
    with Cluster(local.scheduler_address, patience=1.0) as cluster:
        cluster.submit(abs, -1).result()
        local.close()
        with pytest.raises(WorkersGone, match="can evaluate nothing"):
            fake_study.run(tmp_path / "study", 3, executor=cluster)


def outcomes(cluster):
    return {each.status for each in cluster._client.futures.values()}


async def never(client, *arguments):
    await asyncio.Event().wait()


async def broken(client, *arguments):
    raise OSError("the line broke")


async def without_a_word(client):
    """What a client does whose list of calls changes while it goes through it."""
    client.status = "connecting"
    raise RuntimeError("dictionary changed size during iteration")


@pytest.mark.parametrize(
    ("where", "fault", "seconds"),
    [
        ("_gather_remote", never, 0),
        ("_gather_remote", broken, 0),
        ("_reconnect", without_a_word, 60),
    ],
)
def test_nobody_waits_for_an_answer_lost_with_its_scheduler(monkeypatch, where, fault, seconds):
    """An outcome on its way as the scheduler goes; or a client that forgets who waits."""
    distributed = pytest.importorskip("distributed")
    monkeypatch.setattr(distributed.Client, where, fault)
    monkeypatch.setattr(dask_cluster, "PATIENCE", 1.0)
    local = distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, dashboard_address=":0"
    )
    with Cluster(local.scheduler_address, patience=1.0) as cluster:
        call = cluster.submit(time.sleep, seconds)
        if not seconds:
            wait_for(lambda: outcomes(cluster) == {"finished"})
        local.close()
        with pytest.raises(CancelledError, match="scheduler is gone"):
            call.result(timeout=60)
    monkeypatch.undo()
    with (
        distributed.LocalCluster(
            n_workers=1, threads_per_worker=1, processes=False, dashboard_address=":0"
        ) as local,
        Cluster(local.scheduler_address) as cluster,
    ):
        assert cluster.submit(abs, -1).result(timeout=60) == 1


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("tcp://127.0.0.1:1", "no scheduler answered within 0.2 s"),
        ("host", "missing port number"),
        ("scheduler.json", "which is no file"),
    ],
)
def test_an_address_without_a_scheduler_is_reported_in_a_sentence(given, words):
    pytest.importorskip("distributed")
    with pytest.raises(InputError, match=words):
        Cluster(given, patience=0.2)


def test_a_missing_extra_is_reported_in_a_sentence(monkeypatch):
    monkeypatch.setattr(dask_cluster, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"camring\[dask\]"):
        Cluster("tcp://127.0.0.1:8786")

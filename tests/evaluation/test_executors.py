"""Evaluations run anywhere with the protocol of `concurrent.futures`."""

import functools
import os
import threading
import time

import fake_study
import numpy as np
import pytest

from camring.evaluation.executors import InThisProcess, Workers
from camring.evaluation.interrupt import Interrupted, Interruption
from camring.studies.coordinator import evaluate_or_fail
from camring.studies.study_folder import StudyFolder


def test_one_background_thread_does_everything_in_order():
    executor = InThisProcess()
    threads = [executor.submit(threading.get_ident) for _ in range(5)]
    assert len({future.result() for future in threads}) == 1
    assert threads[0].result() != threading.get_ident()
    assert executor.submit(int, "12").result() == 12
    with pytest.raises(ValueError, match="invalid literal"):
        executor.submit(int, "twelve").result()
    assert list(executor.map(abs, [-1, 2])) == [1, 2]


def test_workers_are_spawned_and_held_to_one_thread():
    with Workers(1) as executor:
        assert executor.submit(os.getpid).result() != os.getpid()
        assert executor.submit(os.getenv, "OMP_NUM_THREADS").result() == "1"
        assert executor.submit(os.getenv, "NPROC").result() == "1"
        with pytest.raises(ValueError, match="invalid literal"):
            executor.submit(int, "twelve").result()


def test_an_evaluator_that_raises_makes_a_failed_evaluation():
    outcome = evaluate_or_fail(fake_study.evaluate, ("edge", "sum"), np.array([0.99, 0.5, 0.5]))
    assert outcome.failure == "ValueError: the first number is too large"
    assert list(outcome.constraints) == ["edge", "sum"]
    assert all(np.isnan(value) for value in outcome.constraints.values())


def test_failed_evaluations_do_not_stop_a_study(tmp_path):
    fake_study.run(tmp_path / "study", budget=150)
    folder = StudyFolder.open(tmp_path / "study", write=False)
    records = folder.store.records()
    folder.close()
    assert len(records) == 150
    assert any(record.failed for record in records)


def test_the_strategys_own_reason_to_stop_is_said(tmp_path):
    assert fake_study.run(tmp_path / "study", budget=1000) == "the wanderer is tired"


def test_an_interruption_does_not_wait_for_the_evaluation():
    executor = InThisProcess()
    began = time.monotonic()
    with Interruption() as interruption:
        threading.Timer(0.2, functools.partial(os.kill, os.getpid(), 2)).start()
        with pytest.raises(Interrupted):
            interruption.run(executor, time.sleep, 60)
    assert time.monotonic() - began < 30

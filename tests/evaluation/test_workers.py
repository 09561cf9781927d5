"""Several workers change how long a search takes and nothing else, whatever befalls them."""

import os
import random
import signal
import threading
import time
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context

import fake_study
import numpy as np
import pytest
from processes import lives, note_process, wait_for

import camring
from camring.evaluation import executors
from camring.evaluation.executors import Workers, batch_of, chosen_executor
from camring.evaluation.interrupt import Interrupted
from camring.evaluation.queue import Desk, WorkersGone
from camring.evaluation.user_programs.process import FunctionFailed
from camring.files.errors import InputError
from camring.studies.study_folder import StudyFolder

BUDGET = 40


class Shuffled(Executor):
    """Carries out what lies there in no order at all."""

    def __init__(self):
        self._random, self._lying, self.carried_out = random.Random(3), [], 0
        threading.Thread(target=self._work, daemon=True).start()

    def submit(self, function, /, *arguments, **named):
        future = Future()
        self._lying.append((future, function, arguments))
        return future

    def _work(self):
        while True:
            time.sleep(0.003)  # until the rest of the batch lies there, too
            if self._lying:
                lying = self._lying.pop(self._random.randrange(len(self._lying)))
                future, function, arguments = lying
                if future.set_running_or_notify_cancel():
                    self.carried_out += 1
                    future.set_result(function(*arguments))


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """A study in batches that the coordinator's own process evaluates."""
    folder = tmp_path_factory.mktemp("alone") / "study"
    fake_study.run(folder, BUDGET, strategy=fake_study.in_batches())
    return fake_study.sequence(folder)


@pytest.mark.parametrize("workers", [1, 2])
def test_a_study_is_the_same_however_many_evaluate(tmp_path, alone, workers):
    with Workers(workers) as executor:
        fake_study.run(
            tmp_path / "study", BUDGET, strategy=fake_study.in_batches(), executor=executor
        )
    assert fake_study.sequence(tmp_path / "study") == alone


def test_a_study_is_the_same_whoever_is_first_and_evaluates_nothing_in_vain(tmp_path, alone):
    executor = Shuffled()
    fake_study.run(tmp_path / "study", BUDGET, strategy=fake_study.in_batches(), executor=executor)
    assert fake_study.sequence(tmp_path / "study") == alone
    assert executor.carried_out == BUDGET


def process_once_there(path):
    """Which process this is, as soon as a file is there."""
    wait_for(path.exists)
    return os.getpid()


def write_process_then(path, seconds):
    """Notes which process this is, then takes its time; at once when asked again."""
    again = path.exists()
    note_process(path)
    if not again:
        time.sleep(seconds)
    return os.getpid()


def test_a_killed_worker_costs_its_own_evaluation_only(tmp_path):
    with Workers(2) as executor:
        beside = executor.submit(process_once_there, tmp_path / "go")
        victim = executor.submit(write_process_then, tmp_path / "process", 60)
        wait_for((tmp_path / "process").exists)
        killed = int((tmp_path / "process").read_text())
        os.kill(killed, signal.SIGKILL)
        repeated_by = victim.result()
        assert repeated_by != killed
        (tmp_path / "go").touch()
        assert beside.result() not in (killed, repeated_by)
        # Whoever was beside has not been started anew.
        pair = {executor.submit(os.getpid).result() for _ in range(8)}
        assert pair <= {repeated_by, beside.result()}


def die(**_):
    os.kill(os.getpid(), signal.SIGKILL)


def die_beyond(point):
    return die() if point[0] > 0.7 else fake_study.evaluate(point)


def test_a_study_goes_on_past_a_point_at_which_workers_die(tmp_path, monkeypatch):
    monkeypatch.setattr(executors, "REPEATS", 1)
    strategy = fake_study.in_batches()
    with Workers(2) as executor:
        fake_study.run(
            tmp_path / "study", 5, strategy=strategy, executor=executor, evaluator=die_beyond
        )
    folder = StudyFolder.open(tmp_path / "study", write=False)
    records = folder.store.records()
    folder.close()
    assert [record.trial for record in records] == list(range(5))
    deadly = [record.outcome.failure for record in records if record.point[0] > 0.7]
    assert deadly
    assert all("2 workers died at it" in failure for failure in deadly)
    assert all("signal 9" in failure for failure in deadly)
    assert not any(record.failed for record in records if record.point[0] <= 0.7)


def test_a_call_that_takes_too_long_is_stopped():
    with Workers(1, timeout=0.5) as executor:
        executor.submit(abs, -2).result()
        with pytest.raises(FunctionFailed, match=r"longer than 0\.5 s"):
            executor.submit(time.sleep, 60).result()


def test_whoever_leaves_in_an_exception_waits_for_nobody(tmp_path):
    def leave():
        with Workers(1) as executor:
            executor.submit(write_process_then, tmp_path / "process", 600)
            wait_for((tmp_path / "process").exists)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        leave()
    wait_for(lambda: not lives(int((tmp_path / "process").read_text())))


class Idle(Executor):
    """Takes everything and does nothing."""

    def __init__(self):
        self.futures = []

    def submit(self, function, /, *arguments, **named):
        self.futures.append(Future())
        return self.futures[-1]


def test_what_nobody_waits_for_any_more_is_not_begun():
    def interrupted(future):
        raise Interrupted("Stopped.")

    idle, points = Idle(), [np.full(2, place / 8) for place in range(4)]
    desk = Desk(idle, sum, str, interrupted)
    with pytest.raises(Interrupted):
        desk.answer(points[0], points[1:3])
    assert not any(future.cancelled() for future in idle.futures)
    with pytest.raises(Interrupted):
        desk.answer(points[2], points[3:])
    assert [future.cancelled() for future in idle.futures] == [True, True, False, False]
    desk.close()
    assert all(future.cancelled() for future in idle.futures)


BOUNDS = {"width": (0.0, 4.0), "height": (-1.0, 1.0)}


def bowl(width, height):
    if width > 3.5:
        raise RuntimeError("mesh tangled")
    return {"objective": (width - 1) ** 2 + height**2, "narrow": 2 - width, "area": width * height}


def minimised(function, **settings):
    return camring.minimise_function(
        function, BOUNDS, ["narrow"], method="cma-es", budget=16, **settings
    )


def test_a_function_is_minimised_by_several_with_the_same_history():
    alone = repr(minimised(bowl, batch=2).history)
    assert "mesh tangled" in alone
    with Workers(2) as processes, ThreadPoolExecutor(2) as threads:
        assert repr(minimised(bowl, executor=processes).history) == alone
        assert repr(minimised(bowl, executor=threads).history) == alone
    assert repr(minimised(bowl, executor=Shuffled(), batch=2).history) == alone


def test_a_pool_that_broke_ends_a_search_in_a_sentence():
    with (
        ProcessPoolExecutor(1, mp_context=get_context("spawn")) as executor,
        pytest.raises(WorkersGone, match=r"can evaluate nothing.*BrokenProcessPool"),
    ):
        minimised(die, executor=executor)


def test_a_function_that_cannot_travel_is_refused():
    with Workers(1) as executor, pytest.raises(WorkersGone, match="can evaluate nothing"):
        minimised(lambda **_: 1.0, executor=executor)


def test_what_cannot_be_used_is_reported_in_a_sentence():
    with pytest.raises(InputError, match="give one of them"), chosen_executor(2, "tcp://host:1"):
        pass
    with pytest.raises(InputError, match="workers is 0"):
        Workers(0)
    with pytest.raises(InputError, match="above zero"):
        Workers(1, timeout=0)
    with Workers(1) as dismissed:
        pass
    with pytest.raises(WorkersGone, match="dismissed"):
        minimised(bowl, executor=dismissed)
    with pytest.raises(InputError, match="batch is 0"):
        minimised(bowl, batch=0)
    with Workers(1) as executor, pytest.raises(InputError, match="executor's own"):
        minimised(bowl, executor=executor, timeout=1.0)


def test_a_batch_is_as_many_as_there_are_workers():
    assert batch_of(None, None) == 1
    assert batch_of(5, None) == 5
    with Workers(3) as processes, ThreadPoolExecutor(2) as threads:
        assert batch_of(None, processes) == 3
        assert batch_of(None, threads) == 2
    nobody = Shuffled()
    nobody.workers = 0
    with pytest.raises(InputError, match="no worker yet"):
        batch_of(None, nobody)

"""Where evaluations run: anything with the `concurrent.futures` protocol.

The study's coordinator hands an evaluator and a point to an executor and waits;
it alone writes. `InThisProcess` is the default; `spawned_processes` starts
workers of one thread each. Processes are spawned, never forked: JAX has threads,
and a fork of a threaded process may stop for ever.
"""

import os
import queue
import threading
from collections.abc import Callable
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any, TypeVar

Result = TypeVar("Result")

ONE_THREAD = {
    "NPROC": "1",  # the size that XLA gives its own pool
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
}
ONE_THREAD_XLA = "--xla_cpu_multi_thread_eigen=false"


class InThisProcess(Executor):
    """One background thread, so that the main thread stays awake for Ctrl-C.

    The thread is a daemon: a compilation that nobody waits for any more does not
    keep the program from ending.
    """

    def __init__(self) -> None:
        self._tasks: queue.SimpleQueue[Callable[[], None] | None] = queue.SimpleQueue()
        threading.Thread(target=self._work, name="camring-evaluations", daemon=True).start()

    def submit(
        self, function: Callable[..., Result], /, *arguments: Any, **named: Any
    ) -> Future[Result]:
        future: Future[Result] = Future()

        def task() -> None:
            if not future.set_running_or_notify_cancel():
                return
            try:
                future.set_result(function(*arguments, **named))
            except BaseException as error:
                future.set_exception(error)

        self._tasks.put(task)
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Takes no more work; what was submitted is still done, unless the program ends."""
        self._tasks.put(None)

    def _work(self) -> None:
        while (task := self._tasks.get()) is not None:
            task()


def spawned_processes(workers: int) -> ProcessPoolExecutor:
    """Worker processes, each held to one thread so that they do not fight for cores."""
    return ProcessPoolExecutor(
        workers, mp_context=get_context("spawn"), initializer=hold_to_one_thread
    )


def hold_to_one_thread() -> None:
    """Has an effect only before JAX is imported."""
    os.environ.update(ONE_THREAD)
    flags = os.environ.get("XLA_FLAGS", "")
    if ONE_THREAD_XLA not in flags:
        os.environ["XLA_FLAGS"] = f"{flags} {ONE_THREAD_XLA}".strip()

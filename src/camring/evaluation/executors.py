"""Where evaluations run: anything with the `concurrent.futures` protocol.

The study's coordinator hands an evaluator and a point to an executor and waits; it
alone writes. `InThisProcess` is the default; `Workers` are processes of one thread
each. Processes are spawned, never forked: JAX has threads, and a fork of a threaded
process may stop for ever.
"""

import os
import queue
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError, Executor, Future
from contextlib import contextmanager
from types import TracebackType
from typing import Any, TypeVar

from camring.evaluation.user_programs.process import FunctionFailed, ProcessEnded, UserProcess
from camring.files.errors import InputError, quote

Result = TypeVar("Result")
Way = Callable[..., Any]
"""Calls its first argument with the others, here or elsewhere."""

PATIENCE = 0.1  # seconds between two attempts to end a process
REPEATS = 2  # of an evaluation whose worker died
ONE_THREAD = {
    "NPROC": "1",  # the size that XLA gives its own pool
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
}


class Threads(Executor):
    """As many background threads as there are ways to call a function.

    They are daemons: a compilation that nobody waits for any more does not keep the
    program from ending.
    """

    def __init__(self, ways: Sequence[Way]) -> None:
        self._closed = False
        self._tasks: queue.SimpleQueue[Callable[[Way], None] | None] = queue.SimpleQueue()
        self._threads = [
            threading.Thread(
                target=self._work, args=(way,), name="camring-evaluations", daemon=True
            )
            for way in ways
        ]
        for thread in self._threads:
            thread.start()

    def submit(
        self, function: Callable[..., Result], /, *arguments: Any, **named: Any
    ) -> Future[Result]:
        """Raises `RuntimeError` after `shutdown`."""
        if self._closed:
            raise RuntimeError("these workers were dismissed")
        future: Future[Result] = Future()

        def task(way: Way) -> None:
            if not future.set_running_or_notify_cancel():
                return
            try:
                future.set_result(way(function, *arguments, **named))
            except BaseException as error:
                future.set_exception(error)

        self._tasks.put(task)
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Takes no more work; what was submitted is still done, unless the program ends."""
        self._closed = True
        for _ in self._threads:
            self._tasks.put(None)

    def _work(self, way: Way) -> None:
        while (task := self._tasks.get()) is not None:
            task(way)


class InThisProcess(Threads):
    """One background thread, so that the main thread stays awake for Ctrl-C."""

    def __init__(self) -> None:
        super().__init__([_call])


class Workers(Threads):
    """Processes of one thread each, so that they do not fight for cores.

    One that dies, for want of memory or by a crash, costs the call that it was at and
    no other: another process takes its place and repeats it, at most twice.

    Parameters
    ----------
    workers
        How many; each is started when there is work for it.
    timeout
        Seconds after which a call is stopped; None waits for ever.

    Raises
    ------
    InputError
        When there would be none, or no time.

    Examples
    --------
    >>> with camring.Workers(4) as workers:  # doctest: +SKIP
    ...     camring.optimise("motor.toml", "study", method="scbo", executor=workers)
    """

    def __init__(self, workers: int, timeout: float | None = None) -> None:
        if isinstance(workers, bool) or not isinstance(workers, int) or workers < 1:
            raise InputError("workers", f"is {quote(workers)}", "give a whole number from 1 up")
        if timeout is not None and not timeout > 0:
            raise InputError("timeout", f"is {quote(timeout)}", "give seconds above zero")
        self.workers = workers
        self._stopping = False
        self._processes = [
            UserProcess(_attempted, timeout, hold_to_one_thread) for _ in range(workers)
        ]
        super().__init__([self._way_to(process) for process in self._processes])

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Takes no more work; without `wait`, or with `cancel_futures`, stops at once."""
        self._stopping |= not wait or cancel_futures
        super().shutdown()
        for thread, process in zip(self._threads, self._processes, strict=True):
            while thread.is_alive():
                if self._stopping:
                    process.kill()
                thread.join(PATIENCE)
            process.close()

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.shutdown(wait=kind is None)

    def _way_to(self, process: UserProcess) -> Way:
        def way(function: Callable[..., Any], *arguments: Any, **named: Any) -> Any:
            deaths = 0
            while not self._stopping:
                try:
                    answer, error = process(function, *arguments, **named)
                except ProcessEnded as ended:
                    deaths += 1
                    if deaths > REPEATS:
                        raise FunctionFailed(f"{deaths} workers died at it; {ended}") from None
                    continue
                if error is not None:
                    raise error
                return answer
            raise CancelledError

        return way


@contextmanager
def chosen_executor(workers: int | None, dask: str | None) -> Iterator[Executor | None]:
    """What `--workers` and `--dask` ask for, while the block runs; None is this process.

    Raises
    ------
    InputError
        When both are given, or the cluster cannot be used.
    """
    if workers is not None and dask is not None:
        raise InputError(
            "--workers", "and --dask are two ways to say where evaluations run", "give one of them"
        )
    if dask is not None:
        from camring.evaluation.dask_cluster import Cluster

        with Cluster(dask) as cluster:
            yield cluster
    elif workers is not None:
        with Workers(workers) as processes:
            yield processes
    else:
        yield None


def batch_of(batch: int | None, executor: Executor | None) -> int:
    """How many designs are chosen at once; None is as many as the executor has workers.

    Raises
    ------
    InputError
        When it is no number of designs, or there is no worker to count.
    """
    if batch is not None:
        if isinstance(batch, bool) or not isinstance(batch, int) or batch < 1:
            raise InputError("batch", f"is {quote(batch)}", "give a whole number from 1 up")
        return batch
    for name in ("workers", "num_workers", "_max_workers"):  # ours, mpi4py's, the library's
        count = getattr(executor, name, None)
        if isinstance(count, int) and count > 0:
            return count
        if count == 0:
            raise InputError(
                "batch", "is not given, and there is no worker yet", "give it, or start workers"
            )
    return 1


def hold_to_one_thread() -> None:
    """Has an effect only before JAX is imported."""
    os.environ.update(ONE_THREAD)


def _call(function: Callable[..., Result], *arguments: Any, **named: Any) -> Result:
    return function(*arguments, **named)


def _attempted(
    function: Callable[..., Any], *arguments: Any, **named: Any
) -> tuple[Any, Exception | None]:
    try:
        return function(*arguments, **named), None
    except Exception as error:
        return None, error

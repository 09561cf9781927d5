"""Evaluations on a cluster of dask.distributed that somebody has started (extra `dask`)."""

import logging
import pickle
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Executor, Future
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypeVar

from camring.evaluation.child_processes import end_those_of
from camring.evaluation.user_programs.process import FunctionFailed
from camring.files.errors import InputError, quote
from camring.programs.compilation_cache import keep_compiled_programs

Result = TypeVar("Result")

PATIENCE = 10.0  # seconds for a scheduler to answer
POLL_INTERVAL = 0.5  # seconds between two polls whether anybody waits for an answer


class Cluster(Executor):
    """Hands calls to a scheduler, which repeats one whose worker died.

    Parameters
    ----------
    address
        Of the scheduler, such as "tcp://host:8786", or the file that it wrote
        (`dask scheduler --scheduler-file`), ending in ".json".

    Raises
    ------
    InputError
        When the extra is not installed, or no scheduler answers.
    """

    def __init__(self, address: str, patience: float = PATIENCE) -> None:
        if find_spec("distributed") is None:
            raise InputError(
                "--dask", "needs the extra dask, which is missing", 'pip install "camring[dask]"'
            )
        from distributed import Client

        class Quiet(Client):
            def __del__(self) -> None:
                """One that never connected has nothing to close, and would complain for long."""

        # Its attempts to connect are reported in many lines; ours is the one sentence.
        logging.getLogger("distributed").setLevel(logging.CRITICAL)
        where: dict[str, Any] = {"address": address}
        if address.endswith(".json"):
            where = {"scheduler_file": str(_existing(Path(address)))}
        try:
            self._client = Quiet(**where, timeout=patience, set_as_default=False)
        except Exception as error:  # whoever answers there may say anything
            said = next(iter(str(error).splitlines()), "") or type(error).__name__
            raise InputError(
                "--dask",
                f"is {quote(address)}, where no scheduler answered within {patience:g} s ({said})",
                "start one with `dask scheduler` and give the address that it prints, such as "
                "tcp://host:8786",
            ) from error

    @property
    def workers(self) -> int:
        """Calls that the cluster carries out at once, as it stands."""
        return sum(self._client.nthreads().values())

    def submit(
        self, function: Callable[..., Result], /, *arguments: Any, **named: Any
    ) -> Future[Result]:
        import cloudpickle  # dask's own, which takes functions of a notebook, too

        call = cloudpickle.dumps((function, arguments, named))
        theirs = self._client.submit(carried_out, call, pure=False)
        ours: Future[Result] = Future()
        ours.add_done_callback(lambda done: theirs.cancel() if done.cancelled() else None)
        theirs.add_done_callback(lambda done: _settle(ours, done))
        return ours

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Leaves the cluster, which remains; what nobody has begun is not begun."""
        self._client.close()


def carried_out(call: bytes) -> Any:
    """On a worker: what a call returns."""
    keep_compiled_programs()  # before the evaluator brings JAX
    with _ended_when_nobody_waits():
        function, arguments, named = pickle.loads(call)
        return function(*arguments, **named)


@contextmanager
def _ended_when_nobody_waits() -> Iterator[None]:
    """Ends the programs that this call has started when whoever submitted it has gone.

    The scheduler notices the end of a client and tells the worker, which can but forget
    the task: its thread goes on.
    """
    from distributed import get_worker

    worker, here, done = get_worker(), threading.get_ident(), threading.Event()
    key = worker.get_current_task()

    def watch() -> None:
        while not done.wait(POLL_INTERVAL):
            task = worker.state.tasks.get(key)
            if task is None or task.state != "executing":
                end_those_of(here)

    threading.Thread(target=watch, name="camring-watch", daemon=True).start()
    try:
        yield
    finally:
        done.set()


def _settle(ours: Future, theirs: Any) -> None:
    from distributed.scheduler import KilledWorker

    if not ours.set_running_or_notify_cancel():
        return
    if theirs.cancelled():
        ours.set_exception(CancelledError("the scheduler is gone, or has forgotten it"))
        return
    error = theirs.exception()
    if isinstance(error, KilledWorker):
        died = 1 + error.allowed_failures
        ours.set_exception(FunctionFailed(f"{died} workers died at it, one after the other"))
    elif error is not None:
        ours.set_exception(error)
    else:
        ours.set_result(theirs.result())


def _existing(path: Path) -> Path:
    if not path.is_file():
        raise InputError(
            "--dask",
            f"is {quote(str(path))}, which is no file",
            "give the file that `dask scheduler --scheduler-file` writes, or an address",
        )
    return path

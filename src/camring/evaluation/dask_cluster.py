"""Evaluations on a cluster of dask.distributed that somebody has started (extra `dask`)."""

import logging
import pickle
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Executor, Future, InvalidStateError
from contextlib import contextmanager, suppress
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
            self._client: Any = Quiet(**where, timeout=patience, set_as_default=False)
        except Exception as error:  # whoever answers there may say anything
            said = next(iter(str(error).splitlines()), "") or type(error).__name__
            raise InputError(
                "--dask",
                f"is {quote(address)}, where no scheduler answered within {patience:g} s ({said})",
                "start one with `dask scheduler` and give the address that it prints, such as "
                "tcp://host:8786",
            ) from error
        self._patience = patience
        self._open: set[Future[Any]] = set()
        self._left = threading.Event()
        threading.Thread(target=self._watch, name="camring-cluster", daemon=True).start()

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
        self._open.add(ours)
        ours.add_done_callback(self._open.discard)
        ours.add_done_callback(lambda done: theirs.cancel() if done.cancelled() else None)
        theirs.add_done_callback(lambda done: _settle(ours, done))
        return ours

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Leaves the cluster, which remains; what nobody has begun is not begun."""
        self._left.set()
        with suppress(Exception):  # what it lost before, it says again when it is closed
            self._client.close()
        self._give_up()

    def _watch(self) -> None:
        """Lets nobody wait for a scheduler that is gone, whatever its client makes of it."""
        reached = time.monotonic()
        while not self._left.wait(POLL_INTERVAL):
            if self._client.status == "running":
                reached = time.monotonic()
            elif self._client.status == "closed" or time.monotonic() - reached > 3 * self._patience:
                self._give_up()

    def _give_up(self) -> None:
        for each in tuple(self._open):
            _fail(each, CancelledError("the scheduler is gone"))


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
    """Hands on an outcome. Another may be lost on its way while a scheduler goes.

    Runs in the one thread that dask has for that in a process, and must always return.
    """
    from distributed.scheduler import KilledWorker

    if ours.cancelled():
        ours.set_running_or_notify_cancel()
        return
    try:
        while not ours.done():
            if theirs.status == "error":
                error = theirs.exception(timeout=PATIENCE)
                if isinstance(error, KilledWorker):
                    died = 1 + error.allowed_failures
                    error = FunctionFailed(f"{died} workers died at it, one after the other")
                _fail(ours, error)
                return
            with suppress(TimeoutError):
                answer = theirs.result(timeout=PATIENCE)
                with suppress(InvalidStateError):  # somebody has given it up
                    ours.set_result(answer)
    except BaseException as error:  # also asyncio's cancellation, which is no `Exception`
        lost = "the scheduler is gone, or has forgotten it"
        _fail(ours, CancelledError(f"{lost} ({type(error).__name__})"))


def _fail(ours: Future, error: BaseException) -> None:
    with suppress(InvalidStateError):
        ours.set_exception(error)


def _existing(path: Path) -> Path:
    if not path.is_file():
        raise InputError(
            "--dask",
            f"is {quote(str(path))}, which is no file",
            "give the file that `dask scheduler --scheduler-file` writes, or an address",
        )
    return path

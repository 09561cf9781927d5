"""The second solver beside the first: in processes of its own, so that both compute at once.

It is Python from end to end, and Python's lock lets one thread of a process compute at a time.
Where there can be no such process, or a law of the user's own cannot be sent to it, the same
solver gives the same numbers here.
"""

import os
import pickle
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import CancelledError, Future
from typing import Any

from camring.evaluation.executors import ONE_THREAD, Threads
from camring.reference import (
    NotStarShapedError,
    OrbitError,
    independent_results,
    machine_of,
    results_of_machine,
)

PROCESSES = 2
COMMAND = ("-P", "-m", "camring.reference.child")
UNSENDABLE = (pickle.PicklingError, AttributeError, TypeError)
"""What pickle raises for a function inside a function, and for a law that refuses."""

Results = dict[str, float]


class SecondSolver(Threads):
    """`independent_results` in two processes, each of which begins when there is work for it.

    Examples
    --------
    >>> with SecondSolver() as second:  # doctest: +SKIP
    ...     pending = second.begin(motor, fluid, point, harmonics=600, tolerance=1e-7)
    ...     pending.result()
    """

    def __init__(self) -> None:
        self.children = tuple(Child() for _ in range(PROCESSES))
        super().__init__([each.solved for each in self.children])

    def begin(
        self, motor: Any, fluid: Any, point: Any, harmonics: int, tolerance: float
    ) -> Future[Results]:
        """The results of one motor at one operating point, under way."""
        return self.submit(independent_results, motor, fluid, point, harmonics, tolerance)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Ends the processes, whatever they are at; what is still to be solved is cancelled."""
        super().shutdown(wait, cancel_futures=cancel_futures)
        for each in self.children:
            each.close()


class Child:
    """One such process, begun when it is first needed."""

    def __init__(self) -> None:
        self.process: subprocess.Popen[bytes] | None = None
        self._possible = True
        self._closed = False

    def solved(
        self,
        otherwise: Callable[..., Results],
        motor: Any,
        fluid: Any,
        point: Any,
        harmonics: int,
        tolerance: float,
    ) -> Results:
        """What the process answers; what `otherwise` says where it cannot be asked."""
        machine = machine_of(motor, fluid, point)
        if machine.cooling is None:  # else oil at each temperature is read from the motor anew
            answer = self._answer((machine, harmonics, tolerance))
            if isinstance(answer, dict):
                return results_of_machine(answer)
            if isinstance(answer, OrbitError | NotStarShapedError):
                raise answer
        if self._closed:
            raise CancelledError
        return otherwise(motor, fluid, point, harmonics, tolerance)

    def running(self) -> subprocess.Popen[bytes]:
        if self.process is None:
            path = os.pathsep.join(os.path.abspath(each) for each in sys.path)
            self.process = subprocess.Popen(
                [sys.executable, *COMMAND],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env={**os.environ, **ONE_THREAD, "PYTHONPATH": path},
                start_new_session=True,  # out of the reach of Ctrl-C
            )
        return self.process

    def close(self) -> None:
        """Ends it."""
        self._closed = True
        self._possible = False
        if self.process is not None:
            self.process.kill()
            self.process.wait()

    def _answer(self, problem: tuple[Any, int, float]) -> Any:
        """None where there is none to be had."""
        try:
            content = pickle.dumps(problem)
        except UNSENDABLE:
            return None
        if not self._possible:
            return None
        try:
            process = self.running()
            assert process.stdin is not None
            assert process.stdout is not None
            process.stdin.write(content)
            process.stdin.flush()
            return pickle.load(process.stdout)
        except (OSError, EOFError, ValueError, pickle.UnpicklingError):
            self._possible = False
            return None

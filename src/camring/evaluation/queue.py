"""Where questions lie until they are answered, some of them ahead of their turn.

Whoever leads a search asks one question after the other, in the order of its trials.
The desk hands out also those that are sure to come, so that several workers have
something to do, and keeps each answer until it is asked for. Hence what a search finds
depends neither on how many workers there are nor on which of them is first.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor, Future
from typing import Generic, TypeVar

import numpy as np
from jaxtyping import Float

from camring.evaluation.user_programs.process import FunctionFailed
from camring.files.errors import CamringError

Answer = TypeVar("Answer")
Point = Float[np.ndarray, " dimension"]


class WorkersGone(CamringError):
    """Nobody is left to evaluate anything, which is not the fault of one design."""


class Desk(Generic[Answer]):
    """Questions under way at an executor.

    Parameters
    ----------
    evaluate
        Answers a point, wherever the executor takes it.
    lost
        The answer to a point whose own cannot be had, from the point and the reason.
    wait_for
        Waits for a future and gives its result.
    """

    def __init__(
        self,
        executor: Executor,
        evaluate: Callable[[Point], Answer],
        lost: Callable[[Point, str], Answer],
        wait_for: Callable[[Future[Answer]], Answer] = Future.result,
    ) -> None:
        self._executor, self._evaluate = executor, evaluate
        self._lost, self._wait_for = lost, wait_for
        self._pending: dict[bytes, Future[Answer]] = {}

    def answer(self, point: Point, ahead: Sequence[Point] = ()) -> Answer:
        """What comes of a point, while those ahead of it are evaluated as well.

        Raises
        ------
        WorkersGone
            When the executor can evaluate nothing any more.
        """
        wanted = {each.tobytes(): each for each in (point, *ahead)}
        for key in self._pending.keys() - wanted.keys():
            self._pending.pop(key).cancel()
        try:
            for key, each in wanted.items():
                if key not in self._pending:
                    self._pending[key] = self._executor.submit(self._evaluate, each)
            answer = self._wait_for(self._pending[point.tobytes()])
        except FunctionFailed as error:
            answer = self._lost(point, str(error))
        except CamringError:
            raise
        except Exception as error:
            raise WorkersGone(_in_words(error)) from error
        del self._pending[point.tobytes()]
        return answer

    def close(self) -> None:
        """Nothing more will be asked; what nobody has begun is not begun."""
        for future in self._pending.values():
            future.cancel()
        self._pending.clear()


def _in_words(error: Exception) -> str:
    said = next(iter(str(error).splitlines()), "").strip().rstrip(".")
    reason = f"{type(error).__name__}: {said}" if said else type(error).__name__
    return f"The workers can evaluate nothing ({reason}); what was completed is kept."

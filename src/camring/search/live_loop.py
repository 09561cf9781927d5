"""An optimiser's own loop, held in a thread of its own where it waits for an evaluation.

Run again from its start at every proposal (`replay.py`), a loop of `n` evaluations takes `n` runs.
One that is held goes on where it waits: the same loop with the same answers, so the same bits.
"""

from collections.abc import Callable, Sequence
from operator import is_
from queue import SimpleQueue
from threading import Thread
from typing import Any, Generic, Protocol, TypeAlias, TypeVar

import numpy as np
from jaxtyping import Float

from camring.search.problem import Evaluation
from camring.search.replay import Unknown, on_grid

Point: TypeAlias = Float[np.ndarray, " dimension"]
Result = TypeVar("Result")


class Asks(Protocol):
    """Waits for an evaluation, and says which will be asked for after it."""

    def __call__(self, point: Point, ahead: Sequence[Point] = ()) -> Evaluation: ...


class _Abandoned(BaseException):
    """Nobody waits for this loop any more."""


class LiveLoop(Generic[Result]):
    """A function that asks for evaluations, stopped at each of its questions.

    Only one of the two threads ever runs: whoever waits here, or the loop.

    Parameters
    ----------
    loop
        Given a function that turns a point into its evaluation, it returns a result.
    """

    def __init__(self, loop: Callable[[Asks], Result]) -> None:
        self._loop = loop
        self._answers = SimpleQueue[Evaluation | None]()
        self._news = SimpleQueue[tuple[str, Any]]()
        self._thread = Thread(target=self._run, name="camring-optimiser", daemon=True)

    def start(self) -> Result:
        """Runs the loop up to its first question, or to its end.

        Raises
        ------
        Unknown
            With the point that the loop waits for; whatever the loop itself raises.
        """
        self._thread.start()
        return self._next()

    def answered(self, evaluation: Evaluation) -> Result:
        """Goes on from the question at hand, as `start` does."""
        self._answers.put(evaluation)
        return self._next()

    def close(self) -> None:
        """Ends a loop that still waits; one that has ended stays as it is."""
        self._answers.put(None)

    def _next(self) -> Result:
        kind, found = self._news.get()
        if kind == "result":
            return found
        try:
            raise found
        finally:
            del found  # its traceback holds this frame, which would hold it

    def _run(self) -> None:
        try:
            self._news.put(("result", self._loop(self._ask)))
        except _Abandoned:
            pass
        except BaseException as error:
            self._news.put(("error", error))

    def _ask(self, point: Point, ahead: Sequence[Point] = ()) -> Evaluation:
        self._news.put(("question", Unknown(point, ahead)))
        answer = self._answers.get()
        if answer is None:
            raise _Abandoned
        return answer


class HeldLoop(Generic[Result]):
    """The loop of a search under way, held for its next proposal; other processes begin anew.

    A loop that waits ends when its holder is forgotten.
    """

    def __init__(self) -> None:
        self._loop: LiveLoop[Result] | None = None
        self._name, self._history = -1, list[Evaluation]()
        self._asked = b""

    def continued(
        self, loop: Callable[[Asks], Result], history: Sequence[Evaluation], name: int
    ) -> Result:
        """A loop's end, from where it is held if that is what the history leads to.

        Parameters
        ----------
        loop
            What to run through the history, from its start, otherwise.
        name
            Of this loop among those of one search.

        Raises
        ------
        Unknown
            With the point to evaluate next.
        """
        try:
            if self._loop is not None and name == self._name and self._answered_by(history):
                return self._loop.answered(history[-1])
            self.forget()
            self._loop = LiveLoop(loop)
            return self._loop.start()
        except Unknown as unknown:
            self._name, self._history = name, list(history)
            self._asked = on_grid(unknown.point).tobytes()
            raise

    def _answered_by(self, history: Sequence[Evaluation]) -> bool:
        """Whether a history is the one known and the evaluation asked for, nothing else."""
        same = len(history) == len(self._history) + 1 and all(map(is_, history, self._history))
        return same and on_grid(history[-1].point).tobytes() == self._asked

    def forget(self) -> None:
        """Ends the loop that is held."""
        if self._loop is not None:
            self._loop.close()
        self._loop = None

    def __del__(self) -> None:
        self.forget()

    def __reduce__(self) -> tuple[type["HeldLoop[Any]"], tuple[()]]:
        return HeldLoop, ()

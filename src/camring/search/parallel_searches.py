"""Searches that walk abreast, so that their questions are answered in batches.

SciPy's minimisers ask for one point at a time. Each search here sits in a thread of its
own that stands still while it waits for an answer; they take turns, one at a time, so
nothing depends on who is faster. Once all of them wait, the question that most have, for
values or for slopes, is answered for all who have it at once.
"""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeAlias

import numpy as np
from jaxtyping import Float

Point: TypeAlias = Float[np.ndarray, " dimension"]
Points: TypeAlias = Float[np.ndarray, "point dimension"]
Answer: TypeAlias = tuple[np.ndarray, ...]
Answering: TypeAlias = Callable[[Points], Answer]
"""A leading axis for the points, in what is asked and in each array of what is answered."""

VALUES, SLOPES = "values", "slopes"


class _Abandoned(BaseException):
    """Ends a search whose answers nobody will bring; not for it to catch."""


class Ask:
    """How a search asks; each call waits for the answer at its one point."""

    def __init__(self) -> None:
        self._asked, self._answered = threading.Semaphore(0), threading.Semaphore(0)
        self._answer: Answer | None = None
        self.question: tuple[str, Point] | None = None
        self.fault: BaseException | None = None

    def values(self, point: Point) -> Answer:
        return self._wait(VALUES, point)

    def slopes(self, point: Point) -> Answer:
        return self._wait(SLOPES, point)

    def _wait(self, kind: str, point: Point) -> Answer:
        self.question = kind, point
        self._asked.release()
        self._answered.acquire()
        if self._answer is None:
            raise _Abandoned
        return self._answer


Search: TypeAlias = Callable[[Ask], None]


class _Seat(Ask):
    """A search and its thread, run from question to question by whoever answers."""

    def __init__(self, search: Search) -> None:
        super().__init__()
        self._thread = threading.Thread(target=self._run, args=(search,), daemon=True)
        self._thread.start()
        self._await_question()

    def _run(self, search: Search) -> None:
        try:
            search(self)
        except _Abandoned:
            pass
        except BaseException as fault:  # for whoever waits to raise
            self.fault = fault
        self.question = None
        self._asked.release()

    def go_on(self, answer: Answer | None) -> None:
        """To its next question or its end; with no answer to its end at once."""
        self._answer = answer
        self._answered.release()
        self._await_question()

    def _await_question(self) -> None:
        self._asked.acquire()
        if self.question is None:
            self._thread.join()


def walk_abreast(
    following: Callable[[], Search | None], values: Answering, slopes: Answering, seats: int
) -> None:
    """Run searches, as many at a time as there are seats, until none follows.

    Parameters
    ----------
    following
        The next search, or None when there is none at present; asked anew after every
        round, and for the last time when nobody is seated any more.
    values, slopes
        What answers `Ask.values` and `Ask.slopes`.

    Raises
    ------
    BaseException
        Whatever a search or an answer raised; the other searches are then abandoned.
    """
    with _seated() as walking:
        while True:
            while len(walking) < seats and (search := following()) is not None:
                walking.append(_Seat(search))
                _dismiss(walking)
            if not walking:
                return
            of_values = [each for each in walking if each.question and each.question[0] == VALUES]
            of_slopes = [each for each in walking if each not in of_values]
            answering, served = (
                (values, of_values) if len(of_values) >= len(of_slopes) else (slopes, of_slopes)
            )
            found = answering(np.stack([each.question[1] for each in served if each.question]))
            for place, each in enumerate(served):
                each.go_on(tuple(part[place] for part in found))
            _dismiss(walking)


@contextmanager
def _seated() -> Iterator[list[_Seat]]:
    """Seats that are all empty in the end, so that no thread waits for ever."""
    walking: list[_Seat] = []
    try:
        yield walking
    finally:
        for each in walking:
            if each.question is not None:
                each.go_on(None)


def _dismiss(walking: list[_Seat]) -> None:
    for each in walking:
        if each.fault is not None:
            raise each.fault
    walking[:] = [each for each in walking if each.question is not None]


__all__ = ["Ask", "Search", "walk_abreast"]

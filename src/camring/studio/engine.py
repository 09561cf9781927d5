"""Three threads that compute: one follows the hand, two fill in what may come a little later.

The first takes the newest position there is and leaves out all between. The second draws the
envelope of what the first has finished, and once the hand rests the envelope at more points;
the third solves a design at rest as every command does, and finds its slopes. They start anew
whenever a newer one is there.
"""

import contextlib
import os
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from camring.files.motor import MotorFile
from camring.physics.system import System
from camring.studio.arrows import Direction, arrows_of
from camring.studio.envelope_map import Over, Range, mapped
from camring.studio.evaluation import Evaluated, evaluated, pictures
from camring.studio.following import followed
from camring.studio.frames import packed

Result = TypeVar("Result")
Post = Callable[[bytes], None]

REST = 0.12  # seconds after which a design that nobody holds is taken to rest
HELD = 0.5  # the same while the hand holds it: what is expensive would make its next movement wait
SWITCH = 5e-4  # seconds after which a thread hands Python on: the hand must not wait for the other
LESS_URGENT = 10  # niceness of the other threads


@dataclass(frozen=True, eq=False)
class Asked:
    """A position of the hand.

    Attributes
    ----------
    number
        Grows with every position; the answer carries it.
    point
        The operating point whose pictures are wanted.
    held
        Whether the hand holds it.
    kind
        `frame` for the design under the hand, `before` for what it is held against.
    """

    number: int
    file: MotorFile
    system: System
    controls: np.ndarray
    point: int
    where: Range | None
    directions: Sequence[Direction] = ()
    held: bool = False
    kind: str = "frame"
    words: tuple[tuple[str, Any], ...] = ()


class Engine:
    """Computes and posts binary messages; `post` is called from its threads."""

    def __init__(self, post: Post) -> None:
        self._post = post
        self._wake = threading.Condition()
        self._tasks = deque[tuple[Future, Callable[[], Any]]]()
        self._newest: Callable[[], Asked] | None = None
        self._solved: tuple[Asked, Evaluated] | None = None
        self._held_against: Asked | None = None
        self._held_roughly: Asked | None = None
        self._ended = False
        self._threads = [
            threading.Thread(target=target, args=given, name=f"camring-{name}", daemon=True)
            for name, target, given in (
                ("hand", self._follow, ()),
                ("envelope", self._fill_in, (self._envelopes,)),
                ("rest", self._fill_in, (self._at_rest,)),
            )
        ]

    def start(self) -> None:
        sys.setswitchinterval(SWITCH)
        for each in self._threads:
            each.start()

    def stop(self) -> None:
        with self._wake:
            self._ended = True
            self._wake.notify_all()

    def follow(self, asked: Callable[[], Asked]) -> None:
        """What makes the newest position; any that waits is forgotten."""
        with self._wake:
            self._newest = asked
            self._wake.notify_all()

    def run(self, function: Callable[[], Result]) -> "Future[Result]":
        """A function on the first thread, in the order of the calls."""
        future: Future[Result] = Future()
        with self._wake:
            self._tasks.append((future, function))
            self._wake.notify_all()
        return future

    def _follow(self) -> None:
        while True:
            with self._wake:
                self._wake.wait_for(lambda: self._ended or self._tasks or self._newest)
                if self._ended:
                    return
                task = self._tasks.popleft() if self._tasks else None
                if task is None:
                    asked, self._newest = self._newest, None
            if task is not None:
                future, function = task
                try:
                    future.set_result(function())
                except BaseException as error:
                    future.set_exception(error)
            elif asked is not None:
                self._answer(asked)

    def _answer(self, make: Callable[[], Asked]) -> None:
        began = time.perf_counter()
        try:
            asked = make()
            solved = followed(asked.system, asked.file.goal)
            self._post(_frame(asked, solved, began))
        except Exception as error:  # a design of which nothing can be said must not end the page
            self._post(packed("trouble", {"sentence": str(error)}, {}))
            return
        with self._wake:
            self._solved = (asked, solved)
            self._wake.notify_all()

    def before(self, asked: Asked) -> bytes:
        """The frame of what a design is held against; more of it follows. Call it by `run`."""
        frame = _frame(asked, followed(asked.system, asked.file.goal))
        self._held_against = self._held_roughly = asked
        return frame

    def _fill_in(self, later: Callable[[Asked, Evaluated], None]) -> None:
        with contextlib.suppress(OSError, AttributeError):
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), LESS_URGENT)
        asked: Asked | None = None
        while True:
            found = self._newer_than(asked)
            if found is None:
                return
            asked, solved = found
            try:
                later(asked, solved)
            except Exception as error:
                self._post(packed("trouble", {"sentence": str(error)}, {}))

    def _newer_than(self, last: Asked | None) -> tuple[Asked, Evaluated] | None:
        """The next design that is solved; None at the end."""
        with self._wake:
            self._wake.wait_for(
                lambda: self._ended or (self._solved and self._solved[0] is not last)
            )
            return None if self._ended else self._solved

    def _envelopes(self, asked: Asked, solved: Evaluated) -> None:
        before, self._held_against = self._held_against, None
        if before is not None and before.where is not None:
            *_, found = mapped(before.file, before.system, before.where, before.where.coarse)
            self._post(_envelope(before, found, "coarse", "before envelope"))
        if asked.where is None:
            return
        # To its end though the hand may have moved on: else a moving hand would see nothing.
        *_, found = mapped(asked.file, asked.system, asked.where, asked.where.coarse)
        self._post(_envelope(asked, found, "coarse"))
        if self._moved_on(asked, HELD if asked.held else REST):
            return
        for finer in mapped(asked.file, asked.system, asked.where, asked.where.fine):
            if self._moved_on(asked, 0.0):
                return
            if finer is not None:
                self._post(_envelope(asked, finer, "fine"))

    def _at_rest(self, asked: Asked, solved: Evaluated) -> None:
        """The design by the solver for one motor, and its slopes by every slider."""
        if self._moved_on(asked, HELD if asked.held else REST):
            return
        before, self._held_roughly = self._held_roughly, None
        if before is not None:
            self._post(_frame(before, evaluated(before.system, before.file.goal)))
        if not solved.cycles:
            solved = evaluated(asked.system, asked.file.goal)
            if self._moved_on(asked, 0.0):
                return
            self._post(_frame(asked, solved))
        if not asked.directions or solved.fault:
            return
        found = arrows_of(solved, asked.file.goal, asked.directions, asked.point)
        words = {"number": asked.number, "paths": found.paths, "limits": list(found.limits)}
        slopes = np.stack(list(found.limits.values()))
        self._post(
            packed("arrows", words, {"results": _finite(found.results), "slopes": _finite(slopes)})
        )

    def _moved_on(self, asked: Asked, rest: float) -> bool:
        """Whether a newer design comes within so many seconds."""
        with self._wake:
            return self._wake.wait_for(
                lambda: (
                    self._ended
                    or self._newest is not None
                    or (self._solved is not None and self._solved[0] is not asked)
                ),
                rest,
            )


def _frame(asked: Asked, solved: Evaluated, began: float | None = None) -> bytes:
    """`began` by `time.perf_counter` where the page shall know how long it took."""
    took = None if began is None else 1e3 * (time.perf_counter() - began)
    limits = np.array(list(solved.limits.values()))
    words = {
        "number": asked.number,
        "point": asked.point,
        "fault": solved.fault,
        "rest": bool(solved.cycles),
        "took": took,
        **dict(asked.words),
    }
    arrays = {
        "controls": asked.controls,
        "results": solved.results,
        "limits": np.clip(limits, -1e9, 1e9),
    }
    if not solved.fault:
        arrays |= pictures(solved, asked.point)
    return packed(asked.kind, words, arrays)


def _envelope(asked: Asked, found: Over | None, grid: str, kind: str = "envelope") -> bytes:
    assert found is not None
    words = {"number": asked.number, "grid": grid, "names": found.names}
    return packed(kind, words, {"limits": found.limits, "results": found.results})


def _finite(values: np.ndarray) -> np.ndarray:
    return np.nan_to_num(values, nan=0.0, posinf=0.0, neginf=0.0)

"""What a person sees of long work: how far, how good, how long still. On stderr only."""

import threading
import time
from collections.abc import Callable, Sequence
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from camring.evaluation.record import Record, best_of
from camring.files.terminal import Terminal

LINE_EVERY = 10.0  # seconds between two lines where no bar can be drawn


class Heartbeat:
    """Has a line said whenever nothing was for so long, from its block's beginning to its end.

    Parameters
    ----------
    line
        What to say now.
    say
        Says it.
    every
        Seconds of silence before a line; None for never.
    """

    def __init__(
        self, line: Callable[[], str], say: Callable[[str], None], every: float | None
    ) -> None:
        self._line, self._say, self._every = line, say, every
        self._ended = threading.Event()
        self._last = time.monotonic()
        self._thread: threading.Thread | None = None

    def __enter__(self) -> "Heartbeat":
        self.heard()
        if self._every is not None:
            # A daemon: work that was given up must not be kept alive by its own news.
            self._thread = threading.Thread(target=self._beat, name="camring-news", daemon=True)
            self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        if self._thread is not None:
            self._thread.join()

    def heard(self) -> None:
        """Something was said by somebody else."""
        self._last = time.monotonic()

    def _beat(self) -> None:
        assert self._every is not None
        while not self._ended.wait(max(0.0, self._last + self._every - time.monotonic())):
            if time.monotonic() - self._last >= self._every:
                self.heard()
                self._say(self._line())


class Spoken:
    """Says what long work without a count is at, and where there is no terminal for how long.

    Parameters
    ----------
    doing
        What it begins with; said only when it takes long.
    terminals
        Whether a terminal gets lines too, where nothing else shows that work goes on.
    """

    def __init__(
        self,
        doing: str,
        console: Console | None = None,
        every: float = LINE_EVERY,
        terminals: bool = False,
    ) -> None:
        self._console = console or Terminal(stderr=True)
        self._doing, self._since = doing, time.monotonic()
        silent = None if self._console.is_terminal and not terminals else every
        self._heartbeat = Heartbeat(self._line, self._print, silent)

    def __enter__(self) -> "Spoken":
        self._since = time.monotonic()
        self._heartbeat.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self._heartbeat.__exit__()

    def __call__(self, sentence: str) -> None:
        """The work has come to something else."""
        self._doing, self._since = sentence, time.monotonic()
        self._heartbeat.heard()
        self._print(sentence)

    def _line(self) -> str:
        return f"{self._doing.rstrip('.')}: {time.monotonic() - self._since:.0f} s so far."

    def _print(self, sentence: str) -> None:
        printed(self._console, sentence)


FIRST_RUN = "Programs for motors of this kind that never ran here are compiled, for some minutes."
SIMULATING = f"Simulating. {FIRST_RUN}"


class SearchProgress:
    """A bar on a terminal; elsewhere a line every ten seconds, whatever is under way.

    Parameters
    ----------
    kept
        Evaluations of former runs.
    budget
        Evaluations in all.
    """

    def __init__(
        self,
        kept: Sequence[Record],
        budget: int,
        console: Console | None = None,
        every: float = LINE_EVERY,
    ) -> None:
        self._console = console or Terminal(stderr=True)
        self._best = best_of(kept)
        self._done = len(kept)
        self._feasible = sum(record.feasible for record in kept)
        self._any_failed = any(record.failed for record in kept)
        self._budget = budget
        self._phase = "starting"
        self._since = time.monotonic()
        self._bar = Progress(
            TextColumn("{task.description}"),
            BarColumn(bar_width=24),
            MofNCompleteColumn(),
            TextColumn("{task.fields[best]}"),
            TimeRemainingColumn(),
            console=self._console,
            transient=True,
            disable=not self._console.is_terminal,
        )
        self._task = self._bar.add_task(
            self._phase, total=budget, completed=self._done, best=self._best_so_far()
        )
        silent = None if self._console.is_terminal else every
        self._heartbeat = Heartbeat(self._line, lambda line: printed(self._console, line), silent)

    def __enter__(self) -> "SearchProgress":
        self._bar.start()
        self._since = time.monotonic()
        self._heartbeat.__enter__()
        return self

    def __exit__(
        self, _: type[BaseException] | None, __: BaseException | None, ___: TracebackType | None
    ) -> None:
        self._heartbeat.__exit__()
        self._bar.stop()

    def __call__(self, record: Record) -> None:
        """Shows one more evaluation."""
        self._done += 1
        self._feasible += record.feasible
        self._phase = record.phase
        if record.failed and not self._any_failed:
            self._any_failed = True
            self.say(
                f"Evaluation {record.trial} failed: {record.failure}. "
                "The search goes on; further failures are counted in the report."
            )
        if record.feasible:
            self._best = best_of([*([self._best] if self._best else []), record])
        self._bar.update(
            self._task, completed=self._done, description=self._phase, best=self._best_so_far()
        )
        self._since = time.monotonic()

    def say(self, sentence: str) -> None:
        """A line above the bar."""
        self._heartbeat.heard()
        printed(self._console, sentence)

    def _line(self) -> str:
        waited = f"{time.monotonic() - self._since:.0f} s"
        since = "since the last" if self._done else "so far"
        said = (
            f"{self._done} of {self._budget} evaluations, {self._best_so_far()}; {waited} {since}."
        )
        return said if self._done else f"{said} {FIRST_RUN}"

    def _best_so_far(self) -> str:
        if not self._done:
            return "the given motor first"
        if self._best is None:
            return "none feasible yet"
        outcome = self._best.outcome
        ripple = max((each.get("torque_ripple", 0.0) for each in outcome.results), default=0.0)
        return (
            f"best objective {outcome.objective:.5g}, torque ripple {100 * ripple:.2f} %, "
            f"{self._feasible} feasible"
        )


def printed(console: Console, sentence: str) -> None:
    """A line as it is, whatever the width of whoever reads it."""
    console.print(sentence, highlight=False, markup=False, soft_wrap=True)

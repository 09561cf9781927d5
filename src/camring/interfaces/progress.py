"""What a person sees of long work: how far, how good, how long still. On stderr only."""

import time
from collections.abc import Sequence
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from camring.interfaces.record import Record, best_of

LINE_EVERY = 10.0  # seconds between two lines where no bar can be drawn


class SearchProgress:
    """A bar on a terminal; elsewhere a line now and then.

    Parameters
    ----------
    kept
        Evaluations of former runs.
    budget
        Evaluations in all.
    """

    def __init__(self, kept: Sequence[Record], budget: int, console: Console | None = None) -> None:
        self._console = console or Console(stderr=True)
        self._best = best_of(kept)
        self._done = len(kept)
        self._feasible = sum(record.feasible for record in kept)
        self._any_failed = any(record.failed for record in kept)
        self._budget = budget
        self._last_line = time.monotonic()
        self._phase = "starting"
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

    def __enter__(self) -> "SearchProgress":
        self._bar.start()
        return self

    def __exit__(
        self, _: type[BaseException] | None, __: BaseException | None, ___: TracebackType | None
    ) -> None:
        self._bar.stop()

    def __call__(self, record: Record) -> None:
        """Shows one more evaluation."""
        self._done += 1
        self._feasible += record.feasible
        self._phase = record.phase
        if record.failed and not self._any_failed:
            self._any_failed = True
            self.say(f"Evaluation {record.trial} failed: {record.outcome.failure}.")
        if record.feasible:
            self._best = best_of([*([self._best] if self._best else []), record])
        self._bar.update(
            self._task, completed=self._done, description=self._phase, best=self._best_so_far()
        )
        if not self._console.is_terminal and time.monotonic() - self._last_line > LINE_EVERY:
            self._last_line = time.monotonic()
            self.say(f"{self._done} of {self._budget} evaluations, {self._best_so_far()}")

    def say(self, sentence: str) -> None:
        """A line above the bar."""
        self._console.print(sentence, highlight=False, markup=False)

    def _best_so_far(self) -> str:
        if self._best is None:
            return "none feasible yet"
        outcome = self._best.outcome
        ripple = max((each.get("torque_ripple", 0.0) for each in outcome.results), default=0.0)
        return (
            f"best {outcome.objective:.5g}, torque ripple {100 * ripple:.2f} %, "
            f"{self._feasible} feasible"
        )

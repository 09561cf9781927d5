"""All runs together: which methods, which problems, and how one did on the other."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from benchmarks.search.measures import SLOPES_COST, RunningTime, running_time
from benchmarks.search.traces import Trace

WITH_SLOPES = "gradient"
OURS = (
    WITH_SLOPES,
    "bayesian",
    "bayesian + model",
    "scbo",
    "scbo + model",
    "cma-es",
    "nelder-mead",
)
RIVALS = (
    "SLSQP, differences",
    "COBYQA",
    "SciPy DE",
    "pycma",
    "pymoo GA",
    "pymoo ISRES",
    "Optuna TPE",
    "Optuna GP",
    "SMT EGO",
    "BoTorch SCBO",
)
PROBLEMS = (
    *("wheel", "winch", "mill"),
    *("townsend", "gramacy", "branin-disc", "g06", "g24"),
    *("pressure-vessel", "welded-beam", "hartmann6", "g07"),
)


@dataclass(frozen=True)
class Entry:
    """A method, and what its slopes count for."""

    method: str
    slopes_cost: float = 0.0

    @property
    def name(self) -> str:
        if self.method != WITH_SLOPES:
            return self.method
        return f"{self.method}, slopes {self.slopes_cost:g}"

    @property
    def is_ours(self) -> bool:
        return self.method in OURS


class Campaign:
    """Runs sorted by method and problem.

    Attributes
    ----------
    problems
        Those with runs, motors first.
    best_known
        Of each problem, as stated; its runs end at a ten-thousandth above it.
    """

    def __init__(self, runs: dict[tuple[str, str], list[Trace]]) -> None:
        self._runs = runs
        self.problems = [name for name in PROBLEMS if any(key[0] == name for key in runs)]
        some = {problem: trace for (problem, _), traces in runs.items() for trace in traces}
        self.best_known = {name: some[name].best_known for name in self.problems}
        self.dimension = {name: some[name].dimension for name in self.problems}
        self.constraint_count = {name: some[name].constraint_count for name in self.problems}
        methods = [name for name in (*OURS, *RIVALS) if any(key[1] == name for key in runs)]
        self.entries = [Entry(name) for name in methods]
        if WITH_SLOPES in methods:
            self.entries.insert(1, Entry(WITH_SLOPES, SLOPES_COST))

    @classmethod
    def of(cls, traces: Iterable[Trace]) -> "Campaign":
        runs: dict[tuple[str, str], list[Trace]] = {}
        for trace in sorted(traces, key=lambda each: each.key):
            runs.setdefault((trace.problem, trace.method), []).append(trace)
        return cls(runs)

    @property
    def rivals(self) -> list[Entry]:
        return [each for each in self.entries if not each.is_ours]

    @property
    def ours_without_slopes(self) -> list[Entry]:
        return [each for each in self.entries if each.is_ours and each.method != WITH_SLOPES]

    @property
    def ours_with_slopes(self) -> list[Entry]:
        return [each for each in self.entries if each.method == WITH_SLOPES]

    def named(self, method: str) -> Entry:
        return Entry(method)

    def runs(self, entry: Entry, problem: str) -> list[Trace]:
        return self._runs.get((problem, entry.method), [])

    def time(self, entry: Entry, problem: str, target: float) -> RunningTime | None:
        """None where the method has no run on the problem."""
        traces = self.runs(entry, problem)
        if not traces:
            return None
        return running_time(traces, self.best_known[problem], target, entry.slopes_cost)

    def best(
        self, problem: str, target: float, entries: Sequence[Entry]
    ) -> tuple[str, RunningTime]:
        """The entry that is expected to be there first."""
        times = [(each.name, self.time(each, problem, target)) for each in entries]
        usable = [(name, time) for name, time in times if time is not None and time.successes]
        nobody = "none", RunningTime(math.inf, 0, sum(t.runs for _, t in times if t is not None))
        return min(usable, key=lambda pair: pair[1].expected, default=nobody)

    def lowest(self, problem: str) -> float:
        """The lowest feasible value of any run."""
        return min(
            (
                value
                for (name, _), traces in self._runs.items()
                if name == problem
                for trace in traces
                for value, violation in zip(trace.objective, trace.violation, strict=True)
                if value is not None and violation == 0
            ),
            default=math.inf,
        )

"""All runs together: which methods, which problems, and how one did on the other."""

import math
from collections.abc import Iterable
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
    "differences",
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


@dataclass(frozen=True)
class Duel:
    """One of ours beside one rival, on one problem, to one target."""

    rival: Entry
    our_time: RunningTime
    rival_time: RunningTime

    @property
    def ratio(self) -> float:
        """Our expected evaluations over theirs, which are at least their longest run's."""
        if not self.rival_time.successes:
            if not self.our_time.successes:
                return math.nan
            return min(self.our_time.expected / self.rival_time.longest, 1.0)
        return self.our_time.expected / self.rival_time.expected


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
    def ours(self) -> list[Entry]:
        return [each for each in self.entries if each.is_ours]

    def runs(self, entry: Entry, problem: str) -> list[Trace]:
        return self._runs.get((problem, entry.method), [])

    def time(
        self, entry: Entry, problem: str, target: float, seeds: set[int] | None = None
    ) -> RunningTime | None:
        """None where the method has no run on the problem (of these seeds)."""
        traces = [t for t in self.runs(entry, problem) if seeds is None or t.seed in seeds]
        if not traces:
            return None
        return running_time(traces, self.best_known[problem], target, entry.slopes_cost)

    def duels(self, own: Entry, problem: str, target: float) -> list[Duel]:
        """Beside every rival, on the seeds that both have; the hardest rival first.

        Those that got there come before those that did not in their budget.
        """
        found = []
        mine = {trace.seed for trace in self.runs(own, problem)}
        for rival in self.entries:
            common = mine & {trace.seed for trace in self.runs(rival, problem)}
            if rival.is_ours or not common:
                continue
            our_time = self.time(own, problem, target, common)
            rival_time = self.time(rival, problem, target, common)
            if our_time is not None and rival_time is not None:
                found.append(Duel(rival, our_time, rival_time))

        def ease(duel: Duel) -> tuple[bool, float]:
            if duel.rival_time.successes:
                return False, -duel.ratio
            return True, -duel.rival_time.longest

        return sorted(found, key=ease)

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

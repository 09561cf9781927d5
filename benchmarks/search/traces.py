"""Runs kept as lines of JSON, one file a problem, packed once a campaign ends.

Within a line every objective that betters the best so far has nine digits; the others have
four and are rounded up, so that none of them seems better than it was.
"""

import gzip
import json
import math
from dataclasses import asdict, dataclass, field
from pathlib import Path

from benchmarks.search.oracle import Oracle

RESULTS = Path(__file__).parents[1] / "results" / "search"


@dataclass(frozen=True)
class Trace:
    """One run of one method.

    Attributes
    ----------
    objective
        At each evaluation; None where it failed.
    violation
        Largest excess of a constraint; 0 where feasible, None where it failed.
    slopes
        How many slopes had been asked for before each evaluation; empty if none ever.
    seconds, evaluating
        Wall time of the run, and what of it went into the problem itself.
    thinking
        Processor seconds of the method itself, all threads; None where they were not taken.
    ended
        Why it ended, in a sentence.
    """

    problem: str
    method: str
    seed: int
    budget: int
    dimension: int
    constraint_count: int
    best_known: float
    seconds: float
    evaluating: float
    ended: str
    objective: list[float | None]
    violation: list[float | None]
    slopes: list[int] = field(default_factory=list)
    thinking: float | None = None

    @property
    def key(self) -> tuple[str, str, int]:
        return self.problem, self.method, self.seed


def trace_of(
    oracle: Oracle, method: str, seconds: float, ended: str, processor: float | None = None
) -> Trace:
    """What an oracle has seen of a run that took so many seconds, of wall and of processor."""
    objective: list[float | None] = []
    violation: list[float | None] = []
    best = math.inf
    for found in oracle.outcomes:
        if found.failure is not None:
            objective.append(None)
            violation.append(None)
            continue
        improves = found.feasible and found.objective < best
        best = found.objective if improves else best
        objective.append(rounded_up(found.objective, 9 if improves else 4))
        violation.append(0.0 if found.feasible else float(f"{found.violation:.2g}"))
    slopes = oracle.slopes_before if any(oracle.slopes_before) else []
    problem = oracle.problem
    return Trace(
        problem=problem.name,
        method=method,
        seed=oracle.seed,
        budget=oracle.budget,
        dimension=problem.dimension,
        constraint_count=problem.constraint_count,
        best_known=problem.best,
        seconds=round(seconds, 3),
        evaluating=round(oracle.evaluating, 3),
        ended=ended,
        objective=objective,
        violation=violation,
        slopes=slopes,
        thinking=None if processor is None else round(processor - oracle.processor, 3),
    )


def rounded_up(value: float, digits: int) -> float:
    """The least number of so many digits that is not below the value."""
    if value == 0:
        return 0.0
    unit = 10.0 ** (math.floor(math.log10(abs(value))) + 1 - digits)
    return float(f"{math.ceil(value / unit) * unit:.{digits}g}")


def keep(trace: Trace, folder: Path = RESULTS) -> None:
    """Appends a line; what was written before is never touched."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / f"{trace.problem}.jsonl").open("a") as file:
        file.write(json.dumps(asdict(trace), separators=(",", ":")) + "\n")


def kept(folder: Path = RESULTS) -> dict[tuple[str, str, int], Trace]:
    """Every run there is, packed or not; of two of one name the later."""
    found = {}
    for path in sorted(folder.glob("*.jsonl.gz")):
        with gzip.open(path, "rt") as file:
            found.update({(t := Trace(**json.loads(line))).key: t for line in file})
    for path in sorted(folder.glob("*.jsonl")):
        for line in path.read_text().splitlines():
            trace = Trace(**json.loads(line))
            found[trace.key] = trace
    return found


def pack(folder: Path = RESULTS) -> None:
    """All lines into one compressed file a problem, the same bytes for the same runs."""
    everything = kept(folder)
    for name in dict.fromkeys(problem for problem, _, _ in everything):
        lines = [
            json.dumps(asdict(everything[key]), separators=(",", ":")) + "\n"
            for key in sorted(everything)
            if key[0] == name
        ]
        packed = gzip.compress("".join(lines).encode(), 9, mtime=0)
        (folder / f"{name}.jsonl.gz").write_bytes(packed)
        (folder / f"{name}.jsonl").unlink(missing_ok=True)

"""What is said of one design, in plain numbers that travel between processes and into files."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeVar

Numbers = Mapping[str, float]
Item = TypeVar("Item")

# The search keeps this far inside each limit, so that a design on a limit still
# holds when it is looked at with a finer or another eye.
SAFETY = 1e-4

# The same for limits at the points of an envelope, which must hold between them, too, and are
# seen at a coarser resolution (`envelope_batch.SEARCHED`).
ENVELOPE_SAFETY = 3e-3

# That resolution is wrong by up to 4e-3 of half a point of efficiency, 2e-5.
_SAFETIES = {"max_efficiency_loss": 2 * ENVELOPE_SAFETY}


def envelope_safety(name: str) -> float:
    """How far inside a limit a search keeps at the points of an envelope."""
    return _SAFETIES.get(name, ENVELOPE_SAFETY)


@dataclass(frozen=True)
class EnvelopeNumbers:
    """What is kept of a design at every point of its envelope, plain numbers.

    Attributes
    ----------
    limits
        By its name each limit that differs from point to point, kept when at most 0; those
        against the given motor among them.
    results
        A few results by name, SI.
    share
        What the envelope adds to the objective without penalty.
    operating
        The same limits at the operating points alone, the worst of them.
    """

    limits: Mapping[str, Sequence[float]]
    results: Mapping[str, Sequence[float]]
    share: float = 0.0
    operating: Numbers = field(default_factory=dict)

    def pointwise(self) -> dict[str, float]:
        """Every limit at every point, and at the operating points, each under its own name."""
        return named_by_point(self.limits, self.operating)


def named_by_point(
    limits: Mapping[str, Sequence[Item]], operating: Mapping[str, Item]
) -> dict[str, Item]:
    """What belongs to a limit, at the operating points and at each point of the envelope."""
    found = {f"{name} at the operating points": item for name, item in operating.items()}
    for name, items in limits.items():
        for place, item in enumerate(items):
            found[f"{name} at point {place + 1} of the envelope"] = item
    return found


@dataclass(frozen=True)
class Outcome:
    """What an evaluator says of one design, in plain numbers.

    Attributes
    ----------
    objective
        What the search minimises, penalty included; NaN when the evaluation failed.
    physical_objective
        The same without penalty, `J_phys` of docs/theory.md section 8.
    approximation
        The linear model's cheap guess of it; NaN when there is none.
    constraints
        Each kept when at most 0, worst over the operating points.
    terms
        Raw terms of the objective for each operating point, before any weight, so
        that weights can be changed without simulating again.
    results
        Every result of each operating point, SI, by its name of docs/theory.md section 10.
    design
        What the point stands for: SI values by path in the motor file.
    failure
        Why there is no objective, in words; None when there is one.
    envelope
        The design at every point of the file's envelope; None without one. Its limits are
        among `constraints`, which hold the worst of all points.
    """

    objective: float
    constraints: Numbers = field(default_factory=dict)
    physical_objective: float = math.nan
    approximation: float = math.nan
    terms: Sequence[Numbers] = ()
    results: Sequence[Numbers] = ()
    design: Mapping[str, float | Sequence[float]] = field(default_factory=dict)
    failure: str | None = None
    envelope: EnvelopeNumbers | None = None

    def with_results_in(self, known: Sequence[Collection[str]]) -> "Outcome":
        """Without the results that nobody has computed, given the names of the others."""
        results = [
            {name: value for name, value in each.items() if name in names}
            for each, names in zip(self.results, known, strict=True)
        ]
        return replace(self, results=results)


def failed(reason: str, constraints: Sequence[str] = ()) -> Outcome:
    """The outcome of an evaluation that gave no numbers."""
    return Outcome(math.nan, dict.fromkeys(constraints, math.nan), failure=reason)

"""The search's record as the report tells it."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from camring.evaluation.record import Record, best_of
from camring.presentation.records import Search, Trial
from camring.report.coordinates import Coordinate

__all__ = ["leave_one_out", "phase_name", "search_of", "starting_note"]

_PHASES = {
    "given": "initial design",
    "initial": "initial design",
    "theory": "initial design",
    "sobol": "initial design",
    "global": "Bayesian search",
    "local": "Bayesian search",
    "bayesian": "Bayesian search",
    "scbo": "Bayesian search",
    "descent": "descent",
    "refine": "refinement",
    "refinement": "refinement",
    "nelder": "refinement",
    "simplex": "refinement",
    "cobyqa": "refinement",
}


def phase_name(phase: str) -> str:
    """A phase in plain words; one that is not known here keeps its own name."""
    first = phase.replace("-", " ").replace("_", " ").split(" ")[0].lower()
    return _PHASES.get(first, phase)


def search_of(
    records: Sequence[Record],
    weights: Sequence[float],
    coordinates: Sequence[Coordinate],
    memory: Mapping[str, Any],
    *,
    stopped: str = "",
    given: int | None = None,
    best: int | None = None,
    notes: Sequence[str] = (),
) -> Search:
    """Every trial with its weighted mean results, and how well the surrogates foretold."""
    errors, used = leave_one_out(memory)
    return Search(
        trials=tuple(_trial(record, weights, coordinates) for record in records),
        stopped=stopped.rstrip("."),
        leave_one_out=errors,
        surrogate_used=used,
        notes=tuple(notes),
        given=given,
        best=best,
    )


def _trial(record: Record, weights: Sequence[float], coordinates: Sequence[Coordinate]) -> Trial:
    names = ("torque_ripple", "efficiency", "max_contact_stress")
    results = {}
    for name in names:
        values = [group.get(name, float("nan")) for group in record.outcome.results]
        if len(values) == len(weights) and np.isfinite(values).all():
            results[name] = float(np.average(values, weights=weights))
    shown = zip(coordinates, record.point, strict=False)
    return Trial(
        number=record.trial,
        phase=phase_name(record.phase),
        objective=record.outcome.objective,
        feasible=record.feasible,
        failed=record.failed,
        variables={f"{c.name}, {c.unit}".rstrip(", "): c.at(float(u)) for c, u in shown},
        results=results,
    )


def leave_one_out(memory: Any) -> tuple[dict[str, float], str]:
    """Errors by surrogate and the one in use, wherever the search's memory keeps them."""
    if isinstance(memory, Sequence) and not isinstance(memory, str):
        inside: Sequence[Any] = memory
    elif isinstance(memory, Mapping):
        found = memory.get("leave_one_out")
        if isinstance(found, Mapping):
            errors = {
                str(name): float(value[0] if isinstance(value, list) else value)
                for name, value in found.items()
                if value is not None
            }
            return errors, str(memory.get("mean", ""))
        inside = list(memory.values())
    else:
        return {}, ""
    for inner in inside:
        errors, used = leave_one_out(inner)
        if errors:
            return errors, used
    return {}, ""


def starting_note(records: Sequence[Record], first: int, theory: bool) -> str:
    """What the search began from, and how much better it ended."""
    start = best_of([record for record in records if record.trial < first])
    end = best_of(records)
    if first < 1:
        return ""
    plural = "" if first == 2 else "s"
    if theory and first > 1:
        beginning = (
            f"The search began from the given motor and {first - 1} design{plural} that theory "
            "gives"
        )
    elif theory:
        beginning = (
            "The search began from the given motor; theory had no design that the space holds"
        )
    else:
        beginning = "The search began from the given motor, without the help of theory"
    if start is None or end is None:
        return f"{beginning}."
    before, after = start.outcome.objective, end.outcome.objective
    return f"{beginning}; the best of these had J = {before:.4g}, the best in the end {after:.4g}."

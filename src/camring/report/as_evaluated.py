"""Designs with the results by which a study evaluated them, where a user's program gave some."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from camring.analyses.simulation import Simulated
from camring.evaluation.record import Record
from camring.evaluation.user_programs.evaluator import from_fact
from camring.presentation.records import Design

__all__ = ["as_evaluated", "who_evaluated"]


def as_evaluated(
    found: Sequence[Simulated], designs: Sequence[Design], records: Sequence[Record | None]
) -> tuple[list[Simulated], tuple[Design, ...]]:
    """The designs with results and margins of their records; curves stay our simulation's.

    Parameters
    ----------
    records
        One for each design; where it failed or is None, our simulation's results stay.
    """
    seen, shown = [], []
    for each, design, record in zip(found, designs, records, strict=True):
        if record is None or record.failed:
            seen.append(each)
            shown.append(design)
            continue
        results = tuple(
            replace(result, metrics={**result.metrics, **kept})
            for result, kept in zip(design.results, record.outcome.results, strict=True)
        )
        seen.append(replace(each, outcome=record.outcome))
        shown.append(replace(design, results=results))
    return seen, tuple(shown)


def who_evaluated(facts: Mapping[str, str]) -> tuple[str, ...]:
    """What a reader must know about where the numbers come from; nothing when all are ours."""
    if "evaluator" not in facts:
        return ()
    return (
        f"The designs were evaluated by `{from_fact(facts['evaluator'])}`: results and margins are "
        "its own, or where it gave none our simulation's. Curves, spectra and sensitivities are "
        "our simulation's alone.",
    )

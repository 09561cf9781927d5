"""Designs that a search has seen and left: much quieter, or more efficient, than its best.

An objective weighs its terms by the file's words. Where the search gives a good number up
for a better objective, whoever wrote those weights may not have meant it, and must hear of it.
"""

import shlex
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from camring.evaluation.record import Record
from camring.files.motor.document import printable
from camring.files.quantities import QUANTITIES

QUIETER = 0.5
"""Of the best design's torque ripple: half of it is 6 dB less, which is heard and measured."""

LEAST_RIPPLE = 5e-4
"""Difference of torque ripple, of the mean torque; below 0.05 % no bench tells two motors apart."""

MORE_EFFICIENT = 0.005
"""Half a point: what ISO 4409's class B instruments can tell, and what a buyer pays for."""

RIPPLE, EFFICIENCY = "torque_ripple", "efficiency"


@dataclass(frozen=True)
class GivenUp:
    """A design that keeps every limit, beside the best one.

    Attributes
    ----------
    name
        The result that it is better in.
    value, kept
        That result of it and of the best design: the mean of the operating points by their
        weights.
    objective, best_objective
        What the search minimises of both.
    """

    name: str
    trial: int
    value: float
    objective: float
    best_trial: int
    kept: float
    best_objective: float

    @property
    def sentence(self) -> str:
        """What was given up for what."""
        quantity = QUANTITIES[self.name]
        there, here = (
            f"{quantity.written(value)} {quantity.unit}" for value in (self.value, self.kept)
        )
        better = "quieter" if self.name == RIPPLE else "more efficient"
        said = f"{quantity.label.lower()} {there}, objective {self.objective:.4g}"
        best = f"{here}, objective {self.best_objective:.4g}"
        return (
            f"Trial {self.trial} keeps every limit and is {better} than the best, trial "
            f"{self.best_trial} ({said}; the best: {best}): the objective preferred other things."
        )


def given_up(
    records: Sequence[Record], best: Record | None, weights: Sequence[float]
) -> list[GivenUp]:
    """The quietest and the most efficient design, where each is much better so than the best.

    Parameters
    ----------
    weights
        Of the operating points.
    """
    if best is None:
        return []
    wanted: tuple[tuple[str, int, Callable[[float, float], bool]], ...] = (
        (RIPPLE, -1, lambda seen, kept: seen <= QUIETER * kept and kept - seen >= LEAST_RIPPLE),
        (EFFICIENCY, 1, lambda seen, kept: seen - kept >= MORE_EFFICIENT),
    )
    found = []
    for name, sign, much_better in wanted:
        values = {
            record.trial: _mean(record, name, weights) for record in records if record.feasible
        }
        usable = {trial: value for trial, value in values.items() if np.isfinite(value)}
        kept = usable.get(best.trial)
        if kept is None:
            continue
        trial = max(usable, key=lambda each: sign * usable[each])
        if much_better(usable[trial], kept):
            objective = next(each.outcome.objective for each in records if each.trial == trial)
            found.append(
                GivenUp(
                    name,
                    trial,
                    usable[trial],
                    objective,
                    best.trial,
                    kept,
                    best.outcome.objective,
                )
            )
    return found


def sentences(found: Sequence[GivenUp], motor: Path) -> list[str]:
    """What was given up, and last the command that shows what lies between."""
    if not found:
        return []
    command = (
        f"camring pareto {shlex.quote(printable(motor))} --of {RIPPLE},{EFFICIENCY} --out front"
    )
    return [*(each.sentence for each in found), f"`{command}` shows the compromises between them."]


def _mean(record: Record, name: str, weights: Sequence[float]) -> float:
    values = [each.get(name, np.nan) for each in record.outcome.results]
    if len(values) != len(weights):
        return float("nan")
    return float(np.average(values, weights=weights))


__all__ = ["GivenUp", "given_up", "sentences"]

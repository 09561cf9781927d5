"""What `camring check` says of a motor's envelope: which limits it keeps there, and where not."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from camring.files.motor import MotorFile
from camring.objective.envelope import EFFICIENCY_LOSS, RIPPLE_RATIO
from camring.studies.envelope_check import EnvelopeCheck, check_envelope
from camring.studies.envelope_words import range_in_words, runs_in_words

AGAINST_GIVEN = (RIPPLE_RATIO, EFFICIENCY_LOSS)
"""Limits against the given motor, which a file's own motor is: they say nothing of it."""


@dataclass(frozen=True, eq=False)
class EnvelopeFacts:
    """A motor in the envelope of its file, or without one from a tenth to all of its pressure."""

    check: EnvelopeCheck

    @classmethod
    def of(cls, file: MotorFile) -> "EnvelopeFacts | None":
        """None for a motor without a pressure drop to drive it anywhere."""
        drops = [float(point.pressure_drop) for point in file.system.operating_points]
        if file.envelope is None and max(drops) <= 0:
            return None
        return cls(check_envelope(file))

    @property
    def limits(self) -> dict[str, Float[np.ndarray, " point"]]:
        """Each limit of the file as a `g <= 0` at every point; NaN where there is no result."""
        faulty = self.check.given.faults != 0
        return {
            name: np.where(faulty, np.nan, values)
            for name, values in self.check.limits[0].items()
            if name not in AGAINST_GIVEN
        }

    @property
    def broken(self) -> list[str]:
        """Limits that do not hold everywhere."""
        return [name for name, values in self.limits.items() if not np.all(values <= 0)]

    @property
    def holds(self) -> bool:
        """Whether the motor keeps what its file asks in an envelope; true where it asks nothing."""
        return not self.check.asked or not (self.broken or np.any(self.check.given.faults))


def print_envelope(facts: EnvelopeFacts, out: Console) -> None:
    """For a file with an envelope each limit's least margin there; then where the motor runs."""
    check = facts.check
    sentence = runs_in_words(check)
    if not check.asked:
        out.print(
            f"Without an \\[envelope] nothing is asked between operating points. The motor "
            f"{escape(sentence)}.",
        )
        return
    table = Table("In the envelope", "Least margin", "At", "Broken at", box=None)
    for name, values in facts.limits.items():
        place, count = _worst(values), int(np.count_nonzero(~(values <= 0)))
        colour = "red" if count else "green"
        margin = f"[{colour}]{-100 * values[place]:+.3g} %[/{colour}]"
        where = f"[red]{count} of {len(values)} points[/red]" if count else ""
        table.add_row(name, margin, check.grid.text(place), where)
    out.print(table)
    out.print(f"The motor {escape(sentence)}.")
    if facts.broken:
        out.print(f"[red]Broken in the envelope:[/red] {', '.join(facts.broken)}.")
    elif not facts.holds:
        count = int(np.count_nonzero(check.given.faults))
        out.print(f"[red]No results at {count} points of the envelope.[/red]")
    else:
        out.print(
            f"[green]Every limit of the envelope holds at {check.grid.count} points of it.[/green]"
        )


def envelope_document(facts: EnvelopeFacts) -> dict[str, Any]:
    """The same in plain numbers, SI."""
    check = facts.check
    grid = check.grid
    limits = {}
    for name, values in facts.limits.items():
        place = _worst(values)
        limits[name] = {
            "g": float(values[place]),
            "shaft_speed": float(grid.shaft_speed[place]),
            "supply_pressure": float(grid.supply_pressure[place]),
            "return_pressure": float(grid.return_pressure[place]),
            "backwards": bool(grid.backwards[place]),
            "broken_at": int(np.count_nonzero(~(values <= 0))),
        }
    return {
        "asked": check.asked,
        "range": range_in_words(check),
        "points": grid.count,
        "without_result": int(np.count_nonzero(check.given.faults)),
        "limits": limits,
        "broken": facts.broken,
        "sentence": runs_in_words(check),
    }


def _worst(values: Float[np.ndarray, " point"]) -> int:
    return int(np.argmax(np.nan_to_num(values, nan=np.inf)))

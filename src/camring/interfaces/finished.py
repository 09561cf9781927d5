"""What came of a study, as a table for people or one document for programs."""

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import typer
from rich.console import Console
from rich.table import Table

from camring.interfaces.config import MotorFile
from camring.interfaces.json_numbers import finite
from camring.interfaces.record import Record
from camring.interfaces.report.limits import MARGIN_BASES
from camring.interfaces.report.quantities import QUANTITIES, change
from camring.interfaces.validation import Validation

NOT_VALIDATED = 3
SHOWN = (
    "torque_ripple",
    "torque_ripple_peak_to_peak",
    "flow_ripple",
    "efficiency",
    "mean_torque",
    "displacement",
    "min_pressure",
    "max_pressure",
    "max_contact_stress",
    "min_undercut_factor",
)
COLOURS = {1: "green", -1: "red", 0: ""}


@dataclass(frozen=True, eq=False)
class Finished:
    """What a study came to.

    Attributes
    ----------
    given, best
        The given motor's evaluation and that of the best design; None when no
        design keeps every limit.
    stopped
        Which test ended the search.
    surrogates
        Leave-one-out errors as JSON text; empty when there was no surrogate.
    """

    folder: Path
    given_file: MotorFile
    given: Record
    best: Record | None
    evaluations: int
    stopped: str
    surrogates: str
    validation: Validation
    report: Path

    @property
    def exit_code(self) -> int:
        """0 when validated, else 3."""
        return 0 if self.validation.validated else NOT_VALIDATED

    def document(self) -> dict[str, Any]:
        """Everything that a program may want to know."""
        return finite(
            {
                "study": str(self.folder),
                "evaluations": self.evaluations,
                "stopped": self.stopped,
                "validated": self.validation.validated,
                "sentence": self.validation.sentence,
                "leave_one_out": json.loads(self.surrogates or "null"),
                "given": _of(self.given),
                "best": None if self.best is None else _of(self.best),
                "files": {
                    "best": None if self.best is None else str(self.folder / "best.toml"),
                    "report": str(self.report),
                    "validation": str(self.folder / "validation.json"),
                    "database": str(self.folder / "study.sqlite"),
                },
            }
        )


def show(finished: Finished, *, as_json: bool) -> int:
    """Prints it; the exit code. With `as_json` the table goes to stderr."""
    console = Console(stderr=as_json, highlight=False)
    for place in range(len(finished.given.outcome.results)):
        console.print(_results(finished, place))
    console.print(_margins(finished))
    console.print(MARGIN_BASES, markup=False)
    if finished.surrogates:
        console.print(_surrogates(finished.surrogates), markup=False)
    console.print(f"{finished.evaluations} evaluations. {finished.stopped}", markup=False)
    console.print(finished.validation.sentence, markup=False)
    # Not through the console, which would break a long path.
    typer.echo(f"Report: {finished.report}", err=as_json)
    if as_json:
        typer.echo(json.dumps(finished.document(), indent=1, allow_nan=False))
    return finished.exit_code


def _results(finished: Finished, place: int) -> Table:
    point = finished.given_file.system.operating_points[place]
    speed, pressure = float(point.shaft_speed) * 9.549296585513721, float(point.supply_pressure)
    title = f"{speed:.4g} rpm, {pressure / 1e5:.4g} bar{', reverse' * point.reverse}"
    table = Table(title=title, title_justify="left")
    table.add_column("")
    for name in ("given", "best", "change"):
        table.add_column(name, justify="right")
    before = finished.given.outcome.results[place]
    after = finished.best.outcome.results[place] if finished.best else None
    for name in SHOWN:
        quantity = QUANTITIES[name]
        row = [f"{quantity.label} {quantity.unit}".strip(), quantity.written(before[name])]
        if after is not None:
            words, better = change(quantity, before[name], after[name])
            colour = COLOURS[better]
            row += [quantity.written(after[name]), f"[{colour}]{words}[/]" if colour else words]
        table.add_row(*row)
    return table


def _margins(finished: Finished) -> Table:
    table = Table(title="Margin of each limit (negative: broken)", title_justify="left")
    table.add_column("")
    table.add_column("given", justify="right")
    table.add_column("best", justify="right")
    best = finished.best.outcome.constraints if finished.best else {}
    for name, value in finished.given.outcome.constraints.items():
        cells = [_margin(value), _margin(best[name]) if best else "–"]
        table.add_row(name.replace("_", " "), *cells)
    return table


def _margin(value: float) -> str:
    if math.isnan(value):
        return "–"
    text = f"{-value:+.4f}".replace("-", "−")
    return text if value <= 0 else f"[red]{text}[/]"


def _surrogates(text: str) -> str:
    found = json.loads(text)
    each = (
        f"{name} {error:.3f}{' (used)' if name == found['used'] else ''}"
        for name, error in found["errors"].items()
    )
    return "Surrogates, error left one out (1 is no better than the mean): " + ", ".join(each)


def _of(record: Record) -> dict[str, Any]:
    return {
        "trial": record.trial,
        "objective": record.outcome.objective,
        "constraints": dict(record.outcome.constraints),
        "results": [dict(each) for each in record.outcome.results],
        "design": dict(record.outcome.design),
    }

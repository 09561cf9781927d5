"""What came of a study, as a table for people or one document for programs."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import typer
from rich.markup import escape
from rich.table import Table

from camring.evaluation.record import Record
from camring.files.json_numbers import finite
from camring.files.motor import MotorFile
from camring.files.point_names import name_of
from camring.files.quantities import QUANTITIES, change
from camring.files.visible import say
from camring.presentation.console import console
from camring.presentation.limits import MARGIN_BASES
from camring.studies.given_up import GivenUp, sentences
from camring.studies.study_folder import GIVEN_NAME
from camring.studies.validation import Validation

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
    "l10_life",
)
LIFE = "l10_life"
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
    given_up
        Designs much quieter or more efficient that the search left for a better objective.
    warnings
        What simulation says of the best motor besides its results.
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
    given_up: Sequence[GivenUp] = ()
    warnings: Sequence[str] = ()

    @property
    def remarks(self) -> list[str]:
        """What to know of the best motor, what was given up and how to see more of it."""
        said = [f"Best: {sentence}" for sentence in self.warnings]
        return said + sentences(self.given_up, self.folder / GIVEN_NAME)

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
                "warning": self.validation.warning,
                "envelope": self.validation.envelope,
                "leave_one_out": json.loads(self.surrogates or "null"),
                "given_up": [asdict(each) for each in self.given_up],
                "warnings": list(self.warnings),
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
    out = console(stderr=as_json)
    for place in range(len(finished.given.outcome.results)):
        out.print(_results(finished, place))
    out.print(_margins(finished))
    out.print(MARGIN_BASES, markup=False)
    if finished.surrogates:
        out.print(_surrogates(finished.surrogates), markup=False)
    out.print(f"{finished.evaluations} evaluations. {finished.stopped}", markup=False)
    out.print(finished.validation.sentence, markup=False)
    if finished.validation.warning:
        out.print(finished.validation.warning, style="yellow", markup=False)
    for remark in finished.remarks:
        say(remark, err=as_json)
    # Not through the console: a terminal would break a long path.
    say(f"Report: {finished.report}", err=as_json)
    if as_json:
        typer.echo(json.dumps(finished.document(), indent=1, allow_nan=False))
    return finished.exit_code


def _results(finished: Finished, place: int) -> Table:
    title = name_of(finished.given_file.system.operating_points[place])
    table = Table(title=escape(title), title_justify="left")
    table.add_column("")
    for name in ("given", "best", "change"):
        table.add_column(name, justify="right")
    before = finished.given.outcome.results[place]
    after = finished.best.outcome.results[place] if finished.best else None
    for name in _shown(before):
        quantity = QUANTITIES[name]
        row = [f"{quantity.label} {quantity.unit}".strip(), quantity.written(before[name])]
        if after is not None:
            words, better = change(quantity, before[name], after[name])
            colour = COLOURS[better]
            row += [quantity.written(after[name]), f"[{colour}]{words}[/]" if colour else words]
        table.add_row(*row)
    return table


def _shown(results: Mapping[str, float]) -> list[str]:
    """Life only where there is one: without a rated load rollers last for ever."""
    return [name for name in SHOWN if name != LIFE or math.isfinite(results.get(LIFE, math.inf))]


def _margins(finished: Finished) -> Table:
    table = Table(title="Least margins in the search (negative: broken)", title_justify="left")
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
    text = f"{100 * (0.0 - value):+.3g} %".replace("-", "−")  # on the limit there is no minus
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

"""A simulated motor as a table for people or one document for programs."""

import json
import platform
from importlib.metadata import version
from math import pi
from typing import Any

from rich.console import Console
from rich.table import Table

from camring import __version__
from camring.interfaces.config.document import printable
from camring.interfaces.json_numbers import finite
from camring.interfaces.report.quantities import GROUPS, QUANTITIES, significant
from camring.interfaces.simulated import Simulated
from camring.metrics.accuracy import Accurate

WIDTH_IN_PIPES = 100


def console() -> Console:
    """Where tables go: stdout, wide enough where no terminal says how wide."""
    found = Console(highlight=False, soft_wrap=False)
    return found if found.is_terminal else Console(width=WIDTH_IN_PIPES, highlight=False)


def print_table(found: Simulated) -> None:
    """Every result with its unit, one column for each operating point."""
    out = console()
    out.print(_results(found))
    if found.numerical_error:
        worst, most = max(found.numerical_error), max(map(_elements, found.climbed))
        wanted = found.climbed[0].accuracy
        out.print(
            f"Numerical error: at most {worst:.1g} of any result (estimated; {wanted:g} wanted, "
            f"{most} elements a lobe)."
        )
    print_verdict(found, out)


def print_verdict(found: Simulated, out: Console) -> None:
    """Warnings, and whether the constraints hold."""
    for sentence in found.warnings():
        out.print(f"[yellow]Warning:[/yellow] {_plain(sentence)}")
    broken = found.broken
    if found.outcome.failure:
        out.print("[red]The simulation failed; its numbers mean nothing.[/red]")
    elif broken:
        out.print(f"[red]Broken:[/red] {', '.join(broken)}.")
    else:
        out.print(f"[green]All {len(found.outcome.constraints)} constraints hold.[/green]")


def title(found: Simulated) -> str:
    """The motor's name, else its file's."""
    return found.file.system.motor.name or printable(found.file.path)


def _results(found: Simulated) -> Table:
    table = Table(title=_plain(title(found)), title_justify="left", box=None, pad_edge=False)
    table.add_column("")
    table.add_column("")
    for point in found.file.system.operating_points:
        speed = float(point.shaft_speed) * 30 / pi
        supply = float(point.supply_pressure) / 1e5
        way = "\nreverse" * point.reverse
        table.add_column(f"{speed:.4g} rpm\n{supply:.4g} bar{way}", justify="right")
    for name, quantities in GROUPS:
        table.add_row(f"[bold]{name}[/bold]")
        for quantity in quantities:
            values = [quantity.written(each[quantity.name]) for each in found.outcome.results]
            table.add_row(f"  {quantity.label}", quantity.unit, *values)
    return table


def _plain(text: str) -> str:
    """Text in which brackets are brackets and no style of the terminal's."""
    from rich.markup import escape

    return escape(text)


def document(found: Simulated) -> str:
    """One JSON document, SI, under the names of model.md section 10."""
    file, outcome = found.file, found.outcome
    records: list[dict[str, Any]] = []
    for place, results in enumerate(outcome.results):
        record: dict[str, Any] = dict(results)
        record["periodicity_residual"] = float(found.cycles[place].periodicity_residual)
        if found.errors:
            record["numerical_error"] = found.numerical_error[place]
            record["errors"] = found.errors[place]
            record["elements"] = _elements(found.climbed[place])
            record["accuracy_reached"] = found.climbed[place].reached
        records.append(record)
    return json.dumps(
        finite(
            {
                "input": printable(file.path),
                "name": file.system.motor.name,
                "versions": versions(),
                "results": records,
                "objective": outcome.objective,
                "physical_objective": outcome.physical_objective,
                "constraints": outcome.constraints,
                "feasible": not outcome.failure and not found.broken,
                "numerical_error": max(found.numerical_error) if found.errors else None,
                "accuracy": found.climbed[0].accuracy if found.errors else None,
                "accuracy_reached": all(each.reached for each in found.climbed)
                if found.errors
                else None,
                "failure": outcome.failure,
                "warnings": found.warnings(),
            }
        ),
        indent=1,
        allow_nan=False,
    )


def _elements(climbed: Accurate) -> int:
    return climbed.resolution.elements


def versions() -> dict[str, str]:
    """What computed the numbers."""
    return {
        "camring": __version__,
        "python": platform.python_version(),
        "jax": version("jax"),
        "numpy": version("numpy"),
    }


def written(name: str, si: float) -> str:
    """A result with its unit, for people."""
    quantity = QUANTITIES.get(name)
    if quantity is None:
        return significant(si)
    return f"{quantity.written(si)} {quantity.unit}".rstrip()

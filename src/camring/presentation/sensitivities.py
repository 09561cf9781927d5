"""Sensitivities as tables for people and one document for programs."""

import json

import numpy as np
from rich.table import Table

from camring.analyses.sensitivities import Sensitivities
from camring.files.json_numbers import finite
from camring.files.motor.document import printable
from camring.files.result_names import quantity
from camring.presentation.console import console
from camring.presentation.simulation import versions


def show(found: Sensitivities) -> None:
    """Variables by how much they matter, limits by what they cost, and a word on both."""
    out = console()
    out.print(f"{printable(found.place)}: {found.source}. J = {found.objective:.6g}.", markup=False)
    out.print(_variables(found))
    out.print(_limits(found))
    if found.is_optimum:
        out.print(f"An optimum: {100 * found.left:.2g} % of J's slope is left over.", markup=False)
    else:
        out.print(
            f"[yellow]Not an optimum:[/yellow] {100 * found.left:.0f} % of J's slope is explained "
            "by no limit, so what relaxing one would buy is not known. `camring optimise` first."
        )


def _variables(found: Sensitivities) -> Table:
    title = "Change when a number goes up by 1 % of its range, most important first"
    table = Table(title=title, title_justify="left", box=None, pad_edge=False)
    table.add_column("", no_wrap=True)
    table.add_column("J\n%", justify="right")
    names = list(found.results)
    for name in names:
        shown = quantity(name)
        table.add_column(f"{shown.label}\n{shown.unit}", justify="right")
    objective = found.per_variable["objective"]
    for place in np.argsort(-np.abs(objective)):
        cells = [_signed(100 * objective[place] / abs(found.objective))]
        cells += [
            _signed(found.per_variable[name][place] * quantity(name).factor) for name in names
        ]
        table.add_row(found.variables[place].rpartition(".")[2], *cells)
    return table


def _limits(found: Sensitivities) -> Table:
    table = Table(title="Limits", title_justify="left", box=None, pad_edge=False)
    table.add_column("")
    table.add_column("margin\n%", justify="right")
    table.add_column("1 % relaxed\nchanges J by, %", justify="right")
    for name, margin in sorted(found.margins.items(), key=lambda each: each[1]):
        bought = found.bought.get(name)
        cost = "" if bought is None else _signed(-100 * bought / abs(found.objective))
        colour = "red" if margin < 0 else ""
        text = _signed(100 * margin)
        words = name.replace("_", " ") + (" (binds)" if bought is not None else "")
        table.add_row(words, f"[{colour}]{text}[/]" if colour else text, cost)
    for name, bought in found.at_bounds.items():
        table.add_row(name, "0", _signed(-100 * bought / abs(found.objective)))
    return table


def _signed(value: float) -> str:
    return f"{value:+.3g}".replace("-", "−") if abs(value) >= 5e-7 else "0"


def document(found: Sensitivities) -> str:
    """One JSON document, SI; changes are those for 1 % of a range or of a limit's scale."""
    return json.dumps(
        finite(
            {
                "input": printable(found.place),
                "design": found.source,
                "versions": versions(),
                "objective": found.objective,
                "results": found.results,
                "per_variable": {
                    name: dict(zip(found.variables, values.tolist(), strict=True))
                    for name, values in found.per_variable.items()
                },
                "margins": found.margins,
                "relaxing_lowers_objective_by": {**found.bought, **found.at_bounds},
                "slope_left": found.left,
                "is_optimum": found.is_optimum,
            }
        ),
        indent=1,
        allow_nan=False,
    )

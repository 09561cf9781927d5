"""The ranking of layouts as a table for people, a CSV file and one document for programs."""

import json
from math import nan
from typing import Any

import typer
from rich.table import Table

from camring.analyses.layouts.studied import WORST, Studies, worst
from camring.files.csv_table import Decimal, csv_table, named
from camring.files.json_numbers import finite
from camring.files.motor.document import printable
from camring.files.result_names import quantity
from camring.files.visible import say
from camring.files.whole_file import write_safely
from camring.presentation.console import console
from camring.presentation.simulation import versions

TABLE, PICTURE = "ranking.csv", "ranking.svg"
NOT_VALIDATED = 3
SHORT = {
    "torque_ripple": "ripple",
    "efficiency": "efficiency",
    "max_contact_stress": "stress",
    "max_pressure_angle": "angle",
    "stroke": "stroke",
}
"""What the table on a terminal calls them."""


def write(found: Studies, decimal: Decimal = Decimal.POINT) -> None:
    """ranking.csv and ranking.svg in the folder, in place of those of an earlier run."""
    from camring.plots import drawable

    write_safely(found.folder / TABLE, csv_text(found, decimal).encode("utf-8"))
    if any(each.best for each in found.ranked) and drawable():
        from camring.plots import layouts_ranked, save

        save(layouts_ranked(found), found.folder / PICTURE)


def csv_text(found: Studies, decimal: Decimal = Decimal.POINT) -> str:
    """A row for each layout; refused ones last, with the reason."""
    columns = [
        *("rank", "pistons", "lobes", named("torque_order", "1/rev"), "radial_load"),
        *("objective", "given_objective"),
        *(named(name, quantity(name).unit) for name in WORST),
        *("evaluations", "validated", "says"),
    ]
    rows: list[list[Any]] = []
    for rank, each in enumerate(found.ranked, 1):
        best = each.best
        values = [nan] * len(WORST)
        if best:
            values = [worst(each, name) * quantity(name).factor for name in WORST]
        rows.append(
            [
                rank if best else nan,
                *_counts(each),
                best.outcome.objective if best else nan,
                each.given.outcome.objective,
                *values,
                each.evaluations,
                each.validated,
                each.sentence,
            ]
        )
    for refused in found.refused:
        blank = [nan] * (2 + len(WORST) + 1)
        rows.append([nan, *_counts(refused), *blank, False, f"Not built: {refused.reason}."])
    return csv_table(columns, rows, decimal=decimal)


def _counts(each: Any) -> list[Any]:
    layout = each.layout
    return [
        layout.pistons,
        layout.lobes,
        layout.surviving_order,
        "balanced" if layout.balanced else "turning",
    ]


def show(found: Studies, *, as_json: bool) -> int:
    """Prints it; the exit code: 3 when the first in rank is not validated."""
    if as_json:
        typer.echo(json.dumps(document(found), indent=1, allow_nan=False))
    else:
        out = console()
        out.print(_table(found))
        for each in found.ranked:
            if not each.validated:
                out.print(f"{each.layout}: {each.sentence}", markup=False)
        for refused in found.refused:
            out.print(f"{refused.layout} {refused.reason}.", markup=False)
    first = found.ranked[0]
    if first.best is not None:
        say(f"Best: {first.folder / 'best.toml'}", err=as_json)
    say(f"Wrote {TABLE}, and a study of each layout, in {found.folder}.", err=as_json)
    return 0 if first.validated else NOT_VALIDATED


def document(found: Studies) -> dict[str, Any]:
    """Everything that a program may want to know; results in SI."""
    return finite(
        {
            "input": printable(found.file.path),
            "versions": versions(),
            "ranked": [
                {
                    "layout": str(each.layout),
                    "pistons": each.layout.pistons,
                    "lobes": each.layout.lobes,
                    "torque_order": each.layout.surviving_order,
                    "balanced": each.layout.balanced,
                    "objective": each.best.outcome.objective if each.best else None,
                    "given_objective": each.given.outcome.objective,
                    "worst": {name: worst(each, name) for name in WORST} if each.best else None,
                    "evaluations": each.evaluations,
                    "validated": each.validated,
                    "sentence": each.sentence,
                    "study": str(each.folder),
                }
                for each in found.ranked
            ],
            "refused": [
                {"layout": str(each.layout), "reason": each.reason} for each in found.refused
            ],
        }
    )


def _table(found: Studies) -> Table:
    table = Table(box=None, pad_edge=False)
    for name in ("", "layout", "J"):
        table.add_column(name, justify="left" if name == "layout" else "right")
    for name, short in SHORT.items():
        table.add_column(f"{short}\n{quantity(name).unit}", justify="right")
    for name in ("order\n1/rev", "radial\nload", "valid"):
        table.add_column(name, justify="right")
    for rank, each in enumerate(found.ranked, 1):
        words = f"{each.layout}{' (given)' * (each.layout == found.own)}"
        values = (
            [quantity(name).written(worst(each, name)) for name in SHORT]
            if each.best
            else ["–"] * len(SHORT)
        )
        table.add_row(
            f"{rank}" if each.best else "",
            words,
            f"{each.best.outcome.objective:.4g}" if each.best else "–",
            *values,
            f"{each.layout.surviving_order}",
            "balanced" if each.layout.balanced else "turning",
            "yes" if each.validated else "no",
        )
    return table

"""The ranking of layouts as a table for people, a CSV file and one document for programs."""

import csv
import io
import json
from typing import Any

import typer
from rich.table import Table

from camring.interfaces.config.document import printable
from camring.interfaces.grid import plain_unit, quantity
from camring.interfaces.json_numbers import finite
from camring.interfaces.layouts.study import Studied, Studies
from camring.interfaces.simulation_output import console, versions
from camring.interfaces.study_folder import write_safely

TABLE, PICTURE = "ranking.csv", "ranking.svg"
NOT_VALIDATED = 3
WORST = {
    "torque_ripple": max,
    "efficiency": min,
    "max_contact_stress": max,
    "max_pressure_angle": max,
    "stroke": max,
}
"""Results in the ranking, each at the operating point where it is worst."""

SHORT = {
    "torque_ripple": "ripple",
    "efficiency": "efficiency",
    "max_contact_stress": "stress",
    "max_pressure_angle": "angle",
    "stroke": "stroke",
}
"""What the table on a terminal calls them."""


def worst(each: Studied, name: str) -> float:
    """A result of the best design at its worst operating point, SI."""
    assert each.best is not None
    return WORST[name](result[name] for result in each.best.outcome.results)


def write(found: Studies) -> None:
    """ranking.csv and ranking.svg in the folder, in place of those of an earlier run."""
    from camring.interfaces.plots import drawable

    write_safely(found.folder / TABLE, csv_text(found).encode("utf-8"))
    if any(each.best for each in found.ranked) and drawable():
        from camring.interfaces.plots import layouts_ranked, save

        save(layouts_ranked(found), found.folder / PICTURE)


def csv_text(found: Studies) -> str:
    """Names, units, then a row for each layout; refused ones last, with the reason."""
    file = io.StringIO()
    rows = csv.writer(file, lineterminator="\n")
    own = [
        "rank",
        "pistons",
        "lobes",
        "torque_order",
        "radial_load",
        "objective",
        "given_objective",
    ]
    rows.writerow([*own, *WORST, "evaluations", "validated", "says"])
    units = [plain_unit(quantity(name).unit) for name in WORST]
    rows.writerow(["", "", "", "1/rev", "", "", "", *units, "", "", ""])
    for rank, each in enumerate(found.ranked, 1):
        best = each.best
        values: list[Any] = [""] * len(WORST)
        if best:
            values = [worst(each, name) * quantity(name).factor for name in WORST]
        rows.writerow(
            [
                rank if best else "",
                *_counts(each),
                best.outcome.objective if best else "",
                each.given.outcome.objective,
                *values,
                each.evaluations,
                "yes" if each.validated else "no",
                each.sentence,
            ]
        )
    for refused in found.refused:
        blank = [""] * (2 + len(WORST) + 1)
        rows.writerow(["", *_counts(refused), *blank, "no", f"Not built: {refused.reason}."])
    return file.getvalue()


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
        typer.echo(f"Best: {first.folder / 'best.toml'}", err=as_json)
    typer.echo(f"Wrote {TABLE}, and a study of each layout, in {found.folder}.", err=as_json)
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

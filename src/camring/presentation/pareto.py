"""A front as a folder, a table for people, and one document for programs."""

import json
from pathlib import Path

import numpy as np
import typer
from rich.table import Table

from camring.files.csv_table import Decimal, csv_table, named
from camring.files.errors import InputError
from camring.files.json_numbers import finite
from camring.files.motor.document import printable
from camring.files.new_file import whole_folder, write_new_file
from camring.files.result_names import quantity, result_names
from camring.files.visible import say
from camring.presentation.built_motors import si_unit_of_key
from camring.presentation.console import console
from camring.presentation.simulation import versions
from camring.studies.pareto import INDEPENDENT_AGREEMENT, TradeOff
from camring.studies.study_folder import require_vacant

TABLE, PICTURE, DESIGNS = "front.csv", "front.svg", "designs"
NOT_VALIDATED = 3
SHOWN = 7  # designs in the table on a terminal


def require_place(folder: Path) -> None:
    """Refuse a folder that is there before work begins."""
    require_vacant(folder)
    if not folder.parent.is_dir():
        where = printable(folder.parent)
        raise InputError(
            printable(folder), f"lies in {where}, which does not exist", f"make {where} first"
        )


def write(found: TradeOff, folder: Path, decimal: Decimal = Decimal.POINT) -> None:
    """front.csv, front.svg where matplotlib is, and a complete motor file of each design."""
    from camring.plots import drawable

    with whole_folder(folder) as draft:
        (draft / DESIGNS).mkdir()
        for number, each in enumerate(found.compromises, 1):
            write_new_file(draft / DESIGNS / f"{number:02d}.toml", each.text)
        write_new_file(draft / TABLE, csv_text(found, decimal))
        if drawable():
            from camring.plots import front, save

            save(front(found), draft / PICTURE)


def csv_text(found: TradeOff, decimal: Decimal = Decimal.POINT) -> str:
    """A row for each design: traded results, variables, every result.

    Variables are in SI, cam modes as amplitudes in m; results in the units of a report,
    those of one operating point with its number behind them.
    """
    space, system = found.file.design_space, found.file.system
    assert space is not None
    count = len(system.operating_points)
    names = result_names()
    units = {name: quantity(name).unit for name in names}
    columns = [
        named(f"{name}.{place}", units[name]) for place in range(1, count + 1) for name in names
    ]
    relative = {each.name for each in space.variables if each.relative}
    rows = []
    for number, each in enumerate(found.compromises, 1):
        values = [
            float(value) * quantity(name).factor
            for name, value in zip(found.names, each.values, strict=True)
        ]
        results = [
            float(result[name]) * quantity(name).factor
            for result in each.outcome.results
            for name in names
        ]
        described = space.describe(system, each.point).values()
        rows.append([number, *values, *map(float, described), *results])
    return csv_table(
        [
            "design",
            *(named(name, quantity(name).unit) for name in found.names),
            *(
                named(name, "" if name in relative else si_unit_of_key(found.file, name))
                for name in space.names
            ),
            *columns,
        ],
        rows,
        decimal=decimal,
    )


def show(found: TradeOff, folder: Path, *, as_json: bool) -> int:
    """Prints it; the exit code: 3 when SciPy's solver disagrees."""
    if as_json:
        typer.echo(json.dumps(document(found, folder), indent=1, allow_nan=False))
    else:
        out = console()
        out.print(_table(found))
        for sentence in sentences(found):
            out.print(sentence, markup=False)
    files = TABLE + f", {PICTURE}" * (folder / PICTURE).exists()
    say(f"Wrote {files} and {DESIGNS}/ in {folder}.", err=as_json)
    return 0 if found.independent <= INDEPENDENT_AGREEMENT else NOT_VALIDATED


def sentences(found: TradeOff) -> list[str]:
    """How many, how fast, how wide, how sure."""
    said = [
        f"{len(found.compromises)} designs, none beaten by another, every limit kept at finer "
        f"resolution; {found.evaluations} evaluations after {found.screened} screened.",
        f"{found.search_seconds:.1f} s to trace, {found.check_seconds:.1f} s to look again. "
        f"Hypervolume {found.volume:.4f} of the front's own box and a tenth around.",
        f"Not confirmed by another solver: {found.unconfirmed}."
        if found.unconfirmed
        else f"SciPy's stiff solver agrees on {found.sample} of them to {found.independent:.1e}.",
    ]
    if found.dropped:
        said.append(f"{len(found.dropped)} left out, the first as it {found.dropped[0]}.")
    return said


def document(found: TradeOff, folder: Path) -> dict:
    """Everything that a program may want to know; results in SI."""
    return finite(
        {
            "input": printable(found.file.path),
            "versions": versions(),
            "of": list(found.names),
            "given": dict(zip(found.names, found.given.tolist(), strict=True)),
            "designs": [
                {
                    "file": str(folder / DESIGNS / f"{number:02d}.toml"),
                    "values": dict(zip(found.names, each.values.tolist(), strict=True)),
                    "constraints": dict(each.outcome.constraints),
                }
                for number, each in enumerate(found.compromises, 1)
            ],
            "evaluations": found.evaluations,
            "screened": found.screened,
            "search_seconds": found.search_seconds,
            "check_seconds": found.check_seconds,
            "hypervolume": found.volume,
            "independent_difference": found.independent,
            "unconfirmed": found.unconfirmed or None,
            "left_out": list(found.dropped),
        }
    )


def _table(found: TradeOff) -> Table:
    table = Table(box=None, pad_edge=False)
    table.add_column("design")
    for name in found.names:
        shown = quantity(name)
        table.add_column(f"{shown.label} {shown.unit}".strip(), justify="right")
    count = len(found.compromises)
    for place in np.unique(np.linspace(0, count - 1, min(SHOWN, count)).round().astype(int)):
        values = found.compromises[place].values
        table.add_row(f"{DESIGNS}/{place + 1:02d}.toml", *_cells(found, values))
    words = "as given" if found.given_keeps_limits else "as given (breaks a limit)"
    table.add_row(words, *_cells(found, found.given))
    return table


def _cells(found: TradeOff, values: np.ndarray) -> list[str]:
    return [quantity(name).written(float(si)) for name, si in zip(found.names, values, strict=True)]

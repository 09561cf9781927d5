"""`camring tolerance`: what tolerances make of a motor's results."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from camring.cli.options import JsonOption
from camring.cli.unfinished import requested, work_on
from camring.files.csv_table import Decimal, DecimalOption

if TYPE_CHECKING:
    from camring.evaluation.unfinished import Request
    from camring.files.motor import MotorFile


def tolerance(
    motor: Annotated[Path, typer.Argument(help="Motor file with [tolerances].")],
    samples: Annotated[
        int, typer.Option(min=16, max=1_000_000, help="Motors to build; best a power of two.")
    ] = 1024,
    seed: Annotated[int, typer.Option(min=0, help="What all chance comes from.")] = 0,
    out: Annotated[
        Path | None,
        typer.Option("--out", help="Folder to make for samples.csv and scatter.svg."),
    ] = None,
    decimal: DecimalOption = Decimal.POINT,
    json: JsonOption = False,
) -> None:
    """Build a motor many times within its tolerances: mean, scatter, limits kept, causes.

    Every tolerance of [tolerances] is drawn from its distribution, the same in every motor's
    parts alike. How much of each result's variance comes from which tolerance is found by exact
    slopes and by a regression on the samples. With --out, what was stopped goes on by the same
    command, or by `camring resume FOLDER`.
    """
    from camring.presentation.pareto import require_place

    if out is not None:
        require_place(out)

    request, file = requested("tolerance", motor, samples=samples, seed=seed, decimal=decimal.value)
    raise typer.Exit(carry_out(request, file, out, as_json=json))


def carry_out(request: "Request", file: "MotorFile", out: Path | None, *, as_json: bool) -> int:
    """Also what was begun before; the exit code."""
    from camring.analyses.tolerance import study_tolerances
    from camring.evaluation.unfinished import done
    from camring.presentation.tolerance import document, print_files, show, write

    given = request.options
    with work_on(request, out) as (remember, say):
        found = study_tolerances(file, given["samples"], given["seed"], say=say, remember=remember)
    if out is not None:
        write(found, out, Decimal(given["decimal"]))
        done(out)
    if as_json:
        typer.echo(document(found))
    else:
        show(found)
    if out is not None:
        print_files(out, as_json=as_json)
    return 0

"""`camring tolerance`: what tolerances make of a motor's results."""

from pathlib import Path
from typing import Annotated

import typer

from camring.cli.options import JsonOption
from camring.files.csv_table import Decimal, DecimalOption


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
    slopes and by a regression on the samples.
    """
    from camring.presentation.pareto import require_place

    if out is not None:
        require_place(out)

    from camring.analyses.tolerance import study_tolerances
    from camring.evaluation.progress import Spoken
    from camring.files.motor import read_motor_file
    from camring.presentation.tolerance import document, print_files, show, write

    with Spoken("Reading the motor file.") as say:
        found = study_tolerances(read_motor_file(motor), samples, seed, say=say)
    if json:
        typer.echo(document(found))
    else:
        show(found)
    if out is not None:
        write(found, out, decimal)
        print_files(out, as_json=json)

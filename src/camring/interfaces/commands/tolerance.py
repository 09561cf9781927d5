"""`camring tolerance`: what tolerances make of a motor's results."""

from pathlib import Path
from typing import Annotated

import typer


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
    json: Annotated[
        bool, typer.Option("--json", help="One document on stdout, all else on stderr.")
    ] = False,
) -> None:
    """Build a motor many times within its tolerances: mean, scatter, limits kept, causes.

    Every tolerance of [tolerances] is drawn from its distribution, the same in every motor's
    parts alike. How much of each result's variance comes from which tolerance is told by exact
    slopes and by a regression on the samples.
    """
    from camring.interfaces.trade_off_output import require_place

    if out is not None:
        require_place(out)

    from camring.interfaces.config import read_motor_file
    from camring.interfaces.tolerance_output import document, show, told, write
    from camring.interfaces.tolerance_study import study_tolerances

    found = study_tolerances(
        read_motor_file(motor),
        samples,
        seed,
        say=lambda sentence: typer.echo(sentence, err=True),
    )
    if json:
        typer.echo(document(found))
    else:
        show(found)
    if out is not None:
        write(found, out)
        told(out, as_json=json)

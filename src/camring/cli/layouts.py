"""`camring layouts`: which number of pistons on which number of lobes is best."""

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from camring.cli.options import AllowOption, JsonOption
from camring.files.csv_table import Decimal, DecimalOption
from camring.files.visible import say


def layouts(
    motor: Annotated[Path, typer.Argument(help="Motor file with a [design_space].")],
    pistons: Annotated[str, typer.Option("--pistons", help="Counts, such as 5,7,8 or 5..9.")],
    lobes: Annotated[str, typer.Option("--lobes", help="Counts, such as 4,6.")],
    out: Annotated[
        Path, typer.Option("--out", help="Folder to make, or one to go on with after a stop.")
    ],
    budget: Annotated[
        int | None,
        typer.Option(min=1, help="Model evaluations of each layout; else that of the file."),
    ] = None,
    seed: Annotated[
        int | None,
        typer.Option(min=0, help="Where all chance comes from; else that of the file, or 0."),
    ] = None,
    allow_evaluator: AllowOption = False,
    decimal: DecimalOption = Decimal.POINT,
    json: JsonOption = False,
) -> None:
    """Optimise one motor of every layout, pistons by lobes, and rank them.

    Each keeps the given motor's displacement, outer radius, pistons, rollers, operating points and
    limits; the stroke follows. Each is a study of its own in the folder, which
    `camring report` and `camring compare` understand. Stopped, the same command goes on.
    """
    from camring.analyses.layouts.layout import layouts_of

    wanted = layouts_of(pistons, lobes)

    from camring.evaluation.consent import ask_at_terminal
    from camring.evaluation.progress import SearchProgress
    from camring.presentation.layouts import show, write
    from camring.workflows.layouts import layouts

    found = layouts(
        motor,
        out,
        wanted,
        budget=budget,
        seed=seed,
        allow_evaluator=allow_evaluator or ask_at_terminal,
        watch=SearchProgress,
        say=partial(say, err=True),
    )
    write(found, decimal)
    raise typer.Exit(show(found, as_json=json))

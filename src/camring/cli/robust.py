"""`camring robust`: a design that stays good when it is built."""

from pathlib import Path
from typing import Annotated

import typer

from camring.cli.options import JsonOption
from camring.files.csv_table import Decimal, DecimalOption


def robust(
    motor: Annotated[Path, typer.Argument(help="Motor file with [design_space] and [tolerances].")],
    out: Annotated[Path, typer.Option("--out", help="Folder to make; nothing may be there.")],
    quantile: Annotated[
        float | None,
        typer.Option(min=0.5, max=0.99, help="Minimise this quantile of the objective; else 0.95."),
    ] = None,
    sigmas: Annotated[
        float | None,
        typer.Option(min=0.0, max=6.0, help="Minimise mean + so many standard deviations instead."),
    ] = None,
    samples: Annotated[
        int, typer.Option(min=8, max=1024, help="Motors that each design is built as.")
    ] = 64,
    checked: Annotated[
        int, typer.Option(min=64, max=1_000_000, help="Fresh motors of the check.")
    ] = 1024,
    budget: Annotated[
        int | None, typer.Option(min=1, help="Designs of each search; else that of [search].")
    ] = None,
    seed: Annotated[
        int | None, typer.Option(min=0, help="What all chance comes from; else that of [search].")
    ] = None,
    decimal: DecimalOption = Decimal.POINT,
    json: JsonOption = False,
) -> None:
    """Find the design whose worse motors are best, and compare it with the nominal optimum.

    Each limit of [constraints] is kept at the same quantile, or mean plus standard
    deviations, as is minimised of the objective. Both designs are then built anew. The folder
    gets robust.toml, nominal.toml, comparison.svg and the samples of both.
    """
    from camring.files.errors import InputError
    from camring.presentation.pareto import require_place

    if quantile is not None and sigmas is not None:
        raise InputError("--quantile", "and --sigmas exclude each other", "give one of them")
    require_place(out)

    from camring.evaluation.progress import Spoken
    from camring.files.motor import read_motor_file
    from camring.presentation.robust import show, write
    from camring.search.scatter.statistic import MeanPlus, SmoothQuantile, Statistic
    from camring.studies.robust import robust_design

    statistic: Statistic = (
        MeanPlus(sigmas) if sigmas is not None else SmoothQuantile(quantile or 0.95)
    )
    file = read_motor_file(motor)
    with Spoken("Reading the motor file.") as say:
        found = robust_design(
            file,
            statistic,
            statistic,
            samples=samples,
            checked=checked,
            budget=budget,
            seed=file.search.seed if seed is None else seed,
            say=say,
        )
    write(found, out, decimal)
    raise typer.Exit(show(found, out, as_json=json))

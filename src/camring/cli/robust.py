"""`camring robust`: a design that stays good when it is built."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from camring.cli.options import JsonOption
from camring.cli.unfinished import requested, work_on
from camring.files.csv_table import Decimal, DecimalOption

if TYPE_CHECKING:
    from camring.evaluation.unfinished import Request
    from camring.files.motor import MotorFile


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
    gets robust.toml, nominal.toml, comparison.svg and the samples of both. What was stopped goes
    on by the same command, or by `camring resume FOLDER`.
    """
    from camring.files.errors import InputError
    from camring.presentation.pareto import require_place

    if quantile is not None and sigmas is not None:
        raise InputError("--quantile", "and --sigmas exclude each other", "give one of them")
    require_place(out)
    request, file = requested(
        "robust",
        motor,
        quantile=quantile,
        sigmas=sigmas,
        samples=samples,
        checked=checked,
        budget=budget,
        seed=seed,
        decimal=decimal.value,
    )
    raise typer.Exit(carry_out(request, file, out, as_json=json))


def carry_out(request: "Request", file: "MotorFile", out: Path, *, as_json: bool) -> int:
    """Also what was begun before; the exit code."""
    from camring.evaluation.unfinished import done
    from camring.presentation.robust import show, write
    from camring.search.scatter.statistic import MeanPlus, SmoothQuantile, Statistic
    from camring.studies.robust import robust_design

    given = request.options
    statistic: Statistic = SmoothQuantile(given["quantile"] or 0.95)
    if given["sigmas"] is not None:
        statistic = MeanPlus(given["sigmas"])
    with work_on(request, out) as (remember, say):
        found = robust_design(
            file,
            statistic,
            statistic,
            samples=given["samples"],
            checked=given["checked"],
            budget=given["budget"],
            seed=file.search.seed if given["seed"] is None else given["seed"],
            say=say,
            remember=remember,
        )
    write(found, out, Decimal(given["decimal"]))
    done(out)
    return show(found, out, as_json=as_json)

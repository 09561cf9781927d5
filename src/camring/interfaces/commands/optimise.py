"""`camring optimise`: from a motor file to a better, checked motor."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer


class Method(StrEnum):
    """How designs are sought; the words of [search] method, without importing pydantic."""

    GRADIENT = "gradient"
    SCBO = "scbo"
    BAYESIAN = "bayesian"


def optimise(
    motor: Annotated[Path, typer.Argument(help="Motor file with a [design_space].")],
    out: Annotated[Path, typer.Option("--out", help="Folder to make; nothing may be there.")],
    budget: Annotated[
        int | None,
        typer.Option(min=1, help="Model evaluations in all; else that of the file, or 300."),
    ] = None,
    seed: Annotated[
        int | None,
        typer.Option(min=0, help="Where all chance comes from; else that of the file, or 0."),
    ] = None,
    method: Annotated[
        Method | None,
        typer.Option(
            help="Down exact slopes, or by a model learned from evaluations alone, in a trust "
            "region or in the whole box; else that of the file, or gradient."
        ),
    ] = None,
    theory: Annotated[
        bool,
        typer.Option(
            "--theory/--no-theory",
            help="Begin also from cams of zero geometric ripple, where the space holds them.",
        ),
    ] = True,
    evaluator: Annotated[
        str | None,
        typer.Option(
            help="Your own program that judges designs, such as 'python my_model.py'; it reads "
            "and writes JSON (docs/guide/expensive-models.md)."
        ),
    ] = None,
    fmu: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Your own FMU that judges designs: a TOML file that maps its variables "
            "(docs/guide/expensive-models.md).",
        ),
    ] = None,
    timeout: Annotated[
        str | None,
        typer.Option(help="When to stop it, such as '5 min'; else that of the file, or 600 s."),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(min=1, help="Processes that evaluate at once; else this one does."),
    ] = None,
    dask: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="A dask.distributed cluster that evaluates, such as tcp://host:8786 "
            "(docs/guide/many-machines.md).",
        ),
    ] = None,
    batch: Annotated[
        int | None,
        typer.Option(min=1, help="Designs to choose at once; else as many as there are workers."),
    ] = None,
    json: Annotated[
        bool, typer.Option("--json", help="One document on stdout, all else on stderr.")
    ] = False,
) -> None:
    """Search for a better cam ring and valve timing, check what was found, and report.

    The folder gets best.toml (a complete motor file), report.html, validation.json
    and study.sqlite, which holds every evaluation. Ctrl-C stops at any time and
    loses nothing; `camring resume FOLDER` goes on.
    """
    from camring.interfaces.executors import chosen_executor
    from camring.interfaces.finished import show
    from camring.interfaces.optimisation import optimise
    from camring.interfaces.progress import SearchProgress

    command: str | list[str] | None = evaluator
    if fmu is not None:
        from camring.interfaces.errors import InputError
        from camring.interfaces.own_fmu import command_for

        if evaluator is not None:
            raise InputError("--fmu", "is given beside --evaluator", "leave one of them away")
        command = command_for(fmu)

    with chosen_executor(workers, dask) as executor:
        finished = optimise(
            motor,
            out,
            budget=budget,
            seed=seed,
            method=method and method.value,
            theory=theory,
            evaluator=command,
            timeout=timeout,
            executor=executor,
            batch=batch,
            watch=SearchProgress,
        )
    raise typer.Exit(show(finished, as_json=json))

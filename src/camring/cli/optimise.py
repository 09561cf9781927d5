"""`camring optimise`: from a motor file to a better, checked motor."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from camring.cli.options import AllowOption, DaskOption, JsonOption, WorkersOption


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
            help="Your own program that evaluates designs, such as 'python my_model.py'; it reads "
            "and writes JSON (docs/guide/expensive-models.md)."
        ),
    ] = None,
    fmu: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Your own FMU that evaluates designs: a TOML file that maps its variables "
            "(docs/guide/expensive-models.md).",
        ),
    ] = None,
    timeout: Annotated[
        str | None,
        typer.Option(help="When to stop it, such as '5 min'; else that of the file, or 600 s."),
    ] = None,
    unit: Annotated[
        list[str] | None,
        typer.Option(
            metavar="RESULT=UNIT",
            help="A result that it gives in another unit than SI, such as max_pressure=bar; again "
            "for each.",
        ),
    ] = None,
    allow_evaluator: AllowOption = False,
    workers: WorkersOption = None,
    dask: DaskOption = None,
    batch: Annotated[
        int | None,
        typer.Option(min=1, help="Designs to choose at once; else as many as there are workers."),
    ] = None,
    json: JsonOption = False,
) -> None:
    """Search for a better cam ring and valve timing, check what was found, and report.

    The folder gets best.toml (a complete motor file), report.html, validation.json
    and study.sqlite, which holds every evaluation. Ctrl-C stops at any time and
    loses nothing; `camring resume FOLDER` goes on.
    """
    from camring.evaluation.consent import ask_at_terminal
    from camring.evaluation.executors import chosen_executor
    from camring.evaluation.progress import SearchProgress
    from camring.presentation.study import show
    from camring.workflows.optimisation import optimise

    command: str | list[str] | None = evaluator
    if fmu is not None:
        from camring.evaluation.user_programs.fmu import command_for
        from camring.files.errors import InputError

        if evaluator is not None:
            raise InputError("--fmu", "is given beside --evaluator", "leave one of them away")
        command = command_for(fmu)

    units: dict[str, str] = {}
    for each in unit or ():
        name, equals, text = each.partition("=")
        if not equals:
            from camring.files.errors import InputError

            raise InputError("--unit", f"is {each!r}", "give such as --unit max_pressure=bar")
        units[name.strip()] = text.strip()

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
            units=units,
            allow_evaluator=allow_evaluator or ask_at_terminal,
            executor=executor,
            batch=batch,
            watch=SearchProgress,
        )
    raise typer.Exit(show(finished, as_json=json))

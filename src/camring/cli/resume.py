"""`camring resume`: go on with a study that was stopped."""

from pathlib import Path
from typing import Annotated

import typer

from camring.cli.options import AllowOption, DaskOption, JsonOption, WorkersOption


def resume(
    folder: Annotated[Path, typer.Argument(help="Folder of a study, or of what was stopped.")],
    budget: Annotated[
        int | None,
        typer.Option(min=1, help="Model evaluations in all; else that which the study began with."),
    ] = None,
    workers: WorkersOption = None,
    dask: DaskOption = None,
    allow_evaluator: AllowOption = False,
    json: JsonOption = False,
) -> None:
    """Go on with a study as if it had never stopped.

    The designs that follow are the same, bit for bit, as those of a study that
    was not interrupted, whatever evaluates them. A study that has ended is checked and
    reported again. A folder of `pareto`, `robust` or `tolerance` that was stopped is filled.
    """
    from camring.cli.unfinished import go_on
    from camring.evaluation.unfinished import out_of, request_of
    from camring.files.errors import InputError

    request = request_of(out_of(folder))
    if request is not None:
        if budget is not None or workers is not None or dask is not None:
            raise InputError(
                "--budget, --workers and --dask",
                f"are for a study, and {out_of(folder)} is of `camring {request.command}`",
                "leave them out",
            )
        raise typer.Exit(go_on(request, out_of(folder), as_json=json))

    from camring.evaluation.consent import ask_at_terminal
    from camring.evaluation.executors import chosen_executor
    from camring.evaluation.progress import SearchProgress
    from camring.presentation.study import show
    from camring.workflows.optimisation import resume

    with chosen_executor(workers, dask) as executor:
        finished = resume(
            folder,
            budget=budget,
            executor=executor,
            allow_evaluator=allow_evaluator or ask_at_terminal,
            watch=SearchProgress,
        )
    raise typer.Exit(show(finished, as_json=json))

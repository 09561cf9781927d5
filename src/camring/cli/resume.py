"""`camring resume`: go on with a study that was stopped."""

from pathlib import Path
from typing import Annotated

import typer

from camring.cli.options import AllowOption, DaskOption, JsonOption, WorkersOption


def resume(
    folder: Annotated[Path, typer.Argument(help="Folder of a study.")],
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
    reported again.
    """
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

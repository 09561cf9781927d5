"""`camring resume`: go on with a study that was stopped."""

from pathlib import Path
from typing import Annotated

import typer


def resume(
    folder: Annotated[Path, typer.Argument(help="Folder of a study.")],
    budget: Annotated[
        int | None,
        typer.Option(min=1, help="Model evaluations in all; else that which the study began with."),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(min=1, help="Processes that evaluate at once; else this one does."),
    ] = None,
    dask: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="A dask.distributed cluster that evaluates."),
    ] = None,
    json: Annotated[
        bool, typer.Option("--json", help="One document on stdout, all else on stderr.")
    ] = False,
) -> None:
    """Go on with a study as if it had never stopped.

    The designs that follow are the same, bit for bit, as those of a study that
    was not interrupted, whatever evaluates them. A study that has ended is checked and
    reported again.
    """
    from camring.interfaces.executors import chosen_executor
    from camring.interfaces.finished import show
    from camring.interfaces.optimisation import resume
    from camring.interfaces.progress import SearchProgress

    with chosen_executor(workers, dask) as executor:
        finished = resume(folder, budget=budget, executor=executor, watch=SearchProgress)
    raise typer.Exit(show(finished, as_json=json))

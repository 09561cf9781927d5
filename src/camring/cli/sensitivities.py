"""`camring sensitivities`: which numbers matter, and what each limit costs."""

from pathlib import Path
from typing import Annotated

import typer

from camring.cli.options import JsonOption


def sensitivities(
    motor: Annotated[
        Path,
        typer.Argument(help="Motor file with a [design_space], or a study folder for its best."),
    ],
    json: JsonOption = False,
) -> None:
    """Show how a design's results change with each number that may, and which limits bind.

    Slopes are exact. What relaxing a binding limit by 1 % would buy shows in its
    multiplier, which means something at an optimum: give it the folder of a study.
    """
    from camring.analyses.sensitivities import sensitivities
    from camring.presentation.sensitivities import document, show

    found = sensitivities(motor)
    if json:
        typer.echo(document(found))
    else:
        show(found)

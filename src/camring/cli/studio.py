"""`camring studio`: a page in the browser on which a motor is designed by hand."""

import os
import sys
from pathlib import Path
from typing import Annotated

import typer


def studio(
    place: Annotated[
        Path,
        typer.Argument(
            metavar="[MOTOR | FOLDER]", help="Motor file, or folder of motor files and studies."
        ),
    ] = Path(),
    port: Annotated[
        int | None,
        typer.Option(min=1, max=65535, help="Of the address; else one that is free."),
    ] = None,
    browser: Annotated[
        bool, typer.Option("--browser/--no-browser", help="Open the browser at the address.")
    ] = True,
) -> None:
    """Design a motor by hand in the browser: every picture follows the movement.

    Serves this machine alone, at an address with a token. Nothing is written but what
    you save, and studies that you begin. Ctrl-C ends it and loses nothing.
    """
    from camring.studio.serve import serve

    serve(place, port, browser, typer.echo)
    # A thread may be deep in a compilation that cannot be stopped.
    sys.stdout.flush()
    os._exit(0)

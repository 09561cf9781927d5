"""`camring report`: the report of a study, made anew from what the study holds."""

from pathlib import Path
from typing import Annotated

import typer

from camring.files.visible import say


def report(
    folder: Annotated[Path, typer.Argument(help="Folder of a study, finished or not.")],
) -> None:
    """Write FOLDER/report.html anew: one file that any browser opens, without a network.

    The given and the best motor are simulated again, so the report always fits
    the program that wrote it. Nothing else in the folder changes.
    """
    from camring.programs.compilation_cache import keep_compiled_programs

    keep_compiled_programs()

    from camring.report import write_report

    say(write_report(folder))

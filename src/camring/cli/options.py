"""Options that several commands share."""

from enum import StrEnum
from typing import Annotated

import typer

AllowOption = Annotated[
    bool,
    typer.Option(
        "--allow-evaluator", help="Run what the file or the study names as evaluator, unasked."
    ),
]

JsonOption = Annotated[
    bool, typer.Option("--json", help="One document on stdout, all else on stderr.")
]

SpeedOption = Annotated[
    str | None,
    typer.Option(
        help='Shaft speeds, a range with its unit, "10 rpm..300 rpm"; else what the file covers.'
    ),
]

PressureOption = Annotated[
    str | None,
    typer.Option(help='Supply pressures, absolute, "50 bar..350 bar"; else what the file covers.'),
]

PointOption = Annotated[int, typer.Option(help="Operating point of the file, counted from 1.")]


class Picture(StrEnum):
    """Kinds of picture."""

    PNG = "png"
    SVG = "svg"
    PDF = "pdf"
    NONE = "none"


PictureOption = Annotated[
    Picture, typer.Option("--format", help="Kind of the pictures; none for the table alone.")
]

WorkersOption = Annotated[
    int | None, typer.Option(min=1, help="Processes that evaluate at once; else this one does.")
]

DaskOption = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS",
        help="A dask.distributed cluster that evaluates, such as tcp://host:8786 "
        "(docs/guide/many-machines.md).",
    ),
]

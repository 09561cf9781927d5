"""`camring compare`: motors side by side."""

from pathlib import Path
from typing import Annotated

import typer

FAILED = 1


def compare(
    motors: Annotated[
        list[Path],
        typer.Argument(metavar="MOTOR", help="Motor files, or study folders for their best."),
    ],
    own_points: Annotated[
        bool,
        typer.Option(
            "--own-points",
            help="Each motor at the operating points of its own file, "
            "not all at those of the first.",
        ),
    ] = False,
    picture: Annotated[
        Path | None,
        typer.Option("--picture", help="Draw their waveforms over each other: PNG, SVG or PDF."),
    ] = None,
    point: Annotated[int, typer.Option(help="Operating point of the picture, counted from 1.")] = 1,
    json: Annotated[
        bool, typer.Option("--json", help="One document on stdout, all else on stderr.")
    ] = False,
) -> None:
    """Put motors side by side: their results, the better one marked, and what differs in them.

    All are simulated at the operating points of the first, so that like is compared
    with like.
    """
    from camring.interfaces.compilation_cache import keep_compiled_programs

    keep_compiled_programs()

    from camring.interfaces.comparison import compare as compared
    from camring.interfaces.comparison_output import document, draw, print_comparison, refuse

    if picture is not None:
        refuse(picture)
    found = compared(motors, own_points=own_points)
    if picture is not None:
        typer.echo(f"Wrote {draw(found, picture, point)}.", err=True)
    if json:
        typer.echo(document(found))
    else:
        print_comparison(found)
    if any(each.simulated.outcome.failure for each in found.motors):
        raise typer.Exit(FAILED)

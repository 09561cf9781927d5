"""`camring compare`: motors side by side."""

from pathlib import Path
from typing import Annotated

import typer

from camring.cli.options import JsonOption
from camring.files.visible import say

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
    measured: Annotated[
        Path | None,
        typer.Option(
            "--measured",
            help="A measured ring (table, DXF or curve file) against that of one motor, in um.",
        ),
    ] = None,
    curve: Annotated[
        str | None,
        typer.Option(
            metavar="pitch|surface",
            help="Which curve was measured; else what the file says, or the ring's surface.",
        ),
    ] = None,
    json: JsonOption = False,
) -> None:
    """Put motors side by side: their results, the better one marked, and what differs in them.

    All are simulated at the operating points of the first, so that like is compared
    with like. With --measured, one motor's drawn ring against a measured one.
    """
    from camring.programs.compilation_cache import keep_compiled_programs

    if measured is not None or curve is not None:
        _measured(motors, measured, curve, json)
        return

    keep_compiled_programs()

    from camring.analyses.comparison import compare as compared
    from camring.presentation.comparison import document, draw, print_comparison, refuse

    if picture is not None:
        refuse(picture)
    found = compared(motors, own_points=own_points)
    if picture is not None:
        say(f"Wrote {draw(found, picture, point)}.", err=True)
    if json:
        typer.echo(document(found))
    else:
        print_comparison(found)
    if any(each.simulated.outcome.failure for each in found.motors):
        raise typer.Exit(FAILED)


def _measured(motors: list[Path], measured: Path | None, curve: str | None, json: bool) -> None:
    from camring.files.errors import InputError, quote

    if measured is None:
        raise InputError("--curve", "has no effect without --measured", "leave it out")
    if len(motors) != 1:
        raise InputError(
            "--measured", f"is compared with one ring, not {len(motors)}", "name one motor"
        )
    if curve not in (None, "pitch", "surface"):
        raise InputError("--curve", f"is {quote(curve)}", "give pitch or surface")

    from camring.exchange.drawings.source import motor_of
    from camring.presentation.ring_deviation import document, measured_against, print_deviation

    file = motor_of(motors[0])
    found = measured_against(file, measured, curve)
    if json:
        typer.echo(document(found, file))
    else:
        print_deviation(found, file)

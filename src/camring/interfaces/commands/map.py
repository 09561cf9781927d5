"""`camring map`: results over speed and supply pressure."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

USUAL = ("efficiency", "torque_ripple", "max_pressure")


class Picture(StrEnum):
    """Kinds of picture."""

    PNG = "png"
    SVG = "svg"
    PDF = "pdf"
    NONE = "none"


def map(
    motor: Annotated[Path, typer.Argument(help="Motor file.")],
    out: Annotated[
        Path, typer.Option("--out", help="Folder for map.csv and a picture of each result.")
    ],
    speed: Annotated[
        str | None,
        typer.Option(help='Range with its unit, "10 rpm..300 rpm"; else from the file\'s points.'),
    ] = None,
    pressure: Annotated[
        str | None,
        typer.Option(help='Supply pressure, absolute: "50 bar..350 bar"; else likewise.'),
    ] = None,
    points: Annotated[
        str | None, typer.Option(help="Values on each axis, speeds first; else 40x40.")
    ] = None,
    results: Annotated[
        str | None,
        typer.Option(help=f"Results to draw, separated by commas; else {', '.join(USUAL)}."),
    ] = None,
    point: Annotated[
        int, typer.Option(help="Operating point, from 1, whose return and case pressure are kept.")
    ] = 1,
    picture: Annotated[
        Picture, typer.Option("--format", help="Kind of the pictures; none for the table alone.")
    ] = Picture.PNG,
    force: Annotated[
        bool, typer.Option("--force", help="Replace the files of an earlier map.")
    ] = False,
    json: Annotated[
        bool, typer.Option("--json", help="One document on stdout, all else on stderr.")
    ] = False,
) -> None:
    """Draw results over shaft speed and supply pressure: an efficiency map and others.

    Each picture shows where the roller lifts off, where the oil cavitates, and the
    upper limits of the file's [constraints]. map.csv holds every result of every
    point, with a row of units.
    """
    from camring.interfaces.compilation_cache import keep_compiled_programs

    keep_compiled_programs()

    from camring.interfaces.config import read_motor_file
    from camring.interfaces.grid_output import Folder, chosen_results, document, print_grid
    from camring.interfaces.operating_map import operating_map

    names = chosen_results(results, USUAL)
    folder = Folder(out, "map.csv", names, picture.value, force)
    found = operating_map(
        read_motor_file(motor),
        speed=speed,
        pressure=pressure,
        points=points,
        operating_point=point,
    )
    written = folder.write(found, names)
    if json:
        typer.echo(document(found, motor, point))
    else:
        print_grid(found, names)
    typer.echo(f"Wrote {', '.join(each.name for each in written)} in {out}.", err=json)

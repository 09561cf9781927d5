"""`camring sweep`: results while one or two numbers of the motor file vary."""

from pathlib import Path
from typing import Annotated

import typer

from camring.interfaces.commands.map import Picture

USUAL = ("torque_ripple", "efficiency", "max_pressure", "min_contact_force")


def sweep(
    motor: Annotated[Path, typer.Argument(help="Motor file.")],
    ranges: Annotated[
        list[str],
        typer.Argument(
            metavar="KEY=RANGE",
            help='One or two keys of the motor file, motor.valve_plate.shift="-2 deg..2 deg"; '
            'a list of values will do, fluid.bulk_modulus="1 GPa, 1.4 GPa, 1.8 GPa".',
        ),
    ],
    points: Annotated[
        str | None, typer.Option(help="Values of each range; else 41 for one key, 21x21 for two.")
    ] = None,
    results: Annotated[
        str | None,
        typer.Option(help=f"Results to show, separated by commas; else {', '.join(USUAL)}."),
    ] = None,
    point: Annotated[int, typer.Option(help="Operating point of the file, counted from 1.")] = 1,
    out: Annotated[
        Path | None, typer.Option("--out", help="Folder for sweep.csv and pictures.")
    ] = None,
    picture: Annotated[
        Picture, typer.Option("--format", help="Kind of the pictures; none for the table alone.")
    ] = Picture.PNG,
    force: Annotated[
        bool, typer.Option("--force", help="Replace the files of an earlier sweep.")
    ] = False,
    json: Annotated[
        bool, typer.Option("--json", help="One document on stdout, all else on stderr.")
    ] = False,
) -> None:
    """Vary one or two numbers of the motor and show every result follow.

    Keys are those of the motor file: motor.bore, motor.roller.friction, fluid.temperature,
    operating_points.speed, or motor.cam.control_radii[3] for one of a list.
    """
    from camring.interfaces.compilation_cache import keep_compiled_programs

    keep_compiled_programs()

    from camring.interfaces.config import read_motor_file
    from camring.interfaces.grid_output import Folder, chosen_results, document, print_grid
    from camring.interfaces.sweep import assignments
    from camring.interfaces.sweep import sweep as swept

    names, asked = chosen_results(results, USUAL), assignments(ranges)
    folder = None
    if out is not None:
        pictures = ("sweep",) if len(asked) == 1 else names
        folder = Folder(out, "sweep.csv", pictures, picture.value, force)
    found = swept(read_motor_file(motor), asked, points=points, operating_point=point)
    written = folder.write(found, names) if folder is not None else []
    if json:
        typer.echo(document(found, motor, point))
    else:
        print_grid(found, names)
    if written:
        typer.echo(f"Wrote {', '.join(each.name for each in written)} in {out}.", err=json)

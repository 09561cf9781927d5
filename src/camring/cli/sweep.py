"""`camring sweep`: results while one or two numbers of the motor file vary."""

from pathlib import Path
from typing import Annotated

import typer

from camring.cli.options import JsonOption, Picture, PictureOption, PointOption
from camring.files.csv_table import Decimal, DecimalOption
from camring.files.visible import say

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
    point: PointOption = 1,
    out: Annotated[
        Path | None, typer.Option("--out", help="Folder for sweep.csv and pictures.")
    ] = None,
    picture: PictureOption = Picture.PNG,
    force: Annotated[
        bool, typer.Option("--force", help="Replace the files of an earlier sweep.")
    ] = False,
    decimal: DecimalOption = Decimal.POINT,
    json: JsonOption = False,
) -> None:
    """Vary one or two numbers of the motor and show every result follow.

    Keys are those of the motor file: motor.bore, motor.roller.friction, fluid.temperature,
    operating_points.speed, or motor.cam.control_radii[3] for one of a list.
    """
    from camring.programs.compilation_cache import keep_compiled_programs

    keep_compiled_programs()

    from camring.analyses.sweep import assignments
    from camring.analyses.sweep import sweep as swept
    from camring.evaluation.progress import Spoken
    from camring.files.motor import read_motor_file
    from camring.presentation.grid import Folder, chosen_results, document, print_grid

    names, asked = chosen_results(results, USUAL), assignments(ranges)
    folder = None
    if out is not None:
        pictures = ("sweep",) if len(asked) == 1 else names
        folder = Folder(out, "sweep.csv", pictures, picture.value, force, decimal)
    with Spoken("Simulating the sweep."):
        found = swept(read_motor_file(motor), asked, points=points, operating_point=point)
    written = folder.write(found, names) if folder is not None else []
    if json:
        typer.echo(document(found, motor, point))
    else:
        print_grid(found, names)
    if written:
        say(f"Wrote {', '.join(each.name for each in written)} in {out}.", err=json)

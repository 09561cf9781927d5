"""`camring map`: results over speed and supply pressure, or over temperature."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from camring.cli.options import (
    JsonOption,
    Picture,
    PictureOption,
    PointOption,
    PressureOption,
    SpeedOption,
)
from camring.files.csv_table import Decimal, DecimalOption
from camring.files.visible import say

if TYPE_CHECKING:
    import numpy as np

    from camring.analyses.grid import Grid
    from camring.files.motor import MotorFile

USUAL = ("efficiency", "torque_ripple", "max_pressure")
IN_QUADRANTS = ("port_efficiency", *USUAL[1:])


def map(
    motor: Annotated[Path, typer.Argument(help="Motor file.")],
    out: Annotated[
        Path, typer.Option("--out", help="Folder for map.csv and a picture of each result.")
    ],
    speed: SpeedOption = None,
    pressure: PressureOption = None,
    temperature: Annotated[
        str | None,
        typer.Option(
            help='Of the oil that comes in, "20 degC..80 degC": an axis in the place of the '
            "pressures, or of the speeds where --pressure is given."
        ),
    ] = None,
    points: Annotated[
        str | None, typer.Option(help="Values on each axis, speeds first; else 40x40.")
    ] = None,
    results: Annotated[
        str | None,
        typer.Option(
            help=f"Results to draw, separated by commas; else {', '.join(USUAL)}, and with "
            "--quadrants port_efficiency in place of the first."
        ),
    ] = None,
    point: PointOption = 1,
    picture: PictureOption = Picture.PNG,
    charge: Annotated[
        bool,
        typer.Option(
            "--charge",
            help="Seek the charge pressure too: the least return pressure at each speed "
            "(charge.csv and a picture).",
        ),
    ] = False,
    quadrants: Annotated[
        bool,
        typer.Option(
            "--quadrants",
            help="Both directions, driving and braking: speed and pressure difference over both "
            "signs; --speed and --pressure then give the first quadrant.",
        ),
    ] = False,
    beside: Annotated[
        Path | None,
        typer.Option(
            help="Another motor file, as that of the motor as given: each picture shows it first, "
            "on the same axes and scale (and map_beside.csv).",
        ),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Replace the files of an earlier map.")
    ] = False,
    decimal: DecimalOption = Decimal.POINT,
    json: JsonOption = False,
) -> None:
    """Draw results over shaft speed and supply pressure: an efficiency map and others.

    Each picture shows where the roller lifts off, where the oil cavitates, and the
    upper limits of the file's [constraints]; return and case pressure are those of
    --point. Without --speed and --pressure it covers
    the file's [envelope], or without one what lies round the operating points; where
    a range goes beyond the envelope, that is framed. map.csv holds every result of
    every point, units in its header. With --temperature one axis is that of a named oil,
    and what has no axis is the operating point's.
    """
    from camring.programs.compilation_cache import keep_compiled_programs

    keep_compiled_programs()

    from camring.analyses.charge import charge_curve
    from camring.analyses.operating_map import maps_beside, operating_map
    from camring.analyses.quadrants import quadrants as over_both_signs
    from camring.evaluation.progress import Spoken
    from camring.files.errors import InputError
    from camring.files.motor import read_motor_file
    from camring.presentation.charge import ChargeFiles, charge_document, print_charge
    from camring.presentation.console import console
    from camring.presentation.grid import Folder, chosen_results, document, print_grid

    if charge and temperature is not None and pressure is not None:
        raise InputError(
            "--charge",
            "seeks at each speed, and with --pressure and --temperature no axis is one of speeds",
            "leave --pressure out, or --charge",
        )
    if quadrants and temperature is not None:
        raise InputError(
            "--quadrants",
            "is a map over speed and pressure, which leaves no axis for --temperature",
            "leave one of the two out",
        )
    if beside is not None and (quadrants or charge):
        raise InputError(
            "--beside",
            f"does not go with --{'quadrants' if quadrants else 'charge'}",
            "leave one of the two out",
        )
    names = chosen_results(results, IN_QUADRANTS if quadrants else USUAL)
    folder = Folder(out, "map.csv", names, picture.value, force, decimal)
    files = ChargeFiles(out, picture.value, force, decimal) if charge else None
    file = read_motor_file(motor)
    other = None if beside is None else _read_beside(beside)
    asked = {"speed": speed, "pressure": pressure, "temperature": temperature, "points": points}
    compared = None
    with Spoken("Simulating the map."):
        if quadrants:
            found = over_both_signs(
                file, speed=speed, pressure=pressure, points=points, operating_point=point
            )
        elif other is not None:
            found, compared = maps_beside(file, other, operating_point=point, **asked)
            found, compared = _headed(found, file), _headed(compared, other)
        else:
            found = operating_map(file, operating_point=point, **asked)
    curve = None
    if files is not None:
        with Spoken("Seeking the charge pressure."):
            curve = charge_curve(file, _forwards(found.axes[0].si("rad/s")), point)
    written = folder.write(found, names, compared)
    if files is not None and curve is not None:
        written += files.write(curve)
    if json:
        charged = None if curve is None else charge_document(curve)
        pair = None if compared is None or beside is None else (beside, compared)
        typer.echo(document(found, motor, point, charged, pair))
    else:
        if compared is not None:
            print_grid(compared, names, headed=True)
        print_grid(found, names, headed=compared is not None)
        if curve is not None:
            print_charge(curve, console())
    say(f"Wrote {', '.join(each.name for each in written)} in {out}.", err=json)


def _read_beside(path: Path) -> "MotorFile":
    """The second of two motor files, which refusals name."""
    from camring.files.errors import InputError
    from camring.files.motor import read_motor_file
    from camring.files.motor.document import printable

    try:
        return read_motor_file(path)
    except InputError as error:
        raise error.of(printable(path)) from None


def _headed(grid: "Grid", file: "MotorFile") -> "Grid":
    """Named by its file: a best design has the name of the motor it was found from."""
    from camring.files.motor.document import printable

    return replace(grid, title=f"{printable(file.path)}\n{grid.title.partition(chr(10))[2]}")


def _forwards(speeds: "np.ndarray") -> "np.ndarray":
    """Those of one direction; quadrants have both."""
    return speeds[speeds > 0]

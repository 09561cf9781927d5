"""`camring export`: files for CAD, grinding machine, workshop and system simulation."""

from pathlib import Path
from typing import Annotated

import typer

from camring.cli.options import JsonOption, PressureOption, SpeedOption
from camring.files.csv_table import Decimal, DecimalOption
from camring.files.errors import InputError
from camring.files.visible import say


def export(
    motor: Annotated[
        Path, typer.Argument(help="Motor file, or folder of a study: its best motor is taken.")
    ],
    out: Annotated[
        Path | None, typer.Option("--out", help="Folder for the files; made if need be.")
    ] = None,
    only: Annotated[
        str | None,
        typer.Option(
            help="Some of ring,points,curve,plate,sheet,step,fmu, or all; else all but curve, "
            "step, which needs the extra camring[step], and fmu.",
        ),
    ] = None,
    chord: Annotated[
        str | None,
        typer.Option(help='How far chords of the point table may stray; else "1 um".'),
    ] = None,
    dxf: Annotated[
        str | None,
        typer.Option(
            metavar="spline|polyline|arcs",
            help="Curves of the DXF files: spline (the default), or, for machines that read none, "
            "straight lines or arcs in release 12.",
        ),
    ] = None,
    dxf_tolerance: Annotated[
        str | None,
        typer.Option(help='How far those may stray from the exact curves; else "1 um".'),
    ] = None,
    port_circle: Annotated[
        str | None,
        typer.Option(
            help="Radius on which the ports lie; else half the smallest pitch radius, for round "
            "ports that at which they open as modelled."
        ),
    ] = None,
    outer_diameter: Annotated[
        str | None,
        typer.Option(
            help="Of the ring's body; else the file's motor.cam.outer_diameter, else with 0.6 "
            "bores of wall outside the deepest place."
        ),
    ] = None,
    outer_radius: Annotated[str | None, typer.Option("--outer-radius", hidden=True)] = None,
    ring_width: Annotated[
        str | None, typer.Option(help="Of the ring's body; else the roller's length.")
    ] = None,
    fmu: Annotated[
        bool, typer.Option("--fmu", help="The same as --only fmu: a model for system simulation.")
    ] = False,
    speed: SpeedOption = None,
    pressure: PressureOption = None,
    low_pressure: Annotated[
        str | None,
        typer.Option(help='The FMU\'s pressures of the lower port, absolute: "5 bar..20 bar".'),
    ] = None,
    points: Annotated[
        str | None,
        typer.Option(help="Speeds and pressures of the FMU's table, a sign of each; else 13x7."),
    ] = None,
    optuna: Annotated[
        str | None,
        typer.Option(
            metavar="URL",
            help="Every evaluation of a study as a trial in Optuna's storage, such as "
            "sqlite:///study.db (docs/guide/optuna.md); instead of files.",
        ),
    ] = None,
    name: Annotated[
        str | None, typer.Option(help="Of the study in Optuna's storage; else the folder's.")
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Replace files, or Optuna's study, of the same names.")
    ] = False,
    decimal: DecimalOption = Decimal.POINT,
    json: JsonOption = False,
) -> None:
    """Write what a designer takes to CAD, grinding machine and workshop.

    ring.dxf and ring.svg hold the path of the roller centre and the working
    surface; ring_points.csv has points of both with normals and curvature, the curve files
    (--only curve) for SolidWorks and others x y z;
    valve_plate.dxf and .csv the ports with their timing; sheet.svg is an A3
    drawing; ring.step a solid. An undercut ring is refused. NAME.fmu (--fmu) is
    the motor for Simulink, Amesim and others, NAME.mo for Modelica.
    """
    if optuna is not None:
        if out is not None:
            raise InputError("--optuna", "writes no files", "leave --out away, or run export twice")
        _to_optuna(motor, optuna, name, force, json)
        return
    if out is None:
        raise InputError("--out", "is missing", "name a folder for the files")
    if outer_radius is not None:
        from camring.cli.renamed_options import doubled

        raise doubled("--outer-radius", outer_radius, "--outer-diameter")
    if name is not None:
        raise InputError("--name", "has no effect without --optuna", "leave it away")

    from camring.programs.compilation_cache import keep_compiled_programs

    keep_compiled_programs()

    from camring.exchange.drawings import DRAWN, Wishes, chosen_products
    from camring.exchange.drawings import export as write_all
    from camring.exchange.drawings.source import motor_of
    from camring.exchange.drawings.summary import document, print_written
    from camring.exchange.fmu.axes import Ranges

    if fmu:
        only = f"{only},fmu" if only else "fmu"
    names = chosen_products(only)
    table = Ranges(speed, pressure, low_pressure, points)
    table.require_use("fmu" in names)
    if dxf is not None and not set(DRAWN) & set(names):
        raise InputError("--dxf", "has no effect on these files", "add ring or plate to --only")
    wishes = Wishes.read(
        chord, port_circle, outer_diameter, ring_width, table, dxf, dxf_tolerance, decimal
    )
    file = motor_of(motor)
    written = write_all(file, out, only=names, wishes=wishes, replace=force)
    if json:
        typer.echo(document(file, written))
    else:
        print_written(file, written)


def _to_optuna(folder: Path, storage: str, name: str | None, force: bool, json: bool) -> None:
    from dataclasses import asdict
    from json import dumps

    from camring.exchange.optuna import export_to_optuna

    written = export_to_optuna(folder, storage, name=name, replace=force)
    if json:
        typer.echo(dumps({"storage": storage, **asdict(written)}))
        return
    best = "none keeps every limit" if written.best is None else f"the best is {written.best}"
    say(f"{written.trials} trials are in {storage} as the study {written.name}; {best}.")
    say(f"optuna-dashboard {storage} shows them.")

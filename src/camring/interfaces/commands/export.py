"""`camring export`: files for CAD, grinding machine, workshop and system simulation."""

from pathlib import Path
from typing import Annotated

import typer

from camring.interfaces.errors import InputError


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
            help="Some of ring,points,plate,sheet,step,fmu, or all; else all but step, which needs "
            "the extra camring[step], and fmu.",
        ),
    ] = None,
    chord: Annotated[
        str | None,
        typer.Option(help='How far chords of the point table may stray; else "1 um".'),
    ] = None,
    port_circle: Annotated[
        str | None,
        typer.Option(
            help="Radius on which the ports lie; else half the smallest pitch radius, for round "
            "ports that at which they open as modelled."
        ),
    ] = None,
    outer_radius: Annotated[
        str | None,
        typer.Option(help="Of the ring's body; else two roller radii beyond its inside."),
    ] = None,
    ring_width: Annotated[
        str | None, typer.Option(help="Of the ring's body; else the roller's length.")
    ] = None,
    fmu: Annotated[
        bool, typer.Option("--fmu", help="The same as --only fmu: a model for system simulation.")
    ] = False,
    speed: Annotated[
        str | None,
        typer.Option(help="Of the FMU's table, \"10 rpm..300 rpm\"; else from the file's points."),
    ] = None,
    pressure: Annotated[
        str | None,
        typer.Option(help='Its supply pressures, absolute: "50 bar..350 bar"; else likewise.'),
    ] = None,
    low_pressure: Annotated[
        str | None,
        typer.Option(help='Its pressures of the lower port, absolute: "5 bar..20 bar".'),
    ] = None,
    points: Annotated[
        str | None, typer.Option(help="Its speeds and pressures, a sign of each; else 13x7.")
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
    json: Annotated[
        bool, typer.Option("--json", help="One document on stdout, all else on stderr.")
    ] = False,
) -> None:
    """Write what a designer takes to CAD, grinding machine and workshop.

    ring.dxf and ring.svg hold the path of the roller centre and the working
    surface; ring_points.csv has points of both with normals and curvature;
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
    if name is not None:
        raise InputError("--name", "has no effect without --optuna", "leave it away")

    from camring.interfaces.compilation_cache import keep_compiled_programs

    keep_compiled_programs()

    from camring.interfaces.export import Wishes, chosen_products
    from camring.interfaces.export import export as write_all
    from camring.interfaces.export.source import motor_of
    from camring.interfaces.export.told import document, print_written
    from camring.interfaces.fmu.axes import Ranges

    if fmu:
        only = f"{only},fmu" if only else "fmu"
    names = chosen_products(only)
    table = Ranges(speed, pressure, low_pressure, points)
    table.require_use("fmu" in names)
    wishes = Wishes.read(chord, port_circle, outer_radius, ring_width, table)
    file = motor_of(motor)
    written = write_all(file, out, only=names, wishes=wishes, replace=force)
    if json:
        typer.echo(document(file, written))
    else:
        print_written(file, written)


def _to_optuna(folder: Path, storage: str, name: str | None, force: bool, json: bool) -> None:
    from dataclasses import asdict
    from json import dumps

    import camring

    written = camring.export_to_optuna(folder, storage, name=name, replace=force)
    if json:
        typer.echo(dumps({"storage": storage, **asdict(written)}))
        return
    best = "none keeps every limit" if written.best is None else f"the best is {written.best}"
    typer.echo(
        f"{written.trials} trials are in {storage} as the study {written.name}; {best}.\n"
        f"optuna-dashboard {storage} shows them."
    )

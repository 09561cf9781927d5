"""`camring simulate`: every result of a motor, with its numerical error."""

from pathlib import Path
from typing import Annotated

import typer

from camring.cli.options import JsonOption
from camring.files.csv_table import Decimal, DecimalOption
from camring.files.visible import say

FAILED = 1
FINEST, COARSEST = 3e-6, 0.01


def simulate(
    motor: Annotated[Path, typer.Argument(help="Motor file.")],
    decimal: DecimalOption = Decimal.POINT,
    json: JsonOption = False,
    waveforms: Annotated[
        Path | None,
        typer.Option(
            "--waveforms",
            help="Write one revolution and all results to this file: .nc, .csv, .xlsx or .mat.",
        ),
    ] = None,
    start: Annotated[
        Path | None,
        typer.Option(
            "--start",
            help="Draw the starting torque over the angle, both ways: PNG, SVG or PDF.",
        ),
    ] = None,
    point: Annotated[int, typer.Option(help="Operating point of --start, from 1.")] = 1,
    accuracy: Annotated[
        float,
        typer.Option(
            "--accuracy",
            help="Wanted of each result, relative; the mesh is made finer until it is reached.",
        ),
    ] = 1e-5,
) -> None:
    """Simulate a motor at its operating points and print every result.

    Each operating point is one column; results below carry their numerical
    error, and below them stands the torque with which the shaft starts under
    pressure. Warnings tell of an undercut, cavitation, a roller that lifts off or
    an accuracy that was not reached.
    """
    from camring.files.errors import InputError
    from camring.programs.compilation_cache import keep_compiled_programs

    if not FINEST <= accuracy <= COARSEST:
        raise InputError(
            "--accuracy",
            f"is {accuracy:g} but must lie between {FINEST:g} and {COARSEST:g}",
            "ask for the largest error you allow in any result, such as 1e-5",
        )
    keep_compiled_programs()

    from camring.analyses.simulation import simulated
    from camring.evaluation.progress import SIMULATING, Spoken
    from camring.files.motor import read_motor_file
    from camring.presentation.simulation import document, print_table

    if waveforms is not None:
        from camring.exchange.waveforms.file import places_of

        places_of(waveforms)
    if start is not None:
        from camring.presentation.comparison import refuse

        refuse(start)
    file = read_motor_file(motor)
    with Spoken(SIMULATING, terminals=True):
        found = simulated(file, accuracy=accuracy)
    if waveforms is not None:
        from camring.exchange.waveforms.file import write_simulation

        results = found.outcome.results
        for written in write_simulation(
            waveforms, file.system, found.cycles, results, source=file.text, decimal=decimal
        ):
            say(f"Wrote {written}.", err=True)
    if start is not None:
        from camring.presentation.simulation import draw_start

        say(f"Wrote {draw_start(found, start, point)}.", err=True)
    if json:
        typer.echo(document(found))
    else:
        print_table(found)
    if found.outcome.failure:
        raise typer.Exit(FAILED)

"""`camring simulate`: every result of a motor, with its numerical error."""

from pathlib import Path
from typing import Annotated

import typer

FAILED = 1
FINEST, COARSEST = 3e-6, 0.01


def simulate(
    motor: Annotated[Path, typer.Argument(help="Motor file.")],
    json: Annotated[
        bool, typer.Option("--json", help="One document on stdout, all else on stderr.")
    ] = False,
    waveforms: Annotated[
        Path | None,
        typer.Option(
            "--waveforms",
            help="Write one revolution and all results to this file: .nc, .csv, .xlsx or .mat.",
        ),
    ] = None,
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
    error. Warnings tell of an undercut, cavitation, a roller that lifts off or an
    accuracy that was not reached.
    """
    from camring.interfaces.compilation_cache import keep_compiled_programs
    from camring.interfaces.errors import InputError

    if not FINEST <= accuracy <= COARSEST:
        raise InputError(
            "--accuracy",
            f"is {accuracy:g} but must lie between {FINEST:g} and {COARSEST:g}",
            "ask for the largest error you allow in any result, such as 1e-5",
        )
    keep_compiled_programs()

    from camring.interfaces.config import read_motor_file
    from camring.interfaces.simulated import simulated
    from camring.interfaces.simulation_output import document, print_table

    if waveforms is not None:
        from camring.interfaces.waveform_file import places_of

        places_of(waveforms)
    file = read_motor_file(motor)
    found = simulated(file, accuracy=accuracy)
    if waveforms is not None:
        from camring.interfaces.waveform_file import write_simulation

        results = found.outcome.results
        for written in write_simulation(
            waveforms, file.system, found.cycles, results, source=file.text
        ):
            typer.echo(f"Wrote {written}.", err=True)
    if json:
        typer.echo(document(found))
    else:
        print_table(found)
    if found.outcome.failure:
        raise typer.Exit(FAILED)

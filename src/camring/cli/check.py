"""`camring check`: the facts of a motor, and which constraints hold."""

from pathlib import Path
from typing import Annotated

import typer

from camring.cli.options import JsonOption

FAILED, INFEASIBLE = 1, 3


def check(
    motor: Annotated[Path, typer.Argument(help="Motor file.")],
    json: JsonOption = False,
) -> None:
    """Print the facts of a motor: displacement, orders, port timing, limits, warnings.

    A file with an [envelope] is held to its limits everywhere in it; of one without it
    says where between a tenth and all of its pressure the motor runs. Exit code 3 says
    that a constraint does not hold, at the operating points or in the envelope.
    """
    from camring.programs.compilation_cache import keep_compiled_programs

    keep_compiled_programs()

    from camring.analyses.envelope_facts import EnvelopeFacts
    from camring.analyses.simulation import simulated
    from camring.evaluation.progress import SIMULATING, Spoken
    from camring.files.motor import read_motor_file
    from camring.presentation.facts import document, print_facts

    file = read_motor_file(motor)
    with Spoken(SIMULATING, terminals=True):
        found = simulated(file, estimate=False)
        envelope = None if found.outcome.failure else EnvelopeFacts.of(file)
    if json:
        typer.echo(document(found, envelope))
    else:
        print_facts(found, envelope)
    if found.outcome.failure:
        raise typer.Exit(FAILED)
    if found.broken or not (envelope is None or envelope.holds):
        raise typer.Exit(INFEASIBLE)

"""`camring check`: the facts of a motor, and which constraints hold."""

from pathlib import Path
from typing import Annotated

import typer

FAILED, INFEASIBLE = 1, 3


def check(
    motor: Annotated[Path, typer.Argument(help="Motor file.")],
    json: Annotated[
        bool, typer.Option("--json", help="One document on stdout, all else on stderr.")
    ] = False,
) -> None:
    """Print the facts of a motor: displacement, orders, port timing, limits, warnings.

    Exit code 3 says that a constraint does not hold.
    """
    from camring.interfaces.compilation_cache import keep_compiled_programs

    keep_compiled_programs()

    from camring.interfaces.config import read_motor_file
    from camring.interfaces.facts import document, print_facts
    from camring.interfaces.simulated import simulated

    found = simulated(read_motor_file(motor), estimate=False)
    if json:
        typer.echo(document(found))
    else:
        print_facts(found)
    if found.outcome.failure:
        raise typer.Exit(FAILED)
    if found.broken:
        raise typer.Exit(INFEASIBLE)

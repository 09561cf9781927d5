"""`camring pareto`: what one result costs in another."""

from pathlib import Path
from typing import Annotated

import typer

from camring.cli.options import JsonOption
from camring.files.csv_table import Decimal, DecimalOption


def pareto(
    motor: Annotated[Path, typer.Argument(help="Motor file with a [design_space].")],
    of: Annotated[
        str,
        typer.Option("--of", help="Two or three results, such as torque_ripple,efficiency."),
    ],
    out: Annotated[Path, typer.Option("--out", help="Folder to make; nothing may be there.")],
    points: Annotated[int, typer.Option(min=3, max=500, help="Designs wanted.")] = 50,
    decimal: DecimalOption = Decimal.POINT,
    json: JsonOption = False,
) -> None:
    """Trace the best compromises between two or three results, each a complete motor file.

    Every limit of [constraints] holds in every design. Results count as the mean of the
    operating points by their weights, stresses and other maxima at the worst of them,
    displacement of those at which no lobe idles.
    The folder gets front.csv, front.svg and designs/.
    """
    from camring.presentation.pareto import require_place, show, write

    require_place(out)

    from camring.evaluation.progress import Spoken
    from camring.files.motor import read_motor_file
    from camring.studies.pareto import trade_off, traded_results

    names = traded_results(of)
    with Spoken("Reading the motor file.") as say:
        found = trade_off(read_motor_file(motor), names, points=points, say=say)
    write(found, out, decimal)
    raise typer.Exit(show(found, out, as_json=json))

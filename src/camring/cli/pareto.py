"""`camring pareto`: what one result costs in another."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from camring.cli.options import JsonOption
from camring.cli.unfinished import requested, work_on
from camring.files.csv_table import Decimal, DecimalOption

if TYPE_CHECKING:
    from camring.evaluation.unfinished import Request
    from camring.files.motor import MotorFile


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
    The folder gets front.csv, front.svg and designs/. What was stopped goes on by the same
    command, or by `camring resume FOLDER`.
    """
    from camring.presentation.pareto import require_place

    require_place(out)
    request, file = requested("pareto", motor, of=of, points=points, decimal=decimal.value)
    raise typer.Exit(carry_out(request, file, out, as_json=json))


def carry_out(request: "Request", file: "MotorFile", out: Path, *, as_json: bool) -> int:
    """Also what was begun before; the exit code."""
    from camring.evaluation.unfinished import done
    from camring.presentation.pareto import show, write
    from camring.studies.pareto import trade_off, traded_results

    given = request.options
    names = traded_results(given["of"])
    with work_on(request, out) as (remember, say):
        found = trade_off(file, names, points=given["points"], say=say, remember=remember)
    write(found, out, Decimal(given["decimal"]))
    done(out)
    return show(found, out, as_json=as_json)

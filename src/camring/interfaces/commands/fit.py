"""`camring fit`: a motor file calibrated to measured rows."""

from pathlib import Path
from typing import Annotated

import typer


def fit(
    motor: Annotated[Path, typer.Argument(help="Motor file whose numbers are fitted.")],
    measured: Annotated[
        Path,
        typer.Argument(
            help="CSV: a header such as shaft speed [rpm], supply pressure [bar], "
            "mean torque [Nm], and a row for each operating point."
        ),
    ],
    out: Annotated[Path, typer.Option("--out", help="Motor file to write; must not exist.")],
    of: Annotated[
        str | None,
        typer.Option(
            "--of",
            help="Keys of the numbers to fit, separated by commas; else leakage, friction, "
            "discharge coefficient and bulk modulus as far as the rows tell them.",
        ),
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option("--picture", help="Draw modelled over measured: PNG, SVG or PDF."),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Replace the files of an earlier fit.")
    ] = False,
    json: Annotated[
        bool, typer.Option("--json", help="One document on stdout, all else on stderr.")
    ] = False,
) -> None:
    """Fit leakage, friction and other constants to measured torque, flow or efficiency.

    Each number gets its 95 % interval, and a warning where the rows do not tell it or do
    not tell it from another. Pressures are absolute unless a column's unit says gauge.
    """
    from camring.interfaces.fitting_output import document, require_places, say_written, show, write

    require_places(out, picture, force=force)

    from camring.interfaces.fitted_numbers import keys_of
    from camring.interfaces.fitting import fit as fitted

    found = fitted(
        motor,
        measured,
        None if of is None else keys_of(of),
        say=lambda sentence: typer.echo(sentence, err=True),
    )
    if not json:
        show(found)
    written = write(found, out, picture, force=force)
    if json:
        typer.echo(document(found, written))
    say_written(written, as_json=json)

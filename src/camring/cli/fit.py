"""`camring fit`: a motor file calibrated to measured rows."""

from pathlib import Path
from typing import Annotated

import typer

from camring.cli.options import JsonOption


def fit(
    motor: Annotated[Path, typer.Argument(help="Motor file whose numbers are fitted.")],
    measured: Annotated[
        Path,
        typer.Argument(
            help="CSV or XLSX: a header such as shaft speed [rpm], supply pressure [bar], "
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
    column: Annotated[
        list[str] | None,
        typer.Option(
            "--column",
            help='What a column is, where its header does not say it: torque="M [Nm]"; '
            "once for each.",
        ),
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option("--picture", help="Draw modelled over measured: PNG, SVG or PDF."),
    ] = None,
    force: Annotated[
        bool,
        typer.Option(
            "--force",
            help="Write also what does not fit, and replace the files of an earlier fit.",
        ),
    ] = False,
    json: JsonOption = False,
) -> None:
    """Fit leakage, friction and other constants to measured torque, flow or efficiency.

    Each number gets its 95 % interval, and a warning where the rows do not tell it or do
    not tell it from another. Pressures are absolute unless a column's unit says gauge.
    A fit that misses the rows, or rows of another displacement, are written with --force
    alone.
    """
    from camring.presentation.fitting import (
        columns_named,
        document,
        require_places,
        say_written,
        show,
        write,
    )

    require_places(out, picture, force=force)

    from camring.evaluation.progress import Spoken
    from camring.fitting.doubts import require_fit
    from camring.fitting.fit import fit as fitted
    from camring.fitting.fitted_numbers import keys_of

    with Spoken("Reading the table.") as say:
        found = fitted(
            motor,
            measured,
            None if of is None else keys_of(of),
            columns=columns_named(column or []),
            force=force,
            say=say,
        )
    if not json:
        show(found)
    if not force:
        if json and found.doubts:
            typer.echo(document(found, []))
        require_fit(found)
    written = write(found, out, picture, force=force)
    if json:
        typer.echo(document(found, written))
    say_written(written, as_json=json)

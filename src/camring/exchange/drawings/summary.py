"""What the command says of the files it wrote."""

import json
from collections.abc import Sequence

from rich.markup import escape
from rich.table import Table

from camring.exchange.drawings.products import Product, figures_of
from camring.files.motor import MotorFile
from camring.files.motor.document import printable
from camring.presentation.console import console
from camring.presentation.simulation import versions

__all__ = ["document", "print_written"]


def print_written(file: MotorFile, written: Sequence[Product]) -> None:
    """A line for each file, and below them what their users should know."""
    name = file.system.motor.name or printable(file.path)
    table = Table(title=escape(name), title_justify="left", box=None, show_header=False)
    table.add_column(overflow="fold")
    table.add_column()
    for each in written:
        table.add_row(escape(printable(each.path)), escape(each.holds))
    console().print(table)
    for note in (note for each in written for note in each.notes):
        console().print(escape(note))


def document(file: MotorFile, written: Sequence[Product]) -> str:
    """One JSON document, SI."""
    return json.dumps(
        {
            "input": printable(file.path),
            "name": file.system.motor.name,
            "versions": versions(),
            "files": figures_of(written),
        },
        indent=1,
        allow_nan=False,
    )

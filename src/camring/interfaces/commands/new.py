"""`camring new`: a commented motor file to start from."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer


class Profile(StrEnum):
    """Laws of lift that a new motor may have."""

    sine = "sine"
    constant_acceleration = "constant-acceleration"
    trapezoid = "trapezoid"
    zero_ripple = "zero-ripple"


def new(
    file: Annotated[Path, typer.Argument(help="Motor file to write, such as motor.toml.")],
    profile: Annotated[
        Profile, typer.Option("--profile", help="Law of lift of the cam.")
    ] = Profile.sine,
    force: Annotated[bool, typer.Option("--force", help="Replace a file that exists.")] = False,
) -> None:
    """Write a commented motor file to start from.

    It holds a small wheel motor with constraints, a design space and settings of
    the search; every line may be changed. A file that exists is left alone.
    """
    from camring.interfaces.config.document import printable
    from camring.interfaces.config.template import template
    from camring.interfaces.new_file import write_new_file

    write_new_file(file, template(profile.value), replace=force)
    typer.echo(f"Wrote {printable(file)}; look at it with `camring check {printable(file)}`.")

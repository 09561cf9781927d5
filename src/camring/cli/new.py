"""`camring new`: a motor file to start from, of a template, a library or a catalogue's data."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from camring.files.visible import say


class Profile(StrEnum):
    """Laws of lift that a new motor may have."""

    sine = "sine"
    constant_acceleration = "constant-acceleration"
    trapezoid = "trapezoid"
    zero_ripple = "zero-ripple"


def new(
    file: Annotated[
        Path | None, typer.Argument(help="Motor file to write, such as motor.toml.")
    ] = None,
    profile: Annotated[
        Profile | None,
        typer.Option("--profile", help="Law of lift of the cam of the commented template."),
    ] = None,
    like: Annotated[
        str | None, typer.Option("--like", help="A motor of the library, such as winch.")
    ] = None,
    list_: Annotated[
        bool, typer.Option("--list", help="Show the motors of the library and stop.")
    ] = False,
    displacement: Annotated[
        str | None, typer.Option("--displacement", help='"2.5 L/rev": chooses a motor of it.')
    ] = None,
    pressure: Annotated[
        str | None, typer.Option("--pressure", help='Its rated supply pressure, "250 bar".')
    ] = None,
    speed: Annotated[
        str | None, typer.Option("--speed", help='Its rated speed, "100 rpm".')
    ] = None,
    outer_diameter: Annotated[
        str | None,
        typer.Option(
            "--outer-diameter",
            help='The largest outer diameter of its ring, "500 mm"; may be left out.',
        ),
    ] = None,
    envelope: Annotated[str | None, typer.Option("--envelope", hidden=True)] = None,
    counts: Annotated[
        str | None,
        typer.Option("--counts", help='Pistons x lobes, "10x8", in place of the best.'),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a file that exists.")] = False,
) -> None:
    """Write a motor file to start from.

    Alone it writes a small wheel motor with every line explained. With --like it
    writes a motor of the library. With --displacement, --pressure and --speed, as
    a catalogue gives them, it chooses pistons, lobes, bore, stroke, roller and
    windows by stated rules and shows the alternatives; without FILE it only shows
    them. Each file is ready for `camring check` and `camring optimise`.
    """
    from camring.files.errors import InputError

    if envelope is not None:
        from camring.cli.renamed_options import doubled

        raise doubled("--envelope", envelope, "--outer-diameter")
    sizes = {
        "--displacement": displacement,
        "--pressure": pressure,
        "--speed": speed,
        "--outer-diameter": outer_diameter,
        "--counts": counts,
    }
    wanted = [name for name, value in sizes.items() if value is not None]
    _require_one_way(list_, like, profile, wanted)
    if list_:
        from camring.files.starting.library import print_library
        from camring.presentation.console import console

        print_library(console())
        return
    if wanted:
        text = _sized(displacement, pressure, speed, outer_diameter, counts)
    elif like is not None:
        from camring.files.starting.library import library_text

        text = library_text(like)
    else:
        from camring.files.starting.template import template

        text = template((profile or Profile.sine).value)
    if file is None:
        if wanted:
            say("Name a file, such as motor.toml, to write the one marked >.")
            return
        raise InputError("FILE", "is missing", "name the motor file to write, such as motor.toml")
    from camring.files.motor.document import printable
    from camring.files.new_file import write_new_file

    write_new_file(file, text, replace=force)
    say(f"Wrote {printable(file)}; check it with `camring check {printable(file)}`.")


def _require_one_way(
    list_: bool, like: str | None, profile: Profile | None, wanted: list[str]
) -> None:
    from camring.files.errors import InputError

    given = [
        name
        for name, is_given in (
            ("--list", list_),
            ("--like", like is not None),
            ("--profile", profile is not None),
            (wanted[0] if wanted else "", bool(wanted)),
        )
        if is_given
    ]
    if len(given) > 1:
        raise InputError(
            given[1], f"does not go with {given[0]}", "ask for one kind of motor file at a time"
        )


def _sized(
    displacement: str | None,
    pressure: str | None,
    speed: str | None,
    outer_diameter: str | None,
    counts: str | None,
) -> str:
    """The text of the best motor; shows the alternatives."""
    from camring.files.starting.alternatives import print_alternatives
    from camring.files.starting.demand import read_counts, read_demand
    from camring.files.starting.impossible import refusal
    from camring.files.starting.sized_file import sized_text
    from camring.files.starting.sizing import sized
    from camring.presentation.console import console

    demand = read_demand(displacement, pressure, speed, outer_diameter)
    asked = read_counts(counts)
    found = sized(demand, asked)
    if not len(found):
        raise refusal(demand, asked)
    print_alternatives(found, demand, console())
    return sized_text(found, 0, demand)

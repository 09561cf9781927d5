"""The small library of motors inside the package: their texts, and a table of them."""

import tomllib
from collections.abc import Iterator
from difflib import get_close_matches
from importlib.resources import files
from math import pi

from rich.console import Console
from rich.table import Table

from camring.files.errors import InputError, quote
from camring.files.units import to_si

_HOME = files("camring.files.starting")


def library() -> dict[str, str]:
    """The text of each motor file by its name, from the smallest displacement to the largest."""
    return _texts("motors")


def published() -> dict[str, str]:
    """Likewise, models that others have published with their results; no designs to begin with."""
    return _texts("published")


def _texts(folder: str) -> dict[str, str]:
    texts = {
        entry.name.removesuffix(".toml"): entry.read_text(encoding="utf-8")
        for entry in (_HOME / folder).iterdir()
        if entry.name.endswith(".toml")
    }
    return dict(sorted(texts.items(), key=lambda each: _litres(each[1])))


def library_text(name: str) -> str:
    """The motor file of a name.

    Raises
    ------
    InputError
        With the nearest name when there is none.
    """
    texts = {**library(), **published()}
    if name in texts:
        return texts[name]
    close = get_close_matches(name.lower().removesuffix(".toml"), texts, n=1, cutoff=0.5)
    way_out = (
        f"you probably meant {close[0]}"
        if close
        else "`camring new --list` shows them: " + ", ".join(texts)
    )
    raise InputError("--like", f"is {quote(name)}, which is no motor of the library", way_out)


def print_library(out: Console) -> None:
    """One line for each motor: size, operating point, counts and class."""
    table = Table("Name", box=None, pad_edge=False)
    for heading in ("L/rev", "Up to\nbar", "Up to\nrpm", "Pistons\nx lobes"):
        table.add_column(heading, justify="right")
    table.add_column("In the class of")
    for name, text in {**library(), **published()}.items():
        table.add_row(name, *_facts(text))
    out.print(table)
    out.print("`camring new motor.toml --like winch` writes one of them.")


def _facts(text: str) -> Iterator[str]:
    document = tomllib.loads(text)
    motor, points = document["motor"], document["operating_points"]
    yield f"{_litres(text):.3g}"
    yield f"{max(to_si(each['supply_pressure'], 'Pa') for each in points) / 1e5:.4g}"
    yield f"{max(to_si(each['speed'], 'rad/s') for each in points) * 30 / pi:.4g}"
    yield f"{motor['pistons']} x {motor['lobes']}"
    yield class_of(text)


def class_of(text: str) -> str:
    """What the file's header says behind `# Class:`."""
    lines = (line.removeprefix("# Class:") for line in text.splitlines() if "# Class:" in line)
    return next(lines, "").strip()


def _litres(text: str) -> float:
    """The middle of the displacement's band, in litres."""
    low, high = tomllib.loads(text)["constraints"]["displacement"]
    return sum(to_si(str(each).removesuffix("/rev"), "m^3") for each in (low, high)) / 2 * 1e3

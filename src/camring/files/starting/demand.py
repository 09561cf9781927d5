"""A catalogue's data as the command line has them, in SI or refused in a sentence."""

import re

from camring.files.errors import InputError, quote
from camring.files.motor.entries import Number, Unfit
from camring.files.motor.per_turn import PerTurn
from camring.files.motor.table import pressure_entry
from camring.files.starting import sizing_rules as rules
from camring.files.starting.sizing import Demand

_ENTRIES: dict[str, Number] = {
    "displacement": PerTurn(
        "the volume of one revolution", '"2.5 L/rev"', unit="m^3", low=1e-6, high=10.0
    ),
    "pressure": pressure_entry("the rated supply pressure", '"250 bar"', 1.0),
    "speed": Number("the rated speed", '"100 rpm"', unit="rad/s", low=1e-3, high=1e4),
    "outer-diameter": Number(
        "the largest outer diameter of the ring", '"500 mm"', unit="m", low=2e-3, high=20.0
    ),
}
_COUNTS = re.compile(r"\s*(\d{1,3})\s*[x×*/, ]\s*(\d{1,3})\s*")


def read_demand(
    displacement: str | None, pressure: str | None, speed: str | None, outer_diameter: str | None
) -> Demand:
    """The demand; the outer diameter may be left out.

    Raises
    ------
    InputError
        For a missing value, a wrong unit, or a pressure no higher than the return's.
    """
    given = {"displacement": displacement, "pressure": pressure, "speed": speed}
    values = {name: _read(name, text) for name, text in given.items()}
    least, _ = rules.RETURN_PRESSURES
    if values["pressure"] <= 2 * least:
        raise InputError(
            "--pressure",
            f"is {quote(pressure)}, no more than twice the {least / 1e5:g} bar of the return "
            "side that keep rollers on the ring",
            f"give more than {2 * least / 1e5:g} bar",
        )
    return Demand(
        values["displacement"],
        values["pressure"],
        values["speed"],
        float("inf") if outer_diameter is None else _read("outer-diameter", outer_diameter),
    )


def read_counts(text: str | None) -> list[tuple[int, int]] | None:
    """Pistons and lobes from `"10x8"`.

    Raises
    ------
    InputError
        When there are not two numbers, or the pistons all move alike.
    """
    if text is None:
        return None
    found = _COUNTS.fullmatch(text)
    if found is None:
        raise InputError(
            "--counts", f"is {quote(text)}", 'give pistons x lobes, for example "10x8"'
        )
    pistons, lobes = int(found[1]), int(found[2])
    if not 2 <= pistons <= 60 or not 1 <= lobes <= 60:
        raise InputError(
            "--counts",
            f"is {quote(text)} but takes 2 to 60 pistons and 1 to 60 lobes",
            'give for example "10x8"',
        )
    if lobes % pistons == 0:
        raise InputError(
            "--counts",
            f"is {quote(text)}: every piston stands at the same place of its lobe, so there are "
            "angles at which the motor gives no torque",
            "give another number of lobes",
        )
    return [(pistons, lobes)]


def _read(name: str, text: str | None) -> float:
    entry = _ENTRIES[name]
    if text is None:
        raise InputError(f"--{name}", "is missing", entry.way_out)
    try:
        bare = float(text)
    except ValueError:
        bare = None
    if bare is not None:
        # On a command line a bare number is a forgotten unit, not SI.
        raise InputError(f"--{name}", f"is {quote(text)} without a unit", entry.way_out)
    try:
        return entry.read(text)
    except Unfit as error:
        raise InputError(f"--{name}", error.problem, error.way_out) from None

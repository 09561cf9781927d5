"""What the header of a measured table may name: `supply pressure [bar]`, `torque sd [Nm]`."""

import re
from dataclasses import dataclass

from camring.files.errors import InputError, quote
from camring.files.motor.keys import nearest
from camring.files.unit_names import UnitError
from camring.files.units import measured, parse_unit, unit_of
from camring.fitting.measurements.names import (
    CASE_TEMPERATURE,
    CONDITIONS,
    SYNONYMS,
    is_aside,
    is_other_result,
    meanings,
    si_unit_of,
    words,
)
from camring.objective.measurable import CASE_RISE, MEASURABLE

_HEADER = re.compile(r"(?P<name>.*?)\s*(?:[\[(](?P<unit>[^\[\]]*)[\])])?\s*")
_LOOSE = re.compile(r"(?P<name>.*?\S)\s*(?:/|,|:|\bin\b)\s*[\[(]?(?P<unit>[^\[\]]*?)[\])]?")
_DEVIATION = ("_sd", "_standard_deviation", "_std")


@dataclass(frozen=True)
class Column:
    """A column that is read.

    Attributes
    ----------
    name
        Of `CONDITIONS` or `MEASURABLE`.
    header
        As the file has it, for messages.
    deviation
        Whether it holds standard deviations of the result.
    factor, offset
        SI value = number * factor + offset.
    """

    name: str
    header: str
    deviation: bool
    factor: float
    offset: float

    @property
    def is_result(self) -> bool:
        return self.name in MEASURABLE or self.name == CASE_TEMPERATURE


def column(header: str, where: str) -> Column | None:
    """The column that a header names; None where it stands in brackets and is not to be read.

    Raises
    ------
    InputError
        For a name or a unit that is not known, or a unit that measures something else.
    """
    shown = " ".join(header.split())
    if shown.startswith("("):
        return None
    written, unit = parts_of(shown)
    if not written:
        raise InputError(
            where,
            f"is {quote(shown)}, which names nothing",
            "name it like supply pressure [bar], or write it in brackets to leave it out",
        )
    plain, deviation = _without_deviation(written)
    meant = meanings(plain)
    if not meant:
        if is_other_result(written) or is_aside(written):
            return None
        close = nearest(plain.lower(), [*map(words, (*CONDITIONS, *MEASURABLE, *SYNONYMS))])
        raise InputError(
            where,
            f"is {quote(shown)}, which is nothing that can be read here",
            f"you probably meant {close}"
            if close
            else "write it in brackets to leave it out, or say what it is with --column "
            f'torque="{shown}"; known are ' + ", ".join(map(words, (*CONDITIONS, *MEASURABLE))),
        )
    name = next((each for each in meant if _fits(each, unit)), meant[0])
    if deviation and name in CONDITIONS:
        raise InputError(
            where,
            f"is {quote(shown)}, but only results have one",
            "write it in brackets to leave it out",
        )
    factor, offset = _scale(name, unit, where, shown)
    return Column(name, shown, deviation, factor, 0.0 if deviation else offset)


def parts_of(header: str) -> tuple[str, str]:
    """Name and unit of `supply pressure [bar]`, `p1 / bar`, `Torque, Nm`, `M in Nm`."""
    shown = " ".join(header.split())
    found = _HEADER.fullmatch(shown)
    name, unit = (found["name"].strip(), found["unit"] or "") if found else ("", "")
    if not unit and not meanings(_without_deviation(name)[0]):
        loose = _LOOSE.fullmatch(shown)
        if loose and meanings(_without_deviation(loose["name"])[0]):
            return loose["name"].strip(), loose["unit"].strip()
    return name, unit.strip()


def is_known(header: str) -> bool:
    """Whether a cell names something that is read."""
    return bool(meanings(_without_deviation(parts_of(header)[0])[0]))


def may_be_unit(cell: str) -> bool:
    """Whether a cell may stand in a row of units: a unit, perhaps in brackets, or nothing."""
    text = cell.strip().strip("[]()").strip()
    if text in ("", "-", "–", "—", "1"):
        return True
    try:
        return any(_readable(text, kind) for kind in ("rad/s", "Pa", "m^3/s", "N*m", "W", "K", "1"))
    except UnitError:
        return False


def _readable(text: str, kind: str) -> bool:
    return unit_of(text, kind).powers == parse_unit(kind).powers


def _without_deviation(written: str) -> tuple[str, bool]:
    name = re.sub(r"[\s_-]+", "_", written.strip())
    for ending in _DEVIATION:
        if name.lower().endswith(ending):
            return name[: -len(ending)], True
    return name, False


def _fits(name: str, unit: str) -> bool:
    try:
        return bool(unit) and _readable(unit, si_unit_of(name))
    except UnitError:
        return False


def _scale(name: str, unit: str, where: str, shown: str) -> tuple[float, float]:
    """Factor and offset to SI."""
    wanted = si_unit_of(name)
    if not unit:
        if wanted == "1":
            return 1.0, 0.0
        raise InputError(
            where,
            f"is {quote(shown)}, which has no unit",
            f"write it behind the name: {words(name)} [{_EXAMPLES.get(wanted, wanted)}]",
        )
    try:
        found, right = unit_of(unit, wanted), parse_unit(wanted)
        if found.powers != right.powers:
            raise UnitError(
                f"has the unit {unit!r}, which measures {measured(found)}, not {measured(right)}"
            )
    except UnitError as error:
        example = _EXAMPLES.get(wanted, wanted)
        raise InputError(
            where, f"is {quote(shown)}, which {error}", f"give it in {example}, for example"
        ) from None
    # A difference is the same above the atmosphere and above nothing, and above any zero.
    return found.factor, 0.0 if name in ("pressure_drop", CASE_RISE) else found.offset


_EXAMPLES = {
    "rad/s": "rpm",
    "Pa": "bar",
    "K": "degC",
    "N.m": "Nm",
    "m3/s": "L/min",
    "m^3/s": "L/min",
    "W": "kW",
    "1": "%",
}

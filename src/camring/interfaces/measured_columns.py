"""What the header of a measured table may name: `supply pressure [bar]`, `torque sd [Nm]`."""

import re
from dataclasses import dataclass

from camring.interfaces.config.keys import nearest
from camring.interfaces.errors import InputError, quote
from camring.interfaces.grid import si_units
from camring.interfaces.unit_names import SCALES, UnitError
from camring.interfaces.units import measured, parse_unit
from camring.objective.measurable import CASE_DRAIN, MEASURABLE

ATMOSPHERE = 101_325.0  # Pa; a gauge shows pressure above it

DUTIES = {
    "shaft_speed": "rad/s",
    "supply_pressure": "Pa",
    "pressure_drop": "Pa",
    "return_pressure": "Pa",
    "case_pressure": "Pa",
    "oil_temperature": "K",
}
"""What a row says of its operating point, with the unit of the program."""

SYNONYMS = {
    "speed": "shaft_speed",
    "inlet_pressure": "supply_pressure",
    "outlet_pressure": "return_pressure",
    "differential_pressure": "pressure_drop",
    "temperature": "oil_temperature",
    "torque": "mean_torque",
    "shaft_torque": "mean_torque",
    "flow": "supply_flow",
    "inlet_flow": "supply_flow",
    "leakage_flow": CASE_DRAIN,
    "case_flow": CASE_DRAIN,
    "drain_flow": CASE_DRAIN,
    "case_drain_flow": CASE_DRAIN,
    "total_efficiency": "efficiency",
    "overall_efficiency": "efficiency",
    "mechanical_efficiency": "hydromechanical_efficiency",
}

_SPELLINGS = {
    "1/min": "rpm",
    "min-1": "rpm",
    "min^-1": "rpm",
    "min⁻¹": "rpm",
    "r/min": "rpm",
    "rev/min": "rpm",
    "U/min": "rpm",
    "RPM": "rpm",
    "Nm": "N*m",
    "kNm": "kN*m",
    "lpm": "L/min",
    "C": "degC",
    "-": "1",
    "–": "1",
}
_HEADER = re.compile(r"(?P<name>[^\[(]*)(?:[\[(](?P<unit>.*)[\])])?\s*")
_ABOVE_AIR = re.compile(r"(.*?)\s*(?:\(g\)|\s(?:g|gauge)|(?<=bar)g)")
_ABSOLUTE = re.compile(r"(.*?)\s*(?:\(a\)|\s(?:a|abs|absolute)|(?<=bar)a)")
_DEVIATION = ("_sd", "_standard_deviation", "_std")


@dataclass(frozen=True)
class Column:
    """A column that is read.

    Attributes
    ----------
    name
        Of `DUTIES` or `MEASURABLE`.
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
        return self.name in MEASURABLE


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
    found = _HEADER.fullmatch(shown)
    if found is None or not found["name"].strip():
        raise InputError(
            where,
            f"is {quote(shown)}, which names nothing",
            "name it like supply pressure [bar], or write it in brackets to leave it out",
        )
    name = re.sub(r"[\s_-]+", "_", found["name"].strip().lower())
    deviation = name.endswith(_DEVIATION)
    for ending in _DEVIATION:
        name = name.removesuffix(ending)
    name = SYNONYMS.get(name, name)
    if name not in DUTIES and name not in MEASURABLE:
        close = nearest(name, [*DUTIES, *MEASURABLE, *SYNONYMS])
        raise InputError(
            where,
            f"is {quote(shown)}, which is nothing that can be read here",
            f"you probably meant {_words(close)}"
            if close
            else "write it in brackets to leave it out; known are "
            + ", ".join(map(_words, (*DUTIES, *MEASURABLE))),
        )
    if deviation and name in DUTIES:
        raise InputError(
            where,
            f"is {quote(shown)}, but only results have one",
            "write it in brackets to leave it out",
        )
    factor, offset = _scale(name, found["unit"], where, shown)
    return Column(name, shown, deviation, factor, 0.0 if deviation else offset)


def unit_of(name: str) -> str:
    """The unit in which the program keeps a duty or a result."""
    if name == CASE_DRAIN:
        return "m^3/s"
    return DUTIES.get(name) or si_units()[name]


def _scale(name: str, unit: str | None, where: str, shown: str) -> tuple[float, float]:
    """Factor and offset to SI."""
    wanted = unit_of(name)
    if unit is None or not unit.strip():
        if wanted == "1":
            return 1.0, 0.0
        raise InputError(
            where,
            f"is {quote(shown)}, which has no unit",
            f"write it behind the name: {_words(name)} [{_EXAMPLES.get(wanted, wanted)}]",
        )
    text, offset = unit.strip(), 0.0
    gauge, absolute = _ABOVE_AIR.fullmatch(text), _ABSOLUTE.fullmatch(text)
    if wanted == "Pa" and gauge is not None:
        text = gauge[1]
        offset = 0.0 if name == "pressure_drop" else ATMOSPHERE
    elif wanted == "Pa" and absolute is not None:
        text = absolute[1]
    text = _SPELLINGS.get(text, text)
    try:
        found = SCALES.get(text) or parse_unit(text)
        right = parse_unit(wanted)
        if found.powers != right.powers:
            raise UnitError(
                f"has the unit {text!r}, which measures {measured(found)}, not {measured(right)}"
            )
    except UnitError as error:
        example = _EXAMPLES.get(wanted, wanted)
        raise InputError(
            where, f"is {quote(shown)}, which {error}", f"give it in {example}, for example"
        ) from None
    return found.factor, found.offset + offset


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


def _words(name: str) -> str:
    return name.replace("_", " ")

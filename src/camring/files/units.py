"""Text with a unit to SI numbers, `"250 bar"` to 2.5e7, and back.

A small grammar of our own reads products and powers of unit names, so no
user text reaches an evaluator. The units an engineer writes every day are in a
table; any other name is asked of pint, which is slow to import and therefore
loaded only then. Spellings of data sheets and gauges are in another
(`unit_spellings.py`). Angle counts as a dimension: a speed is given in rpm or
rad/s, and `"2 Hz"`, which could mean either, is refused.
"""

import re
from functools import cache
from math import isfinite

from camring.files.unit_names import BASES, SCALES, Unit, UnitError, named_unit
from camring.files.unit_spellings import pressure_above, spelled

__all__ = [
    "UnitError",
    "difference_to_si",
    "from_si",
    "measured",
    "parse_unit",
    "split_quantity",
    "to_si",
    "unit_of",
]

LONGEST_TEXT = 80
DEEPEST_NESTING = 8


_QUANTITY = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*", re.DOTALL)
_TOKEN = re.compile(
    r"\s*(?:(?P<name>[^\W\d⁰¹²³⁴⁵⁶⁷⁸⁹]+|[°%][^\W\d]?)|(?P<digits>\d+)|(?P<raised>[⁻]?[⁰¹²³⁴⁵⁶⁷⁸⁹]+)"
    r"|(?P<sign>\*\*|[-+*/^().·⋅]))"
)
_RAISED = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")


def split_quantity(text: str) -> tuple[float, str]:
    """The number in front and the unit behind it; the unit may be empty.

    Raises
    ------
    UnitError
        When the text does not begin with a number.
    """
    if len(text) > LONGEST_TEXT:
        raise UnitError(f"is longer than the {LONGEST_TEXT} characters a quantity may have")
    found = _QUANTITY.fullmatch(text.replace("−", "-"))
    if found is None:
        raise UnitError("does not begin with a number")
    if found[2].startswith(","):
        raise UnitError("has a decimal comma where a decimal point is read")
    return float(found[1]), found[2]


def to_si(text: str, si_unit: str) -> float:
    """The SI value of a quantity in text, checked to have the dimension of `si_unit`.

    A number without a unit is SI already.

    Raises
    ------
    UnitError
        For an unknown unit or a wrong dimension; its text completes "motor.bore is ...".
    """
    number, unit_text = split_quantity(text)
    if not unit_text:
        return number
    unit = unit_of(unit_text, si_unit)
    wanted = parse_unit(si_unit)
    if unit.powers != wanted.powers:
        raise UnitError(
            f"has the unit {unit_text!r}, which measures {measured(unit)}, "
            f"not {measured(wanted)} ({si_unit})"
        )
    return number * unit.factor + unit.offset


def difference_to_si(text: str, si_unit: str) -> float:
    """The same for a difference, which no scale's zero and no atmosphere enters: `"5 degC"` is 5 K.

    Raises
    ------
    UnitError
        As `to_si`.
    """
    to_si(text, si_unit)
    number, unit_text = split_quantity(text)
    return number * unit_of(unit_text, si_unit).factor if unit_text else number


def from_si(value: float, unit_text: str, si_unit: str | None = None) -> float:
    """The number that, followed by the unit, means this SI value.

    Without `si_unit` a unit is taken for what it says alone: `1/min` for a frequency.
    """
    unit = unit_of(unit_text, si_unit)
    return (value - unit.offset) / unit.factor


@cache
def unit_of(text: str, si_unit: str | None = None) -> Unit:
    """The unit that a text means where a quantity of the kind of `si_unit` is asked for.

    The result may measure something else; that is for the caller to see.

    Raises
    ------
    UnitError
        For an unknown unit.
    """
    text = text.strip()
    spelt = None if si_unit is None else spelled(text, _kind(si_unit))
    if spelt is not None:
        text = spelt
    return SCALES.get(text) or pressure_above(text) or parse_unit(text)


@cache
def _kind(si_unit: str) -> str:
    """The unit as the table of spellings writes it: `m3/s` is its `m^3/s`."""
    powers = parse_unit(si_unit).powers
    return next((each for each in _MEASURED if parse_unit(each).powers == powers), si_unit)


@cache
def parse_unit(text: str) -> Unit:
    """A unit expression such as `m^3/(s*Pa)`, `N.s/m`, `mm²` or `kg/m3`.

    Products are `*`, `.`, `·`, `-` or a space; powers are `^2`, `**2`, `²` or
    digits behind the name, `m2`, `s-1`. Division binds as in `a/b*c = (a/b)*c`.
    """
    if text in ("", "1"):
        return Unit(1.0)
    try:
        unit, rest = _product(_tokens(text), text, DEEPEST_NESTING)
        beyond = not isfinite(unit.factor) or unit.factor == 0
    except (OverflowError, ZeroDivisionError):
        beyond, rest = True, []
    if beyond:
        raise UnitError(f"has the unit {text!r}, whose size is beyond all numbers")
    if rest:
        raise UnitError(f"has the unit {text!r}, which does not end properly")
    return unit


def _tokens(text: str) -> list[tuple[str, str]]:
    tokens, position = [], 0
    text = text.rstrip()
    while position < len(text):
        found = _TOKEN.match(text, position)
        if found is None:
            raise UnitError(
                f"has the unit {text!r}, in which {text[position : position + 1]!r} means nothing"
            )
        kind = str(found.lastgroup)
        tokens.append((kind, found[kind]))
        position = found.end()
    return tokens


def _product(
    tokens: list[tuple[str, str]], text: str, depth: int
) -> tuple[Unit, list[tuple[str, str]]]:
    if depth == 0:
        raise UnitError(f"has the unit {text!r}, whose brackets are nested too deeply")
    unit, tokens = _factor(tokens, text, depth)
    while tokens and tokens[0][1] != ")":
        sign = 1
        if tokens[0][1] in ("*", ".", "·", "⋅", "-", "/"):
            sign = -1 if tokens[0][1] == "/" else 1
            tokens = tokens[1:]
        factor, tokens = _factor(tokens, text, depth)
        unit = unit.times(factor, sign)
    return unit, tokens


def _factor(
    tokens: list[tuple[str, str]], text: str, depth: int
) -> tuple[Unit, list[tuple[str, str]]]:
    kind, word = tokens[0] if tokens else ("", "")
    tokens = tokens[1:]
    if word == "(":
        unit, tokens = _product(tokens, text, depth - 1)
        if not tokens or tokens[0][1] != ")":
            raise UnitError(f"has the unit {text!r}, in which a bracket is not closed")
        tokens = tokens[1:]
    elif kind == "name":
        unit = named_unit(word)
    elif (kind, word) == ("digits", "1"):
        unit = Unit(1.0)
    else:
        raise UnitError(f"has the unit {text!r}, in which a name is missing")
    exponent, tokens = _exponent(tokens, text)
    return unit.power(exponent), tokens


def _exponent(tokens: list[tuple[str, str]], text: str) -> tuple[int, list[tuple[str, str]]]:
    if not tokens:
        return 1, tokens
    kind, word = tokens[0]
    if kind == "raised":
        digits, tokens = word.translate(_RAISED), tokens[1:]
    elif kind == "digits":
        digits, tokens = word, tokens[1:]
    elif word == "-" and tokens[1:] and tokens[1][0] == "digits":
        digits, tokens = word + tokens[1][1], tokens[2:]
    elif word in ("^", "**"):
        sign = ""
        tokens = tokens[1:]
        if tokens and tokens[0][1] in ("-", "+"):
            sign, tokens = tokens[0][1], tokens[1:]
        if not tokens or tokens[0][0] != "digits":
            raise UnitError(f"has the unit {text!r}, in which an exponent is no whole number")
        digits, tokens = sign + tokens[0][1], tokens[1:]
    else:
        return 1, tokens
    if len(digits) > 2 or digits == "-":
        raise UnitError(f"has the unit {text!r}, whose exponent {digits} is beyond all use")
    return int(digits), tokens


_MEASURED = {
    "1": "a plain number",
    "m": "a length",
    "m^2": "an area",
    "m^3": "a volume",
    "kg": "a mass",
    "s": "a time",
    "rad": "an angle",
    "rad/s": "a turning speed",
    "1/s": "a frequency",
    "m/s": "a speed",
    "m/s^2": "an acceleration",
    "m/s^3": "a jerk",
    "m^3/s": "a flow",
    "m^2/s": "a kinematic viscosity",
    "kg/m^3": "a density",
    "N": "a force",
    "N*m": "a torque or an energy",
    "Pa": "a pressure",
    "Pa*s": "a dynamic viscosity",
    "N*s/m": "a damping",
    "m^3/(s*Pa)": "a leakage coefficient",
    "W": "a power",
    "K": "a temperature",
}


@cache
def _measures() -> dict[tuple[int, ...], str]:
    return {parse_unit(unit).powers: words for unit, words in _MEASURED.items()}


def measured(unit: Unit) -> str:
    """What a unit measures, in words, or its SI base units where no word is at hand."""
    bases = [
        base if power == 1 else f"{base}^{power}"
        for base, power in zip(BASES, unit.powers, strict=True)
        if power
    ]
    return _measures().get(unit.powers, "*".join(bases))

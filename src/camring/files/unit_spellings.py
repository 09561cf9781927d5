"""Unit texts as data sheets, gauges and spreadsheets write them, by what they must measure.

The one table for motor files, measured tables and the command line: `1/min` where a turning
speed is asked for is rpm, `kg/cm2` where a pressure is asked for is kgf/cm^2. Case, blanks
and the signs of products do not count here. Gauge pressures (`barg`, `psi(g)`, `bar gauge`)
stand above an atmosphere of 1.01325 bar, everywhere.
"""

import re

from camring.files.unit_names import SCALES, Unit, everyday_unit

ATMOSPHERE = 101_325.0  # Pa; a gauge shows pressure above it

_LB = ("lb", "lbs", "lbf")
_KG = ("kg", "kgf", "kp")


def _products(first: tuple[str, ...], second: tuple[str, ...]) -> tuple[str, ...]:
    """Both orders, with and without a sign between."""
    pairs = [(a, b) for a in first for b in second] + [(b, a) for a in first for b in second]
    return tuple(f"{a}{sign}{b}" for a, b in pairs for sign in (".", ""))


def _quotients(above: tuple[str, ...], below: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(f"{a}/{b}" for a in above for b in below)


_SPELT: dict[str, dict[str, tuple[str, ...]]] = {
    "rad/s": {
        "rpm": (
            *_quotients(("1", "", "r", "rev", "revs", "u", "t", "tr", "turns"), ("min", "mn")),
            *("min-1", "r.min-1", "rev.min-1", "rpm", "r.p.m", "upm"),
        ),
        "rev/s": ("r/s", "rev/s", "u/s", "rps"),
    },
    "N*m": {
        "N*m": ("nm", "n.m"),
        "kN*m": ("knm", "kn.m"),
        "daN*m": ("danm", "dan.m"),
        "lbf*ft": _products(_LB, ("ft", "foot")),
        "lbf*in": _products(_LB, ("in", "inch")),
        "kgf*m": _products(_KG, ("m",)),
    },
    "Pa": {
        "psi": ("psi", *_quotients(_LB, ("in2", "sq.in", "inch2"))),
        "kgf/cm^2": (*_quotients(_KG, ("cm2", "sq.cm")), "at"),
        "MPa": ("n/mm2", "n/sq.mm"),
    },
    "m^3/s": {
        "gpm": ("gpm", "us.gpm", "usgpm", *_quotients(("gal", "us.gal", "gals"), ("min", "mn"))),
        "imperial_gallon/min": ("igpm", "imp.gpm", "uk.gpm", "imp.gal/min", "uk.gal/min"),
        "L/min": (
            *("lpm", "l.p.m", "l.min-1"),
            *_quotients(("l", "lt", "ltr", "lit", "liter", "litre", "liters", "litres"),
                        ("min", "mn")),
        ),
    },
    "m^3": {"cid": ("cid", "ci", "cu.in", "cuin", "cu.inch", "inch3")},
    "m": {"in": ("inch", "inches", "in."), "um": ("micron", "microns")},
    "K": {
        "degC": ("c", "°c", "degc", "deg.c", "°.c", "celsius", "deg.celsius"),
        "degF": ("f", "°f", "degf", "deg.f", "°.f", "fahrenheit", "deg.fahrenheit"),
        "K": ("k", "kelvin"),
    },
    "Pa*s": {"mPa*s": ("mpas", "mpa.s", "cp", "cps")},
    "m^2/s": {"cSt": ("cst", "centistoke", "centistokes")},
    "1": {"1": ("-", "–", "—", "1"), "%": ("percent", "per.cent", "pct")},
}  # fmt: skip
_WITHOUT_SIGN = {
    what: {each: name for name, spelt in names.items() for each in spelt}
    for what, names in _SPELT.items()
}
_RAISED = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
_SIDE = re.compile(
    r"(?P<unit>.*?[^\s(\[_])[\s_]*[\[(]?\s*"
    r"(?:(?P<gauge>g|gauge|gage|ü)|(?P<absolute>a|abs\.?|absolute))\s*[\])]?",
    re.IGNORECASE,
)


def spelled(text: str, measures: str) -> str | None:
    """The text of a unit as `units.parse_unit` reads it; None where the table has no such one.

    Parameters
    ----------
    measures
        The SI unit of what is asked for, as a key of the table writes it.
    """
    found = _WITHOUT_SIGN.get(measures, {}).get(_plain(text))
    # A capital M is a million: 2 MPa*s is no 2 mPa*s, however unlikely.
    return None if found and found[0] == "m" and text.lstrip()[:1] == "M" else found


def pressure_above(text: str) -> Unit | None:
    """A pressure unit that says what it stands above: `bar(g)`, `psia`; None for any other.

    The offset of a gauge's unit is the atmosphere, of an absolute one zero.
    """
    found = _SIDE.fullmatch(text.strip())
    if found is None or text in SCALES:
        return None
    name = spelled(found["unit"], "Pa") or found["unit"].strip()
    unit = everyday_unit("at" if name == "kgf/cm^2" else name)
    if unit is None or unit.powers != _PASCAL.powers:
        return None
    return Unit(unit.factor, unit.powers, ATMOSPHERE if found["gauge"] else 0.0)


def of_one_turn(text: str) -> str:
    """A volume without the turn it is counted for: `cm^3` of `cm^3/rev`, `cc per r`."""
    return _TURN.sub("", text)


def says_gauge(document: object) -> bool:
    """Whether a text, or any in a motor file's tables, is a pressure above the atmosphere's."""
    if isinstance(document, dict | list):
        values = document.values() if isinstance(document, dict) else document
        return any(says_gauge(each) for each in values)
    found = _BEHIND_NUMBER.fullmatch(document) if isinstance(document, str) else None
    above = pressure_above(found[1]) if found is not None and found[1] else None
    return above is not None and above.offset > 0


ATMOSPHERE_SAID = "gauge pressures stand above an atmosphere of 1.01325 bar (14.696 psi)"
_BEHIND_NUMBER = re.compile(r"\s*[+-]?[\d.][\d.eE+-]*\s*(\D.*)")
_TURN = re.compile(r"\s*(?:/|\bper\b)\s*(rev|revolution|turn|r|u)\.?\s*$", re.IGNORECASE)
_PASCAL = Unit(1.0, (-1, 1, -2, 0, 0))


def _plain(text: str) -> str:
    """In small letters, products by a point, powers by digits alone."""
    found = text.strip().lower().translate(_RAISED).replace("**", "").replace("^", "")
    found = re.sub(r"\s*/\s*", "/", found)
    found = re.sub(r"(?<=[^\W\d°])[\s·⋅*.-]+(?=[^\W\d])", ".", found)
    return re.sub(r"(?<=°)\s+(?=\w)", "", found).rstrip(".")

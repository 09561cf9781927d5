"""Units by name: the everyday ones in a table, any other asked of pint.

pint is slow to import and therefore loaded only then. Angle counts as a
dimension here, as it does not for pint. Case is ignored where only one unit can be meant:
`RPM`, `Bar` and `L/Min` are read, `mpa` (mPa or MPa) is refused.
"""

from difflib import get_close_matches
from functools import cache
from math import pi
from typing import Any, NamedTuple

BASES = ("m", "kg", "s", "rad", "K")


class UnitError(ValueError):
    """A unit that does not exist or does not fit, as the end of a sentence."""


class Unit(NamedTuple):
    """So many SI units with these powers of metre, kilogram, second, radian, kelvin."""

    factor: float
    powers: tuple[int, ...] = (0, 0, 0, 0, 0)
    offset: float = 0.0  # a temperature scale's zero, K

    def times(self, other: "Unit", sign: int = 1) -> "Unit":
        powers = tuple(a + sign * b for a, b in zip(self.powers, other.powers, strict=True))
        return Unit(self.factor * other.factor**sign, powers)

    def power(self, exponent: int) -> "Unit":
        return Unit(self.factor**exponent, tuple(exponent * p for p in self.powers))


def _unit(factor: float, m: int = 0, kg: int = 0, s: int = 0, rad: int = 0, K: int = 0) -> Unit:
    return Unit(factor, (m, kg, s, rad, K))


_LENGTH, _FORCE, _PRESSURE = dict(m=1), dict(m=1, kg=1, s=-2), dict(m=-1, kg=1, s=-2)
_ENERGY, _POWER = dict(m=2, kg=1, s=-2), dict(m=2, kg=1, s=-3)

GRAVITY, POUND = 9.80665, 0.45359237  # standard, m/s2; kg

# Compared with pint's definitions in tests/files/test_units.py.
EVERYDAY: dict[str, Unit] = {
    "m": _unit(1, **_LENGTH),
    "mm": _unit(1e-3, **_LENGTH),
    "cm": _unit(1e-2, **_LENGTH),
    "dm": _unit(1e-1, **_LENGTH),
    "in": _unit(0.0254, **_LENGTH),
    "inch": _unit(0.0254, **_LENGTH),
    "ft": _unit(0.3048, **_LENGTH),
    "um": _unit(1e-6, **_LENGTH),
    "µm": _unit(1e-6, **_LENGTH),
    "L": _unit(1e-3, m=3),
    "l": _unit(1e-3, m=3),
    "ccm": _unit(1e-6, m=3),
    "cc": _unit(1e-6, m=3),
    "mL": _unit(1e-6, m=3),
    "ml": _unit(1e-6, m=3),
    "gal": _unit(231 * 0.0254**3, m=3),  # of the United States
    "cid": _unit(0.0254**3, m=3),
    "gpm": _unit(231 * 0.0254**3 / 60, m=3, s=-1),
    "lpm": _unit(1e-3 / 60, m=3, s=-1),
    "kg": _unit(1, kg=1),
    "g": _unit(1e-3, kg=1),
    "t": _unit(1e3, kg=1),
    "lb": _unit(POUND, kg=1),
    "lbs": _unit(POUND, kg=1),
    "s": _unit(1, s=1),
    "ms": _unit(1e-3, s=1),
    "min": _unit(60, s=1),
    "h": _unit(3600, s=1),
    "Hz": _unit(1, s=-1),
    "rad": _unit(1, rad=1),
    "deg": _unit(pi / 180, rad=1),
    "°": _unit(pi / 180, rad=1),
    "rev": _unit(2 * pi, rad=1),
    "U": _unit(2 * pi, rad=1),  # of German data sheets, U/min
    "rpm": _unit(2 * pi / 60, rad=1, s=-1),
    "N": _unit(1, **_FORCE),
    "daN": _unit(1e1, **_FORCE),
    "kN": _unit(1e3, **_FORCE),
    "MN": _unit(1e6, **_FORCE),
    "kgf": _unit(GRAVITY, **_FORCE),
    "kp": _unit(GRAVITY, **_FORCE),
    "lbf": _unit(POUND * GRAVITY, **_FORCE),
    "Nm": _unit(1, **_ENERGY),
    "nm": _unit(1e-9, m=1),
    "kNm": _unit(1e3, **_ENERGY),
    "mPa": _unit(1e-3, **_PRESSURE),  # of viscosities, mPa.s
    "hPa": _unit(1e2, **_PRESSURE),
    "Pa": _unit(1, **_PRESSURE),
    "kPa": _unit(1e3, **_PRESSURE),
    "MPa": _unit(1e6, **_PRESSURE),
    "GPa": _unit(1e9, **_PRESSURE),
    "mbar": _unit(1e2, **_PRESSURE),
    "bar": _unit(1e5, **_PRESSURE),
    "psi": _unit(POUND * GRAVITY / 0.0254**2, **_PRESSURE),
    "ksi": _unit(1e3 * POUND * GRAVITY / 0.0254**2, **_PRESSURE),
    "at": _unit(GRAVITY * 1e4, **_PRESSURE),
    "atm": _unit(101_325, **_PRESSURE),
    "J": _unit(1, **_ENERGY),
    "W": _unit(1, **_POWER),
    "kW": _unit(1e3, **_POWER),
    "MW": _unit(1e6, **_POWER),
    "hp": _unit(550 * 0.3048 * POUND * GRAVITY, **_POWER),
    "PS": _unit(75 * GRAVITY, **_POWER),
    "cSt": _unit(1e-6, m=2, s=-1),
    "cP": _unit(1e-3, m=-1, kg=1, s=-1),
    "K": _unit(1, K=1),
    "%": _unit(1e-2),
}

# Scales whose zero is not absolute zero stand alone, never in a product.
SCALES: dict[str, Unit] = {
    "degC": Unit(1.0, (0, 0, 0, 0, 1), 273.15),
    "°C": Unit(1.0, (0, 0, 0, 0, 1), 273.15),
    "degF": Unit(5 / 9, (0, 0, 0, 0, 1), 459.67 * 5 / 9),
    "°F": Unit(5 / 9, (0, 0, 0, 0, 1), 459.67 * 5 / 9),
}


_PREFIXED = {"mm", "ml", "mL", "ms", "mbar", "mPa", "MPa", "MN", "MW"}
"""Names whose first letter means a thousandth or a million, as its case says."""


def named_unit(name: str) -> Unit:
    """One unit by its name, from the table or from pint."""
    name = name.replace("μ", "µ")  # the Greek letter for the micro sign
    found = everyday_unit(name) or (_ask_pint(name) if len(name) > 1 else None)
    if found is not None:
        return found
    if name in SCALES:
        raise UnitError(f"uses {name!r} in a product, where a temperature scale has no meaning")
    close = get_close_matches(name, EVERYDAY, n=1, cutoff=0.5)
    if not close:
        close = [known for known in EVERYDAY if known.lower() == name.lower()]
    hint = f" (did you mean {close[0]!r}?)" if close else ""
    raise UnitError(f"has the unknown unit {name!r}{hint}")


def everyday_unit(name: str) -> Unit | None:
    """A unit of the table, by its name in any case that leaves no doubt.

    Raises
    ------
    UnitError
        Where two units are written alike but for the case.
    """
    if name in EVERYDAY or len(name) < 2:
        return EVERYDAY.get(name)
    alike = _folded().get(name.lower(), ())
    meant = [each for each in alike if each not in _PREFIXED or each[0] == name[0]]
    if not meant and name.isupper():
        meant = list(alike)
    if meant and name[0] == "m" and len({EVERYDAY[each].factor for each in alike}) > 1:
        raise UnitError(
            f"has the unit {name!r}, which may be {' or '.join(sorted(alike))}: write its case"
        )
    return EVERYDAY[meant[0]] if meant else None


@cache
def _folded() -> dict[str, tuple[str, ...]]:
    """Names that differ only in case, by the name in small letters."""
    found: dict[str, tuple[str, ...]] = {}
    for name in EVERYDAY:
        found[name.lower()] = (*found.get(name.lower(), ()), name)
    return found


@cache
def _pint_registry() -> Any:
    """pint's registry, which has no type before pint is imported."""
    import pint

    return pint.UnitRegistry()


@cache
def _ask_pint(name: str) -> Unit | None:
    """The unit from pint's definitions; None when pint has none that we can use."""
    registry = _pint_registry()
    roots = {"meter": "m", "gram": "g", "kilogram": "kg", "second": "s", "radian": "rad"}
    roots["kelvin"] = "K"
    try:
        one = registry.Quantity(1.0, name).to_root_units()
        zero = registry.Quantity(0.0, name).to_root_units()
        powers = dict(one.units._units)
        parts = [(roots[base], int(power)) for base, power in powers.items()]
        exact = all(float(power).is_integer() for power in powers.values())
    except Exception:  # pint raises errors of a dozen kinds; each means "not a unit for us"
        return None
    if not exact or zero.magnitude != 0:
        return None
    unit = Unit(float(one.magnitude))
    for base, power in parts:
        unit = unit.times(EVERYDAY[base].power(power))
    return unit

"""Units in which a number may be shown, and how to get there from SI."""

from functools import cache

from camring.files.motor.entries import Number
from camring.files.units import UnitError, split_quantity, unit_of

_CHOICES: tuple[tuple[str, ...], ...] = (
    ("mm", "um", "cm", "m", "in"),
    ("mm^2", "cm^2", "m^2", "in^2"),
    ("cm^3", "L", "mm^3", "m^3", "in^3"),
    ("deg", "rad"),
    ("rpm", "rad/s"),
    ("bar", "MPa", "GPa", "kPa", "Pa", "psi"),
    ("kg", "g", "lb"),
    ("N", "kN", "lbf"),
    ("N*m", "kN*m"),
    ("degC", "K", "degF"),
    ("mm^2/s", "m^2/s"),
    ("kg/m^3", "g/cm^3"),
    ("m/s",),
    ("m/s^2",),
    ("m/s^3",),
    ("m^3/(s*Pa)", "L/min/bar"),
    ("N*s/m",),
    ("s", "min", "h"),
)


def given_unit(entry: Number, raw: object) -> str:
    """The unit a value is written in, or of the entry's example where there is no value."""
    text = raw if isinstance(raw, str) else None
    if raw is None:
        text = entry.example.strip('"')
    if text is None:
        return ""
    try:
        return split_quantity(text)[1]
    except UnitError:
        return ""


@cache
def units_for(si_unit: str, first: str) -> tuple[tuple[str, float, float], ...]:
    """Unit, factor and offset of each that fits, the given one first.

    A value in SI is `number * factor + offset`.
    """
    if si_unit == "1":
        names: tuple[str, ...] = ("%", "") if first == "%" else ("",) if first == "" else (first,)
    else:
        wanted = unit_of(si_unit).powers
        fitting = next((each for each in _CHOICES if unit_of(each[0]).powers == wanted), (si_unit,))
        names = tuple(dict.fromkeys((first or fitting[0], *fitting)))
    found = []
    for name in names:
        try:
            unit = unit_of(name, si_unit) if name else unit_of("1")
        except UnitError:
            continue
        found.append((name, unit.factor, unit.offset))
    return tuple(found)

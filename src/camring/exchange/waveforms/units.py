"""Units of waveforms and results: SI as programs write it, and what engineers read."""

from functools import cache
from math import pi
from typing import Annotated, NamedTuple, get_args, get_origin, get_type_hints

__all__ = ["EVERYDAY", "RESULT", "Everyday", "everyday_result", "result_units", "spelt_out"]

RESULT = "result_"
"""Before the name of each result in the dataset, where some waveforms have the same names."""


class Everyday(NamedTuple):
    """An engineer's unit, and how many of it an SI unit is."""

    unit: str
    factor: float


_DEGREE = Everyday("deg", 180 / pi)
_BAR = Everyday("bar", 1e-5)
_LITRES_A_MINUTE = Everyday("L/min", 6e4)

# Coordinate or waveform of the dataset -> unit in tables for people.
EVERYDAY = {
    "angle": _DEGREE,
    "lift": Everyday("mm", 1e3),
    "velocity": Everyday("m/s", 1.0),
    "acceleration": Everyday("m/s2", 1.0),
    "jerk": Everyday("m/s3", 1.0),
    "volume": Everyday("cm3", 1e6),
    "chamber_pressure": _BAR,
    "manifold_pressure": _BAR,
    "return_manifold_pressure": _BAR,
    "supply_flow": _LITRES_A_MINUTE,
    "return_flow": _LITRES_A_MINUTE,
    "leakage_flow": _LITRES_A_MINUTE,
    "contact_force": Everyday("kN", 1e-3),
    "contact_stress": Everyday("MPa", 1e-6),
    "torque": Everyday("N m", 1.0),
    "shaft_speed": Everyday("rpm", 30 / pi),
    "supply_pressure": _BAR,
    "return_pressure": _BAR,
    "case_pressure": _BAR,
    "weight": Everyday("1", 1.0),
}


def everyday_result(name: str, unit: str) -> Everyday:
    """The unit for people of a result that no table of the report names."""
    if unit == "1" and ("ripple" in name or name.startswith("share_")):
        return Everyday("%", 100.0)
    return {"m": Everyday("mm", 1e3), "Pa": _BAR}.get(unit, Everyday(unit, 1.0))


@cache
def result_units() -> dict[str, str]:
    """SI units of the results by name, as UDUNITS writes them."""
    from camring.metrics.summary import Metrics

    hints = get_type_hints(Metrics, include_extras=True)
    return {
        name: spelt_out(get_args(hint)[1])
        for name, hint in hints.items()
        if get_origin(hint) is Annotated
    }


def spelt_out(unit: str) -> str:
    """A unit such as `m3/s` or `N.m` without stroke and dot: `m3 s-1`, `N m`."""
    above, *below = unit.split("/")
    parts = above.split(".")
    for each in below:
        name = each.strip("()").rstrip("0123456789")
        power = each.strip("()")[len(name) :]
        parts.append(f"{name}-{power or 1}")
    return " ".join(parts)

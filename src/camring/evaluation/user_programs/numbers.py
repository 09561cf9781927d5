"""Whether numbers of somebody else's program can be what they are taken for: results in SI.

A pressure in bar passes a limit in Pa with all of its margin, and an efficiency of 95.1
makes a fine objective. Our simulation of the same design stands beside every such number:
what cannot be is refused, and what lies a unit away from ours is questioned.
"""

import math
from collections.abc import Mapping, Sequence

from camring.evaluation.user_programs.command import CommandFailed
from camring.files.errors import InputError
from camring.files.named_units import Named, factor_of, si_units
from camring.metrics.result_scale import BESIDE, RIPPLES

MOST_EFFICIENCY = 1.05
"""An efficiency is at most 1 by its definition; a program may count the oil that it
compresses twice, or round, but not by more than this."""

FACTOR = 10.0
"""Two models of one motor that differ by more than this do not speak of the same thing, or not
in the same unit. Smaller differences are what a better model is for."""

NEAR = 3.0
"""So close to a unit's factor a ratio is taken for that unit: half a decade, for units of one
quantity lie a decade or more apart."""

EFFICIENCIES = (
    "efficiency",
    "volumetric_efficiency",
    "hydromechanical_efficiency",
    "port_efficiency",
)
POSSIBLE: Mapping[str, tuple[float, float]] = {
    **dict.fromkeys(EFFICIENCIES, (-MOST_EFFICIENCY, MOST_EFFICIENCY)),
    **dict.fromkeys(RIPPLES, (0.0, math.inf)),
    **dict.fromkeys(("share_below_air_release", "share_below_vapour"), (0.0, 1.0)),
    "max_pressure_angle": (0.0, math.pi / 2),
    **dict.fromkeys(
        (
            "displacement", "stroke", "l10_life", "max_pressure", "supply_pressure_swing",
            "return_pressure_swing",
            "max_contact_stress", "max_velocity", "max_acceleration", "max_jerk",
            "hydraulic_stiffness", "natural_frequency", "damping_ratio",
        ),
        (0.0, math.inf),
    ),
}  # fmt: skip
"""Least and most that a result can be, SI; others can be anything finite."""

SMALL = {*BESIDE, *RIPPLES, "min_contact_force", "power_residual", "jerk_objective"}
"""What is small beside something else, or near zero in a good motor: models differ in it by
any factor, so only one that is a unit's is questioned."""

UNITS: Mapping[str, tuple[str, ...]] = {
    "1": ("%",),
    "Pa": ("mbar", "kPa", "psi", "bar", "MPa", "GPa"),
    "m": ("um", "mm", "cm", "inch"),
    "m3": ("mm3", "cm3", "L", "inch^3"),
    "m3/s": ("mm3/s", "L/min", "cm3/s", "L/s", "m3/h"),
    "N": ("kN",),
    "N.m": ("N.mm", "kN.m"),
    "N/m": ("N/mm", "N/um"),
    "W": ("kW", "hp"),
    "rad": ("deg",),
    "rad/s": ("rpm",),
    "s": ("min", "h"),
    "m/s": ("mm/s",),
    "m/s2": ("mm/s2",),
    "m/s3": ("mm/s3", "km/s3"),
}
"""What each SI unit is often left out for."""


class Impossible(CommandFailed):
    """A number that no motor has."""


class NotBelieved(InputError):
    """Numbers of the given motor that are wrong or in another unit; the study must not go on."""


def require_possible(given: Sequence[Mapping[str, float]]) -> None:
    """Raises `Impossible` when a result is outside what its definition allows."""
    for place, results in enumerate(given, start=1):
        for name, value in results.items():
            low, high = POSSIBLE.get(name, (-math.inf, math.inf))
            if not low <= value <= high:
                limit = f"at most {high:g}" if value > high else f"at least {low:g}"
                unit = _unit_within(name, value, low, high)
                hint = f" and looks like {unit}" if unit else ""
                raise Impossible(
                    f"its {name} at operating point {place} is {value:g}, which can be "
                    f"{limit}{_si(name)}{hint}"
                )


def doubts_about(
    given: Sequence[Mapping[str, float]],
    ours: Sequence[Mapping[str, float]],
    named: Named = (),
) -> dict[str, tuple[str, str]]:
    """Results that lie a unit, or more than a model can, away from our simulation's.

    Parameters
    ----------
    given, ours
        Of the same design, for each operating point, SI.
    named
        Results whose unit the user has named: these are what they are said to be.

    Returns
    -------
    By name of the result: a clause that says so, and the unit it looks like or "".
    """
    found: dict[str, tuple[str, str]] = {}
    known = dict(named)
    for place, (theirs, own) in enumerate(zip(given, ours, strict=True), start=1):
        for name, value in theirs.items():
            other = own.get(name, math.nan)
            if name in found or name in known or not value * other > 0:
                continue
            ratio = value / other
            if 1 / FACTOR < ratio < FACTOR:
                continue
            unit = _likely_unit(name, ratio)
            if not unit and name in SMALL:
                continue
            said = f"a factor of {ratio:.2g} away; it looks like {unit}" if unit else (
                f"a factor of {ratio:.2g} away, which no usual unit explains"
            )  # fmt: skip
            found[name] = (
                f"{name} at operating point {place} is {value:g} where our simulation says "
                f"{other:.4g}{_si(name)}, {said}",
                unit,
            )
    return found


def not_believed(clauses: Sequence[str], units: Mapping[str, str]) -> NotBelieved:
    """The error for the given motor: what is wrong, and how to name units."""
    named = ", ".join(f'{name} = "{unit}"' for name, unit in units.items())
    options = " ".join(f"--unit {name}={unit}" for name, unit in units.items())
    return NotBelieved(
        "The program's answer for the given motor",
        f"cannot be believed: {'; '.join(clauses)}",
        f"answer in SI, or name its units with `[evaluator] units = {{ {named} }}` or {options}; "
        "a result whose SI unit is named is taken as it is",
    )


def guessed_units(given: Sequence[Mapping[str, float]]) -> dict[str, str]:
    """Units in which impossible results would be possible; the SI unit where there is none."""
    found = {}
    for results in given:
        for name, value in results.items():
            low, high = POSSIBLE.get(name, (-math.inf, math.inf))
            if not low <= value <= high:
                found[name] = _unit_within(name, value, low, high) or si_units()[name]
    return found


def _likely_unit(name: str, ratio: float) -> str:
    """The unit in which a number so many times ours would be ours; empty when none would."""
    distances = {
        unit: abs(math.log10(ratio * factor_of(name, unit)))
        for unit in UNITS.get(si_units()[name], ())
    }
    unit = min(distances, key=lambda each: distances[each], default="")
    return unit if unit and distances[unit] < math.log10(NEAR) else ""


def _unit_within(name: str, value: float, low: float, high: float) -> str:
    units = UNITS.get(si_units()[name], ())
    return next((u for u in units if low <= value * factor_of(name, u) <= high), "")


def _si(name: str) -> str:
    unit = si_units()[name]
    return "" if unit == "1" else f" {unit}"


__all__ = [
    "Impossible",
    "NotBelieved",
    "doubts_about",
    "guessed_units",
    "not_believed",
    "require_possible",
]

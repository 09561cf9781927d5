"""Every result by its name: its unit in SI, and how people read it."""

from dataclasses import replace
from functools import cache
from typing import Any, get_args, get_type_hints

from camring.files.quantities import QUANTITIES, Quantity
from camring.metrics.summary import Metrics

_ASCII = str.maketrans({"·": ".", "²": "^2", "³": "^3"})


@cache
def si_units() -> dict[str, str]:
    """SI units of the results by name, as their annotations have them."""
    hints: dict[str, Any] = get_type_hints(Metrics, include_extras=True)
    return {name: str(get_args(hint)[1]) for name, hint in hints.items()}


@cache
def quantity(name: str) -> Quantity:
    """How a result is shown: as in every report, or in SI where no report shows it."""
    known = QUANTITIES.get(name)
    if known is not None:
        return known
    plain = QUANTITIES.get(name.removesuffix("_true_rms"))
    if plain is not None:
        label = f"{plain.label.removesuffix(', one-sided')}, true rms"
        return replace(plain, name=name, label=label)
    words = name.replace("_", " ")
    unit = si_units()[name]
    if unit == "Pa":
        return Quantity(name, f"{words[:1].upper()}{words[1:]}", "bar", 1e-5)
    if unit == "m":
        return Quantity(name, f"{words[:1].upper()}{words[1:]}", "mm", 1e3)
    return Quantity(name, f"{words[:1].upper()}{words[1:]}", "" if unit == "1" else unit, 1.0)


def result_names() -> tuple[str, ...]:
    """Every result there is, by its name of docs/theory.md section 10."""
    return tuple(si_units())


def plain_unit(unit: str) -> str:
    """A unit in letters that every spreadsheet reads: `cm^3/rev`, `N.m`; `1` for none."""
    return unit.translate(_ASCII) or "1"

"""The goal's limits against what designs do, in words and margins."""

from collections.abc import Sequence
from dataclasses import dataclass

from camring.interfaces.report.data import Constraint, Design
from camring.interfaces.report.quantities import QUANTITIES, Quantity, significant
from camring.interfaces.simulated import Simulated
from camring.objective.constraints import (
    BANDS,
    LOWER_LIMITS,
    UPPER_LIMITS,
    Constraints,
)
from camring.physics.system import System

__all__ = ["MARGIN_BASES", "constraints_of"]

MARGIN_BASES = (
    "A margin is a share of its limit; that of the lowest pressure a share of supply less return "
    "pressure, of the contact force a share of what that presses a piston with, of the chamber "
    "volume a share of the dead volume."
)


@dataclass(frozen=True)
class _Limit:
    """One limit: the result it bounds, from which side, and where."""

    result: str
    upper: bool
    bound: float


def _limits(constraints: Constraints, system: System) -> dict[str, _Limit]:
    """Every constraint that is set, by the name `violations` gives it."""
    least = constraints.min_pressure
    if least is None:
        least = float(system.fluid.vapour_pressure)
    found = {
        "min_pressure": _Limit("min_pressure", False, least),
        "chamber_volume": _Limit("min_volume", False, 0.0),
    }
    if constraints.min_contact_force is not None:
        force = float(constraints.min_contact_force)
        found["min_contact_force"] = _Limit("min_contact_force", False, force)
    for names, upper in ((UPPER_LIMITS, True), (LOWER_LIMITS, False)):
        for name, result in names.items():
            bound = getattr(constraints, name)
            if bound is not None:
                found[name] = _Limit(result, upper, float(bound))
    for name, (lowest, highest) in BANDS.items():
        band = getattr(constraints, name)
        if band is not None:
            found[f"{name}_low"] = _Limit(lowest, False, float(band[0]))
            found[f"{name}_high"] = _Limit(highest, True, float(band[1]))
    return found


def constraints_of(found: Sequence[Simulated], designs: Sequence[Design]) -> tuple[Constraint, ...]:
    """Each limit of the first motor's file with value and margin of every design.

    Values are the worst over the operating points. A limit that only some of the
    files set has no margin in the others.

    Parameters
    ----------
    found
        The simulations behind the designs, in the same order.
    """
    file = found[0].file
    rows = []
    for name, limit in _limits(file.goal.constraints, file.system).items():
        quantity = QUANTITIES.get(limit.result) or Quantity(limit.result, "", "", 1.0)
        pick = max if limit.upper else min
        worst = [pick(r.metrics[limit.result] for r in design.results) for design in designs]
        sense = "at most" if limit.upper else "at least"
        rows.append(
            Constraint(
                name,
                f"{sense} {quantity.value(limit.bound):.4g} {quantity.unit}".rstrip(),
                tuple(_written(quantity, value) for value in worst),
                tuple(-each.outcome.constraints.get(name, float("nan")) for each in found),
                limit.bound,
            )
        )
    return tuple(rows)


def _written(quantity: Quantity, value: float) -> str:
    return f"{significant(quantity.value(value), 4)} {quantity.unit}".rstrip()

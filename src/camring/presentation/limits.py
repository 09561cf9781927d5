"""The goal's limits against what designs do, in words and margins."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from camring.analyses.simulation import Simulated
from camring.files.motor import MotorFile
from camring.files.quantities import QUANTITIES, Quantity, significant
from camring.objective.constraints import (
    BANDS,
    LOWER_LIMITS,
    OF_ALL_LOBES,
    UPPER_LIMITS,
    Constraints,
)
from camring.physics.system import System
from camring.presentation.records import Constraint, Design

__all__ = ["MARGIN_BASES", "constraints_of"]

MARGIN_BASES = (
    "A margin is a share of its limit; that of the lowest pressure a share of supply less return "
    "pressure, of the contact force a share of what that presses a piston with, of the chamber "
    "volume a share of the dead volume."
)


@dataclass(frozen=True)
class Limit:
    """One limit: the result it bounds, from which side, and where."""

    result: str
    upper: bool
    bound: float


def limits_set(constraints: Constraints, system: System) -> dict[str, Limit]:
    """Every constraint that is set, by the name `violations` gives it."""
    least = constraints.min_pressure
    if least is None:
        least = float(system.fluid.vapour_pressure)
    found = {
        "min_pressure": Limit("min_pressure", False, least),
        "chamber_volume": Limit("min_volume", False, 0.0),
    }
    if constraints.min_contact_force is not None:
        force = float(constraints.min_contact_force)
        found["min_contact_force"] = Limit("min_contact_force", False, force)
    for names, upper in ((UPPER_LIMITS, True), (LOWER_LIMITS, False)):
        for name, result in names.items():
            bound = getattr(constraints, name)
            if bound is not None:
                found[name] = Limit(result, upper, float(bound))
    for name, (lowest, highest) in BANDS.items():
        band = getattr(constraints, name)
        if band is not None:
            found[f"{name}_low"] = Limit(lowest, False, float(band[0]))
            found[f"{name}_high"] = Limit(highest, True, float(band[1]))
    return found


def constraints_of(found: Sequence[Simulated], designs: Sequence[Design]) -> tuple[Constraint, ...]:
    """Each limit of the first motor's file with value and margin of every design.

    Values are the worst over the operating points, of the band of displacement over those
    that run on all lobes: nothing is asked of the others. A limit that only some of the
    files set has no margin in the others.

    Parameters
    ----------
    found
        The simulations behind the designs, in the same order.
    """
    file = found[0].file
    rows = []
    for name, limit in limits_set(file.goal.constraints, file.system).items():
        quantity = QUANTITIES.get(limit.result) or Quantity(limit.result, "", "", 1.0)
        pick = max if limit.upper else min
        asked = [_asked(name, each.file, d) for each, d in zip(found, designs, strict=True)]
        if not any(asked):
            continue
        worst = [
            pick(values, default=float("nan"))
            for values in (
                [result.metrics[limit.result] for result in results] for results in asked
            )
        ]
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


def _asked(name: str, file: MotorFile, design: Design) -> list[Any]:
    """Of the operating points that a limit asks something of, the results."""
    of_all_lobes = name.startswith(OF_ALL_LOBES)
    points = zip(file.system.operating_points, design.results, strict=True)
    return [result for point, result in points if not (of_all_lobes and point.idle_lobes)]


def _written(quantity: Quantity, value: float) -> str:
    return f"{significant(quantity.value(value), 4)} {quantity.unit}".rstrip()

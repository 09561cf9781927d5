"""Which law of a motor is missing, by the shape of what a fit leaves over.

Losses have few shapes over speed, pressure and viscosity: torque is lost with the load, with speed
times viscosity, with the square of speed, and more at rest than in motion; flow with pressure
over viscosity, with pressure alone, and with speed times pressure. What is left of a fit is at
right angles to all that its numbers can do, so that a shape is compared as far as it is, too.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from camring.files.motor.entries import Number
from camring.files.motor.keys import key_map
from camring.fitting.constants import AbstractFit
from camring.fitting.measurements.operating_points import operating_points_of
from camring.objective.design_space import leaf

EXPLAINED = 0.7  # share of the squares left, from which a shape is named
FEWEST = 10  # values; chance gives fewer a shape
OWN = 0.02  # share of a shape that the fitted numbers must leave, or they have it already

Rows = Float[np.ndarray, " value"]


class Conditions(NamedTuple):
    """Of each value: speed, pressure drop, kinematic viscosity; SI."""

    speed: Rows
    drop: Rows
    viscosity: Rows


@dataclass(frozen=True)
class Shape:
    """How one kind of loss goes over the rows.

    Attributes
    ----------
    keys
        Numbers of the motor file that give it; one that the motor has can be fitted.
    law
        What to put into a motor file that has none of them.
    """

    words: str
    of: Callable[[Conditions], Rows]
    keys: tuple[str, ...]
    law: str


OF_TORQUE = (
    Shape(
        "the square of the speed",
        lambda at: at.speed**2,
        ("motor.churning.moment_coefficient",),
        "[motor.churning] has that law",
    ),
    Shape(
        "speed times viscosity",
        lambda at: at.speed * at.viscosity,
        ("motor.gap.clearance",),
        "the film of [motor.gap] has that law",
    ),
    Shape("the speed", lambda at: at.speed, ("motor.viscous_damping",), "viscous_damping is that"),
    Shape(
        "the pressure",
        lambda at: at.drop,
        ("motor.roller.friction", "motor.side_friction"),
        "the roller's friction is that",
    ),
    Shape(
        "pressure at low speed, as friction that is greater at rest",
        lambda at: at.drop * np.exp(-at.speed / (2 * np.min(at.speed))),
        ("motor.roller.static_friction", "motor.side_static_friction"),
        'friction = "stribeck" has that law',
    ),
)
OF_FLOW = (
    Shape(
        "pressure over viscosity",
        lambda at: at.drop / np.maximum(at.viscosity, 1e-12),
        ("motor.gap.clearance", "motor.valve_plate.gap", "motor.reference_viscosity"),
        'leakage = "viscous" has that law',
    ),
    Shape(
        "the pressure",
        lambda at: at.drop,
        ("motor.leakage_coefficient",),
        "a leakage coefficient is that",
    ),
    Shape(
        "speed times pressure",
        lambda at: at.drop * at.speed,
        ("fluid.bulk_modulus",),
        "the oil's compression is that: look at dead_volume and bulk_modulus",
    ),
)
SHAPES = {"mean_torque": OF_TORQUE, "supply_flow": OF_FLOW, "case_drain": OF_FLOW[:2]}


def missing_law(found: AbstractFit, result: str) -> str:
    """What the rest of a result goes with, and which law has that; empty where no shape fits."""
    here = found.of(result)
    shapes = SHAPES.get(result, ())
    left = (found.modelled - found.measured)[here]
    conditions = _conditions(found, here)
    weights = 1 / found.deviation[here]
    able = found.squares.slopes[here][:, found.squares.free] * weights[:, None]
    best, share = None, EXPLAINED
    fitted = {number.key for number in found.numbers}
    for shape in shapes:
        if fitted & set(shape.keys):
            continue
        explained = _explained(left * weights, shape.of(conditions) * weights, able)
        if explained > share:
            best, share = shape, explained
    if best is None or np.sum(here) < FEWEST:
        return ""
    return f"{100 * share:.0f} % of it goes with {best.words}, and {_way_out(found, best)}"


def _explained(left: Rows, shape: Rows, able: Float[np.ndarray, "value number"]) -> float:
    """Share of the squares left that a shape explains beside what the numbers can do."""
    beside = shape - able @ np.linalg.lstsq(able, shape, rcond=None)[0]
    rest = left - able @ np.linalg.lstsq(able, left, rcond=None)[0]
    if np.sum(beside**2) <= OWN**2 * np.sum(shape**2) or not np.any(rest):
        return 0.0
    return float((rest @ beside) ** 2 / (np.sum(rest**2) * np.sum(beside**2)))


def _way_out(found: AbstractFit, shape: Shape) -> str:
    had = [key for key in shape.keys if _has(found, key)]
    if had:
        return f"{had[0]} is kept as given: fit it too, with --of"
    return f"nothing of this motor does so: {shape.law}"


def _has(found: AbstractFit, key: str) -> bool:
    entry = key_map(found.file.choices).get(key)
    if not isinstance(entry, Number) or not entry.leaves:
        return False
    try:
        leaf(entry.leaves[0])(found.file.system)
    except AttributeError:
        return False
    return True


def _conditions(found: AbstractFit, here: np.ndarray) -> Conditions:
    rows = found.rows[here]
    each = operating_points_of(found.file, found.table)
    numbers = [(float(p.shaft_speed), float(p.pressure_drop), float(f.viscosity)) for p, f in each]
    return Conditions(*np.array(numbers)[rows].T)

"""Which way each slider cuts which result, and what it does to the limits: exact slopes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import jax
import numpy as np

from camring.metrics.shown import METRICS
from camring.objective.constraints import Constraints, at_point
from camring.objective.objective import Goal
from camring.physics.system import System
from camring.programs.compiled import slopes_along
from camring.studio.evaluation import Evaluated, named

STEP_WORDS = "a hundredth of its slider"
WANTED = ("torque_ripple", "efficiency", "max_contact_stress", "displacement", "pressure_ripple")


@dataclass(frozen=True, eq=False)
class Direction:
    """One slider, or one handle of the cam: what it moves, and by how much counts as one step."""

    path: str
    leaves: tuple[int, ...]
    change: tuple[np.ndarray, ...]


@dataclass(frozen=True, eq=False)
class Arrows:
    """Change for one step of each direction, SI: of results at one operating point (result,
    direction), and of the worst `g` of each limit (limit, direction)."""

    paths: tuple[str, ...]
    results: np.ndarray
    limits: Mapping[str, np.ndarray]


def arrows_of(design: Evaluated, goal: Goal, directions: Sequence[Direction], point: int) -> Arrows:
    """Slopes of a solved design; nothing is solved again."""
    leaves, structure = jax.tree.flatten(design.system)
    stacked = [np.zeros((len(directions), *np.shape(leaf))) for leaf in leaves]
    for row, each in enumerate(directions):
        for at, change in zip(each.leaves, each.change, strict=True):
            stacked[at][row] = change
    along = jax.tree.unflatten(structure, stacked)
    names = tuple(dict.fromkeys([*WANTED, *goal.constraints.results_used()]))
    found = [
        {name: np.asarray(slope) for name, slope in each.items()}
        for each in jax.device_get(
            [
                slopes_along(cycle, along, at, names, goal.harmonics)
                for cycle, at in zip(design.cycles, along.operating_points, strict=True)
            ]
        )
    ]
    return Arrows(
        tuple(each.path for each in directions),
        np.stack([found[point][name] for name in WANTED]),
        _limits(design, goal.constraints, found, len(directions)),
    )


def _limits(
    design: Evaluated,
    constraints: Constraints,
    slopes: list[dict[str, np.ndarray]],
    count: int,
) -> dict[str, np.ndarray]:
    """A limit is a straight line in the results, so two of its values give its slope."""
    system: System = design.system
    per_point: list[tuple[dict[str, Any], dict[str, Any]]] = []
    for at, row, slope in zip(system.operating_points, design.results, slopes, strict=True):
        drop: Any = float(at.supply_pressure) - float(at.return_pressure)
        moved = {name: row[k] + slope.get(name, np.zeros(count)) for k, name in enumerate(METRICS)}
        values = named([moved[name] for name in METRICS])
        here, there = (
            at_point(constraints, system, drop, each, bool(at.idle_lobes))
            for each in (named(row), values)
        )
        per_point.append((here, there))
    found = {}
    for name in constraints.names():
        worst = max(per_point, key=lambda each: float(each[0][name]))
        with np.errstate(invalid="ignore"):  # of what has no bounds there is no slope
            change = np.asarray(worst[1][name]) - float(worst[0][name])
        found[name] = np.broadcast_to(change, (count,))
    return found

"""A design at its operating points: results, margins, and what the pictures are drawn from."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import jax.numpy as jnp
import numpy as np

from camring.metrics.shown import METRICS, ORDERS, Waves, sample_count, seen
from camring.numerics.verdict import Verdict
from camring.objective.constraints import Constraints, at_point
from camring.objective.objective import Goal
from camring.physics.cycle import Cycle
from camring.physics.heat import simulation
from camring.physics.motor import Motor
from camring.physics.resolution import Resolution
from camring.physics.rotation import in_mode, turned
from camring.physics.system import System
from camring.programs.kept_program import KeptProgram

# Without the detour of `motor_program`: motors that come here have no name.
simulated = KeptProgram(simulation.simulate)
seen_of = KeptProgram(seen)

SHAPE, FILLED = replace(Resolution(), filled=1.0), jnp.asarray(1.0)
"""The final resolution, as `programs.compiled.simulate` asks for it: one program for both."""


@dataclass(frozen=True, eq=False)
class Evaluated:
    """One design.

    Attributes
    ----------
    cycles
        The solution at each operating point; none where the hand was followed (`following`).
    waves
        For each operating point what the pictures show.
    results
        SI, (operating point, metric) in the order of `METRICS`.
    limits
        Each `g`, worst over the operating points; kept when at most 0.
    fault
        Why the numbers mean nothing; empty when they do.
    """

    system: System
    cycles: tuple[Cycle, ...]
    waves: tuple[Waves, ...]
    results: np.ndarray
    limits: Mapping[str, float]
    fault: str


def evaluated(system: System, goal: Goal) -> Evaluated:
    """A design, whose motor has no name, at final resolution at every operating point."""
    motor = system.motor
    angle = jnp.asarray(_angles(shown_repeats(system), motor.lobes))
    order = highest_order(motor, goal.harmonics)
    cycles, found = [], []
    for point in system.operating_points:
        cycle = simulated(turned(motor, point), system.fluid, point, SHAPE, FILLED)
        cycles.append(cycle)
        found.append(seen_of(cycle, angle, goal.harmonics, order))
    rows = np.stack([np.asarray(each.row) for each in found])
    results = rows[:, :-1]
    return Evaluated(
        system,
        tuple(cycles),
        tuple(each.waves for each in found),
        results,
        limits_of(system, goal.constraints, results),
        faults_in(rows[:, -1]),
    )


def shown_repeats(system: System) -> int:
    """How often what the pictures show repeats in a revolution; a pattern of idle lobes seldom."""
    points = system.operating_points
    return min(in_mode(system.motor, each.idle_lobes).cam.repeats for each in points)


def highest_order(motor: Motor, harmonics: int) -> int:
    """Of the shaft, up to which orders are looked at."""
    return max(harmonics, ORDERS * motor.surviving_order)


def faults_in(codes: np.ndarray) -> str:
    """What the verdicts of the operating points say, each sentence once."""
    found = [Verdict(jnp.asarray(code)).explain() for code in codes.astype(int) if code]
    return "; ".join(dict.fromkeys(found))


def pictures(design: Evaluated, point: int) -> dict[str, np.ndarray]:
    """What the pictures show of one operating point."""
    return {name: np.asarray(each) for name, each in design.waves[point]._asdict().items()}


def _angles(repeats: int, lobes: int) -> np.ndarray:
    """One period of the cam with both ends, the last a hair early: in this period still."""
    angle = np.linspace(0.0, 2 * math.pi / repeats, sample_count(lobes // repeats))
    angle[-1] *= 1 - 1e-9
    return angle


def limits_of(system: System, constraints: Constraints, results: np.ndarray) -> dict[str, float]:
    """Each limit's `g`, the worst over the operating points."""
    each = []
    for point, row in zip(system.operating_points, results, strict=True):
        drop: Any = float(point.supply_pressure) - float(point.return_pressure)
        each.append(at_point(constraints, system, drop, named(row), bool(point.idle_lobes)))
    return {name: max(_worst(found[name]) for found in each) for name in constraints.names()}


def named(row: Sequence[float] | np.ndarray) -> Any:
    """Results by name, as the laws of limits read them."""
    return SimpleNamespace(**dict(zip(METRICS, row, strict=True)))


def _worst(value: Any) -> float:
    found = float(value)
    return math.inf if math.isnan(found) else found

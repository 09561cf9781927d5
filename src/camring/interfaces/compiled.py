"""The programs that every command shares, each compiled once and kept between runs.

Simulation is by far the dearest to compile; held apart from what is done with
its result, it is the same program for every operating point, command and study
of motors with the same counts.
"""

import equinox as eqx
import jax.numpy as jnp

from camring.metrics.summary import summarise
from camring.objective.objective import Assessment, Goal, judge
from camring.physics.cycle import Cycle, simulate
from camring.physics.resolution import Resolution
from camring.physics.system import System

simulate_compiled = eqx.filter_jit(simulate)
summarise_compiled = eqx.filter_jit(summarise)
_judge = eqx.filter_jit(judge)


def cycles(system: System, resolution: Resolution | None = None) -> tuple[Cycle, ...]:
    """One cycle for each operating point."""
    resolution = resolution or Resolution()
    return tuple(
        simulate_compiled(system.motor, system.fluid, point, resolution)
        for point in system.operating_points
    )


def assess(system: System, goal: Goal, resolution: Resolution | None = None) -> Assessment:
    """`camring.objective.objective.evaluate` from the shared programs; same numbers."""
    found = cycles(system, resolution)
    metrics = tuple(summarise_compiled(cycle, goal.harmonics) for cycle in found)
    return _judge(system, goal, metrics, jnp.stack([cycle.verdict.code for cycle in found]))

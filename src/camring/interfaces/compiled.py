"""The programs that every command shares, each compiled once and kept between runs.

Simulation is by far the dearest to compile; held apart from what is done with
its result, it is the same program for every operating point, command and study
of motors with the same counts.
"""

import equinox as eqx
import jax.numpy as jnp

from camring.metrics import summary
from camring.numerics.quantity import ArrayLike
from camring.objective.design_space import DesignSpace
from camring.objective.objective import Assessment, Goal, judge
from camring.objective.slopes import (
    Operated,
    Slopes,
    directions,
    judged_slopes,
    result_slopes,
    results_used,
)
from camring.physics import cycle
from camring.physics import waveforms as sampling
from camring.physics.cycle import Cycle
from camring.physics.resolution import Resolution
from camring.physics.system import System

# The short names are those under which `import camring` offers them.
simulate = simulate_compiled = eqx.filter_jit(cycle.simulate)
summarise = summarise_compiled = eqx.filter_jit(summary.summarise)
waveforms = eqx.filter_jit(sampling.waveforms)
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
    metrics = tuple(summarise_compiled(each, goal.harmonics) for each in found)
    return _judge(system, goal, metrics, jnp.stack([each.verdict.code for each in found]))


evaluate = assess

_directions = eqx.filter_jit(directions)
_result_slopes = eqx.filter_jit(result_slopes)
_judged_slopes = eqx.filter_jit(judged_slopes)


def slopes(
    space: DesignSpace, given: System, unit_point: ArrayLike, design: System, goal: Goal
) -> Slopes:
    """Derivatives of objective and constraints of a design by its unit coordinates.

    Parameters
    ----------
    given, design
        The system that the space belongs to, and that of the point.
    """
    along = _directions(space, given, unit_point)
    found, names = cycles(design), results_used(goal)
    metrics = tuple(summarise_compiled(each, goal.harmonics) for each in found)
    of_results = [
        _result_slopes(each, Operated(along.motor, along.fluid, point), names, goal.harmonics)
        for each, point in zip(found, along.operating_points, strict=True)
    ]
    return _judged_slopes(design, goal, metrics, along, of_results)

"""The programs that every command shares, each compiled once and kept between runs.

Simulation is by far the dearest to compile; held apart from what is done with
its result, it is the same program for every operating point, command and study
of motors with the same counts.
"""

import equinox as eqx
import jax.numpy as jnp

from camring.metrics import summary
from camring.objective.objective import Assessment, Goal, judge
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

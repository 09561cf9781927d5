"""The programs that every command shares, each compiled once and kept between runs.

Simulation is by far the dearest to compile; held apart from what is done with
its result, it is the same program for every operating point, command and study
of motors with the same counts.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.interfaces.motor_program import motor_program, named
from camring.metrics import summary
from camring.metrics.accuracy import Accurate, Look, climb
from camring.metrics.summary import Metrics
from camring.numerics.quantity import ArrayLike
from camring.objective.design_space import AbstractSpace
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
from camring.physics.fluid import AbstractFluid
from camring.physics.motor import Motor
from camring.physics.operating_point import OperatingPoint
from camring.physics.resolution import Resolution
from camring.physics.rotation import turned
from camring.physics.system import System

# The short names are those under which `import camring` offers them.
_simulate = motor_program(cycle.simulate)
summarise = summarise_compiled = motor_program(summary.summarise)
waveforms = motor_program(sampling.waveforms)
_judge = motor_program(judge)


def simulate(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    resolution: Resolution | None = None,
) -> Cycle:
    """`camring.physics.cycle.simulate`, compiled: one program for both directions."""
    resolution = resolution or Resolution()
    shape, filled = replace(resolution, filled=1.0), jnp.asarray(resolution.filled)
    found = _simulate(turned(motor, point), fluid, point, shape, filled)
    return named(found, motor.name)


simulate_compiled = simulate


def cycles(system: System, resolution: Resolution | None = None) -> tuple[Cycle, ...]:
    """One cycle for each operating point."""
    resolution = resolution or Resolution()
    return tuple(
        simulate_compiled(system.motor, system.fluid, point, resolution)
        for point in system.operating_points
    )


def simulate_to(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    accuracy: float = 1e-5,
    highest_order: int = 600,
) -> Accurate:
    """The cycle and its results, looked at finely enough that each is within an accuracy.

    Climbs `Resolution.ladder()`: an ordinary motor stays on its first rung for 1e-5.
    Whether the accuracy was reached is in `reached`; see `metrics.accuracy`.

    Parameters
    ----------
    accuracy
        Estimated error allowed in each result of model.md section 10, relative.
    highest_order
        Of the sums in ripples, counted per revolution.
    """

    def look(resolution: Resolution) -> Look:
        found = simulate_compiled(motor, fluid, point, resolution)
        return Look(found, summarise_compiled(found, highest_order))

    return climb(look, accuracy)


@dataclass(frozen=True, eq=False)
class Solved:
    """A design with its cycles and their results, one of each for each operating point."""

    system: System
    cycles: tuple[Cycle, ...]
    metrics: tuple[Metrics, ...]


def solve(system: System, goal: Goal, resolution: Resolution | None = None) -> Solved:
    """Every operating point simulated and summarised."""
    found = cycles(system, resolution)
    return Solved(system, found, tuple(summarise_compiled(each, goal.harmonics) for each in found))


def judge_solved(solved: Solved, goal: Goal) -> Assessment:
    """What a goal says of a design at hand."""
    faults = jnp.stack([each.verdict.code for each in solved.cycles])
    return _judge(solved.system, goal, solved.metrics, faults)


def judge_metrics(system: System, goal: Goal, metrics: tuple[Metrics, ...]) -> Assessment:
    """What a goal says of results from elsewhere, taken as sound."""
    return _judge(system, goal, metrics, jnp.zeros(len(metrics), int))


def assess(system: System, goal: Goal, resolution: Resolution | None = None) -> Assessment:
    """`camring.objective.objective.evaluate` from the shared programs; same numbers."""
    return judge_solved(solve(system, goal, resolution), goal)


evaluate = assess

_directions = motor_program(directions)
_result_slopes = motor_program(result_slopes)
_judged_slopes = motor_program(judged_slopes)


def slopes(
    space: AbstractSpace, given: System, unit_point: ArrayLike, design: Solved, goal: Goal
) -> Slopes:
    """Derivatives of objective and constraints of a design by its unit coordinates.

    Parameters
    ----------
    given
        The system that the space belongs to.
    design
        What was solved at the point; nothing is solved again.
    """
    return slopes_with_results(space, given, unit_point, design, goal)[0]


def slopes_with_results(
    space: AbstractSpace,
    given: System,
    unit_point: ArrayLike,
    design: Solved,
    goal: Goal,
    results: Sequence[str] = (),
) -> tuple[Slopes, list[dict[str, Float[Array, " coordinate"]]]]:
    """`slopes`, and at each operating point those of the results used and of some more."""
    along = _directions(space, given, unit_point)
    names = tuple(dict.fromkeys([*results_used(goal), *results]))
    of_results = [
        _result_slopes(each, _operated(along, point), names, goal.harmonics)
        for each, point in zip(design.cycles, along.operating_points, strict=True)
    ]
    used = [{name: found[name] for name in results_used(goal)} for found in of_results]
    return _judged_slopes(design.system, goal, design.metrics, along, used), of_results


def _operated(along: System, point: OperatingPoint) -> Operated:
    """Directions of change as an operating point turns the motor."""
    motor = (
        jax.vmap(lambda each: turned(each, point))(along.motor) if point.reverse else along.motor
    )
    return Operated(motor, along.fluid, point)

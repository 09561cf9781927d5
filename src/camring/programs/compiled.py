"""The programs that every command shares, each compiled once and kept between runs.

Simulation is by far the most expensive to compile; held apart from what is done with
its result, it is the same program for every operating point, command and study
of motors with the same counts.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import Future
from dataclasses import dataclass, replace
from typing import cast

import jax
import numpy as np
from jaxtyping import Array, Float

from camring.metrics import summary
from camring.metrics.accuracy import Accurate, Solution, climb
from camring.metrics.summary import Metrics
from camring.numerics.quantity import ArrayLike
from camring.objective.design_space import AbstractSpace
from camring.objective.objective import Assessment, Goal, assessment_of
from camring.objective.slopes import (
    Operated,
    Slopes,
    assessed_slopes,
    directions,
    result_slopes,
    results_used,
)
from camring.physics.cycle import Cycle
from camring.physics.heat import simulation
from camring.physics.motor import Motor
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint
from camring.physics.resolution import Resolution
from camring.physics.rotation import turned
from camring.physics.system import System
from camring.physics.waves import waveforms as sampling
from camring.programs.motor_program import begin, motor_program, named

# `camring.api` offers these to `import camring`.
_simulate = motor_program(simulation.simulate)
summarise = summarise_compiled = motor_program(summary.summarise)
waveforms = motor_program(sampling.waveforms)
_assessment_of = motor_program(assessment_of)


def simulate(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    resolution: Resolution | None = None,
) -> Cycle:
    """`camring.physics.heat.simulation.simulate`, compiled: one program for both directions."""
    resolution = resolution or Resolution()
    shape, filled = replace(resolution, filled=1.0), cast(Array, np.asarray(resolution.filled))
    found = _simulate(turned(motor, point), fluid, point, shape, filled)
    return named(found, motor.name)


simulate_compiled = simulate


def begin_simulation(system: System, highest_order: int, then: Callable[[], None]) -> None:
    """Compiles what simulates and what summarises beside each other, where that never was done.

    `simulate` and `summarise` then find them, or wait. What else can be begun is `then`.
    """
    motor, point, shape = system.motor, system.operating_points[0], Resolution()
    filled = cast(Array, np.asarray(shape.filled))
    cycle = begin(_simulate, turned(motor, point), system.fluid, point, shape, filled)

    def go_on(found: "Future[Cycle]") -> None:
        if not found.cancelled():
            begin(summarise, found.result(), highest_order).add_done_callback(lambda _: then())

    cycle.add_done_callback(go_on)


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
    """The cycle and its results on a mesh fine enough that each is within an accuracy.

    Climbs `Resolution.ladder()`: an ordinary motor stays on its first mesh for 1e-5.
    Whether the accuracy was reached is in `reached`; see `metrics.accuracy`.

    Parameters
    ----------
    accuracy
        Estimated error allowed in each result of docs/theory.md section 10, relative.
    highest_order
        Of the sums in ripples, counted per revolution.

    Returns
    -------
    Cycle, results, the estimated absolute error of each, and the resolution. Nothing is raised
    where the accuracy is out of reach: `reached` is False, and `worst_result` names where.

    Examples
    --------
    >>> system = camring.read_motor_file("motor.toml").system
    >>> found = camring.simulate_to(system.motor, system.fluid, system.operating_points[0])
    >>> found.reached, found.elements, found.largest_error < 1e-5
    (True, 320, True)
    """

    def solution_at(resolution: Resolution) -> Solution:
        found = simulate_compiled(motor, fluid, point, resolution)
        return Solution(found, summarise_compiled(found, highest_order))

    return climb(solution_at, accuracy)


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


def assess_solved(solved: Solved, goal: Goal) -> Assessment:
    """What a goal says of a design at hand."""
    faults = cast(Array, np.stack([each.verdict.code for each in solved.cycles]))
    return _assessment_of(solved.system, goal, solved.metrics, faults)


def assess_metrics(system: System, goal: Goal, metrics: tuple[Metrics, ...]) -> Assessment:
    """What a goal says of results from elsewhere, taken as sound."""
    sound = cast(Array, np.zeros(len(metrics), int))
    return _assessment_of(system, goal, metrics, sound)


def assess(system: System, goal: Goal, resolution: Resolution | None = None) -> Assessment:
    """Simulate every operating point, and weigh the results by a goal.

    Parameters
    ----------
    system, goal
        As a motor file has them.
    resolution
        Of the mesh; final results unless given.

    Returns
    -------
    Objective, its raw terms for each operating point, each limit's `g` (kept when at most 0),
    results for each operating point, and faults, zero where it is sound. One motor that cannot
    be simulated raises nothing: its fault says why, its numbers mean nothing.

    Examples
    --------
    >>> file = camring.read_motor_file("motor.toml")
    >>> found = camring.evaluate(file.system, file.goal)
    >>> round(float(found.objective), 4), sorted(found.constraints)
    (0.14, ['chamber_volume', 'min_pressure'])

    Notes
    -----
    The same numbers as the traceable `camring.objective.objective.evaluate`, docs/theory.md
    section 8, from compiled programs that all motors of the same counts and laws share.
    """
    return assess_solved(solve(system, goal, resolution), goal)


evaluate = assess

_directions = motor_program(directions)
_result_slopes = motor_program(result_slopes)
_assessed_slopes = motor_program(assessed_slopes)


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
        slopes_along(each, along, point, names, goal.harmonics)
        for each, point in zip(design.cycles, along.operating_points, strict=True)
    ]
    used = [{name: found[name] for name in results_used(goal)} for found in of_results]
    return _assessed_slopes(design.system, goal, design.metrics, along, used), of_results


def slopes_along(
    cycle: Cycle, along: System, point: OperatingPoint, results: Sequence[str], harmonics: int
) -> dict[str, Float[Array, " direction"]]:
    """`objective.slopes.result_slopes` of one cycle.

    Parameters
    ----------
    along, point
        Directions of change, leaves (direction, ...), and those of the cycle's own point.
    """
    return _result_slopes(cycle, _operated(along, point), tuple(results), harmonics)


def _operated(along: System, point: OperatingPoint) -> Operated:
    """Directions of change as an operating point turns the motor."""
    as_given = not point.reverse and not point.idle_lobes
    motor = along.motor if as_given else jax.vmap(lambda each: turned(each, point))(along.motor)
    return Operated(motor, along.fluid, point)

"""The motor of a file, simulated and judged: what `simulate` and `check` print."""

from dataclasses import dataclass, replace
from math import degrees
from typing import Any

import jax
import numpy as np

from camring.interfaces.compiled import (
    Solved,
    judge_solved,
    simulate_compiled,
    solve,
    summarise_compiled,
)
from camring.interfaces.config import MotorFile
from camring.interfaces.crowding import crowded
from camring.interfaces.evaluator import outcome_of
from camring.interfaces.motor_program import motor_program
from camring.interfaces.record import Outcome
from camring.metrics.accuracy import Accurate, Look, climb
from camring.metrics.summary import Metrics
from camring.metrics.timing import Timing, port_timing
from camring.physics.cycle import Cycle
from camring.physics.operating_point import OperatingPoint
from camring.physics.resolution import Resolution
from camring.physics.rotation import turned

ACCURACY = 1e-5
POOR = 0.5  # an efficiency below which no motor is meant to work


@dataclass(frozen=True, eq=False)
class Simulated:
    """A motor file, what the simulation says of it, and how far that can be trusted.

    Attributes
    ----------
    outcome
        Results and constraints; with a sentence in `failure` when they mean nothing.
    cycles
        One for each operating point.
    errors
        Estimated absolute error of each result, SI, for each operating point.
    climbed
        For each operating point the rung on which the wanted accuracy was found, or
        the last; empty where no error was estimated.
    """

    file: MotorFile
    outcome: Outcome
    cycles: tuple[Cycle, ...]
    errors: tuple[dict[str, float], ...] = ()
    climbed: tuple[Accurate, ...] = ()

    @property
    def numerical_error(self) -> tuple[float, ...]:
        """For each operating point the largest error of any result, relative."""
        return tuple(each.largest_error for each in self.climbed)

    @property
    def broken(self) -> dict[str, float]:
        """Constraints that do not hold, and by how much."""
        return {name: g for name, g in self.outcome.constraints.items() if not g <= 0}

    def warnings(self) -> list[str]:
        """What a reader of the results should know, a sentence each."""
        found = [self.outcome.failure] if self.outcome.failure else []
        several = len(self.outcome.results) > 1
        for place, results in enumerate(self.outcome.results):
            where = f" at operating point {place + 1}" if several else ""
            found += [sentence.format(where) for sentence in _about(results, self.file)]
            if self.climbed and not self.outcome.failure:
                found += [each.format(where) for each in _short_of(self.climbed[place])]
        for gap, side in zip(_gaps(timing_of(self.file)), ("inner", "outer"), strict=True):
            if gap < -1e-9:
                found.append(
                    f"Supply and return windows overlap by {-degrees(gap):.3g} deg at the "
                    f"{side} dead centre: the ports short-circuit there."
                )
        if self.outcome.results:
            lowest = self.outcome.results[0]["min_lift"]
            inner = float(self.cycles[0].reference_radius) + lowest
            found += crowded(self.file.system.motor, inner)
        # An undercut is the same at every operating point.
        return list(dict.fromkeys(found))


def simulated(file: MotorFile, *, estimate: bool = True, accuracy: float = ACCURACY) -> Simulated:
    """Simulate a motor at every operating point and judge it by its constraints.

    Parameters
    ----------
    estimate
        Whether to look a second time at a coarser resolution for the error, and more
        finely where it is larger than wanted.
    accuracy
        Wanted of each result, relative.
    """
    system, goal = file.system, file.goal
    if not estimate:
        return _judged(file, solve(system, goal))
    climbed = []
    for point in system.operating_points:

        def look(resolution: Resolution, at: OperatingPoint = point) -> Look:
            cycle = simulate_compiled(system.motor, system.fluid, at, resolution)
            return Look(cycle, summarise_compiled(cycle, goal.harmonics))

        climbed.append(climb(look, accuracy))
    cycles = tuple(each.cycle for each in climbed)
    found = _judged(file, Solved(system, cycles, tuple(each.metrics for each in climbed)))
    errors = tuple(_plain(each.error) for each in climbed)
    return replace(found, errors=errors, climbed=tuple(climbed))


def _judged(file: MotorFile, solved: Solved) -> Simulated:
    outcome = outcome_of(judge_solved(solved, file.goal))
    if all(int(cycle.verdict.code) == 0 for cycle in solved.cycles):
        # An undercut's infinite stress spoils the objective, not the results.
        outcome = replace(outcome, failure=None)
    return Simulated(file, outcome, solved.cycles)


def _plain(metrics: Metrics) -> dict[str, float]:
    return {name: float(value) for name, value in vars(metrics).items()}


def _short_of(climbed: Accurate) -> list[str]:
    """What to say where the ladder ended before the accuracy, with a place for the point."""
    if climbed.reached:
        return []
    return [
        f"An accuracy of {climbed.accuracy:g} was not reached{{}}: the error of "
        f"{climbed.worst_result.replace('_', ' ')} is estimated at {climbed.largest_error:.1e} "
        f"with {climbed.resolution.elements} elements a lobe, the finest mesh; see `errors` in "
        "--json for every result."
    ]


def timing_of(file: MotorFile) -> Timing:
    """Port timing at the first operating point, in plain numbers."""
    system, point = file.system, file.system.operating_points[0]
    return jax.device_get(_port_timing(turned(system.motor, point), system.fluid, point))


_port_timing = motor_program(port_timing)


def _gaps(timing: Timing) -> tuple[float, float]:
    return float(timing.inner_gap), float(timing.outer_gap)


def _about(results: Any, file: MotorFile) -> list[str]:
    """Sentences with a place for the operating point."""
    said = []
    if results["min_undercut_factor"] <= 0:
        said.append(
            "The roller undercuts the ring: the undercut factor falls to "
            f"{results['min_undercut_factor']:.3g}, so no such ring can be ground and its "
            "contact stress means nothing; take a smaller roller or a smoother cam."
        )
    vapour = float(file.system.fluid.vapour_pressure)
    if results["min_pressure"] < vapour:
        said.append(
            f"The chamber pressure falls to {results['min_pressure'] / 1e5:.4g} bar{{}}, below "
            f"the vapour pressure of {vapour / 1e5:.3g} bar: the oil would cavitate."
        )
    if results["min_contact_force"] < 0:
        said.append(
            f"The roller leaves the ring{{}}: the radial force falls to "
            f"{results['min_contact_force']:.4g} N."
        )
    if results["mean_torque"] <= 0:
        said.append(
            f"The shaft is driven, it drives nothing{{}}: the mean torque is "
            f"{results['mean_torque']:.4g} N m; look at the timing."
        )
    elif not np.isfinite(results["efficiency"]) or not 0 < results["efficiency"] < 1:
        said.append("The motor delivers no sensible power{}: look at its timing.")
    elif results["efficiency"] < POOR:
        said.append(
            f"Only {100 * results['efficiency']:.2g} % of the hydraulic power reaches the "
            "shaft{}: check timing and leakage; no limit asks for efficiency."
        )
    return said

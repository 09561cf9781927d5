"""The motor of a file, simulated and assessed: what `simulate` and `check` print."""

from dataclasses import dataclass, replace
from functools import cached_property
from math import degrees
from typing import Any

import jax

from camring.analyses.file_notes import file_notes
from camring.analyses.oil_use import unread_viscosity
from camring.evaluation.assessed import outcome_of
from camring.evaluation.crowding import crowded
from camring.evaluation.outcome import Outcome
from camring.files.motor import MotorFile
from camring.files.ring_body import beyond_the_body
from camring.files.shapes.profile_like import seem_a_profile
from camring.metrics.accuracy import Accurate, Solution, climb
from camring.metrics.efficiency import BRAKE, PUMP, working_as
from camring.metrics.idle_drag import idle_drag
from camring.metrics.radial_load import RadialLoad, radial_load
from camring.metrics.starting import Starting, starting
from camring.metrics.summary import Metrics
from camring.metrics.timing import Timing, port_timing
from camring.physics.cycle import Cycle
from camring.physics.operating_point import OperatingPoint
from camring.physics.resolution import Resolution
from camring.physics.rotation import turned
from camring.physics.system import System
from camring.programs.compiled import (
    Solved,
    assess_solved,
    begin_simulation,
    simulate_compiled,
    solve,
    summarise_compiled,
)
from camring.programs.motor_program import begin, motor_program

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
        For each operating point the resolution at which the wanted accuracy was found, or
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

    @cached_property
    def starts(self) -> tuple[Starting, ...]:
        """Torque at standstill over the angle, under the pressures of each operating point."""
        system = self.file.system
        return tuple(
            _starting(system.motor, system.fluid, _forwards(point))
            for point in system.operating_points
        )

    @cached_property
    def idle_drags(self) -> tuple[float, ...]:
        """Mean torque that idle lobes take at each operating point, N m; zero without any."""
        return tuple(
            float(_idle_drag(cycle)) if cycle.motor.valve_plate.idle_lobes else 0.0
            for cycle in self.cycles
        )

    @cached_property
    def radial_loads(self) -> tuple[RadialLoad, ...]:
        """What all pistons press on shaft and ring at each operating point."""
        return tuple(jax.device_get(_radial_load(cycle)) for cycle in self.cycles)

    @property
    def greatest_radius(self) -> float:
        """Of the pitch curve, m; of a motor that has results."""
        return float(self.cycles[0].reference_radius) + self.outcome.results[0]["max_lift"]

    def warnings(self) -> list[str]:
        """What a reader of the results should know, a sentence each."""
        found = [self.outcome.failure] if self.outcome.failure else []
        several = len(self.outcome.results) > 1
        for place, results in enumerate(self.outcome.results):
            where = f" at operating point {place + 1}" if several else ""
            point = self.file.system.operating_points[place]
            found += [sentence.format(where) for sentence in _about(results, self.file, point)]
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
            found += beyond_the_body(self.file, self.greatest_radius)
        found += unread_viscosity(self.file)
        found += own_cam_notes(self.file)
        found += file_notes(self.file)
        # An undercut is the same at every operating point.
        return list(dict.fromkeys(found))


def simulated(file: MotorFile, *, estimate: bool = True, accuracy: float = ACCURACY) -> Simulated:
    """Simulate a motor at every operating point and assess it by its constraints.

    Parameters
    ----------
    estimate
        Whether to look a second time at a coarser resolution for the error, and more
        finely where it is larger than wanted.
    accuracy
        Wanted of each result, relative.
    """
    system, goal = file.system, file.goal
    _begin(system, goal.harmonics, with_starts=estimate)
    if not estimate:
        return _assessed(file, solve(system, goal))
    climbed = []
    for point in system.operating_points:

        def solution_at(resolution: Resolution, at: OperatingPoint = point) -> Solution:
            cycle = simulate_compiled(system.motor, system.fluid, at, resolution)
            return Solution(cycle, summarise_compiled(cycle, goal.harmonics))

        climbed.append(climb(solution_at, accuracy))
    cycles = tuple(each.cycle for each in climbed)
    found = _assessed(file, Solved(system, cycles, tuple(each.metrics for each in climbed)))
    errors = tuple(_plain(each.error) for each in climbed)
    return replace(found, errors=errors, climbed=tuple(climbed))


def _begin(system: System, harmonics: int, *, with_starts: bool) -> None:
    """Compiles beside each other the programs that are asked for one after the other."""
    motor, point = system.motor, system.operating_points[0]

    def then() -> None:
        if with_starts:
            begin(_starting, motor, system.fluid, _forwards(point))
        begin(_port_timing, turned(motor, point), system.fluid, point)

    begin_simulation(system, harmonics, then)


def _assessed(file: MotorFile, solved: Solved) -> Simulated:
    outcome = outcome_of(assess_solved(solved, file.goal))
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
        f"with {climbed.elements} elements a lobe, the finest mesh; see `errors` in "
        "--json for every result."
    ]


def own_cam_notes(file: MotorFile) -> list[str]:
    """What was taken for granted of a profile, or whether control radii seem to be one."""
    if file.fitted_cam is not None:
        return list(file.fitted_cam.notes)
    return seem_a_profile(file.system.motor.cam)


def timing_of(file: MotorFile) -> Timing:
    """Port timing at the first operating point, in plain numbers."""
    system, point = file.system, file.system.operating_points[0]
    return jax.device_get(_port_timing(turned(system.motor, point), system.fluid, point))


_port_timing = motor_program(port_timing)
_starting = motor_program(starting)
_idle_drag = motor_program(idle_drag)
_radial_load = motor_program(radial_load)


def _forwards(point: OperatingPoint) -> OperatingPoint:
    """Both directions of a start are of one program."""
    return replace(point, reverse=False)


def _gaps(timing: Timing) -> tuple[float, float]:
    return float(timing.inner_gap), float(timing.outer_gap)


def _about(results: Any, file: MotorFile, point: OperatingPoint) -> list[str]:
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
    if float(point.pressure_drop) < 0:
        return said + _about_braking(results, point)
    works_as = working_as(results["input_power"], results["output_power"])
    torque = f"the mean torque is {results['mean_torque']:.4g} N m"
    if works_as == PUMP:
        said.append(
            f"The shaft is driven and oil delivered{{}}: {torque}, and the efficiencies are those "
            "of a pump; if it shall be a motor, look at pressures and timing."
        )
    elif works_as == BRAKE:
        said.append(
            f"The shaft is driven and oil is taken, too{{}}: {torque}, so the machine brakes and "
            "a negative efficiency means nothing; if it shall be a motor, look at the timing."
        )
    elif results["mean_torque"] <= 0:
        said.append(f"The shaft drives nothing{{}}: {torque}; look at the timing.")
    elif not 0 < results["energy_efficiency"] < 1:
        said.append("The motor delivers no sensible power{}: look at its timing.")
    elif results["efficiency"] < POOR:
        said.append(
            f"Only {100 * results['efficiency']:.2g} % of the hydraulic power reaches the "
            "shaft{}: check timing and leakage; no limit asks for efficiency."
        )
    return said


def _about_braking(results: Any, point: OperatingPoint) -> list[str]:
    """The same where the return stands above the supply, so that the load is to drive."""
    said = []
    if float(point.case_pressure) >= float(point.return_pressure):
        said.append(
            f"The case stands at {float(point.case_pressure) / 1e5:.4g} bar{{}}, the pressure that "
            "is braked against, as it does unless case_pressure is given; rollers are pressed on "
            "only where the chamber is above the case: give case_pressure, that of its drain."
        )
    works_as = working_as(results["input_power"], results["output_power"])
    torque = f"the mean torque is {results['mean_torque']:.4g} N m"
    if works_as == BRAKE or (works_as == PUMP and results["port_power"] >= 0):
        said.append(
            f"No oil is delivered against the return pressure{{}}: {torque}, and all that the load "
            "gives is lost inside; its efficiencies mean nothing."
        )
    elif works_as != PUMP:
        said.append(
            f"The return is above the supply{{}}, but the machine drives its load: {torque}; look "
            "at pressures and timing."
        )
    elif results["port_efficiency"] < POOR:
        said.append(
            f"Only {100 * results['port_efficiency']:.2g} % of what the load gives comes out as "
            "hydraulic power{}: check timing and leakage."
        )
    return said

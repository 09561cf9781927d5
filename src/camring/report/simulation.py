"""From a system to what a report shows of it: simulate, sample, and turn into plain numbers."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Array

from camring.analyses.simulation import Simulated
from camring.geometry.cam import AbstractCam
from camring.geometry.contour import pitch_curvature, pressure_angle, undercut_factor
from camring.geometry.piston import Roller
from camring.geometry.valve_plate import ValvePlate
from camring.metrics.spectrum import order_spectrum
from camring.metrics.starting import Starting
from camring.numerics.quantity import real
from camring.physics.cycle import Cycle
from camring.physics.motor import Motor
from camring.physics.operating_point import OperatingPoint
from camring.physics.rotation import in_mode
from camring.physics.system import System
from camring.presentation.records import Design, Facts, Point, Profile, Result, Start, Waves
from camring.programs.compiled import cycles, summarise_compiled, waveforms
from camring.programs.motor_program import motor_program

__all__ = ["design_of", "facts_of", "results_of"]

SAMPLES_PER_LOBE = 1200
MOST_SAMPLES = 7200
HARMONICS = 600


def facts_of(motor: Motor) -> Facts:
    """The numbers of the hardware that pictures need."""
    return Facts(
        pistons=motor.pistons,
        lobes=motor.lobes,
        repeats=motor.cam.repeats,
        bore=float(motor.piston.bore),
        roller_radius=float(motor.roller.radius),
        surviving_order=motor.surviving_order,
        distinct_phases=motor.distinct_phases,
    )


def design_of(label: str, found: Simulated) -> Design:
    """One simulated motor as the report shows it."""
    motor, harmonics = _drawn(found.file.system), found.file.goal.harmonics
    angle = _angles(motor)
    errors = found.numerical_error if found.errors else (float("nan"),) * len(found.cycles)
    results = tuple(
        replace(_result(cycle, angle, harmonics, error), start=_start(start, cycle.point))
        for cycle, error, start in zip(found.cycles, errors, found.starts, strict=True)
    )
    return Design(label, facts_of(motor), _profile(motor, angle), results)


def _drawn(system: System) -> Motor:
    """The motor with its cam over the longest period of any of its modes."""
    motors = [in_mode(system.motor, point.idle_lobes) for point in system.operating_points]
    longest = min(motors, key=lambda each: each.cam.repeats)
    return replace(system.motor, cam=longest.cam)


def _angles(motor: Motor) -> np.ndarray:
    """One period of the cam with both ends."""
    pitches = motor.lobes // motor.cam.repeats
    count = min(SAMPLES_PER_LOBE * pitches, MOST_SAMPLES)
    return np.linspace(0.0, motor.cam.period, count + 1)


def _inside(angle: np.ndarray) -> Array:
    """The angles at which to read: the last a hair early, where this period's jerk still holds."""
    return real(np.append(angle[:-1], angle[-1] * (1 - 1e-9)))


def _profile(motor: Motor, angle: np.ndarray) -> Profile:
    return Profile(angle, *map(np.asarray, _shape(motor.cam, motor.roller, _inside(angle))))


@motor_program
def _shape(cam: AbstractCam, roller: Roller, angle: Array) -> tuple[Array, ...]:
    """Pitch radius, its slope, curvature of the pitch curve, pressure angle, undercut factor."""
    radius = cam.pitch_radius(angle)
    return (
        radius.value,
        radius.first,
        pitch_curvature(radius),
        pressure_angle(radius),
        undercut_factor(radius, roller.radius),
    )


@motor_program
def _openings(plate: ValvePlate, angle: Array) -> tuple[Array, Array]:
    """Of the supply's and of the return's port, shares of the area."""
    return plate.opening(plate.supply, angle), plate.opening(plate.return_, angle)


@motor_program
def _by_order(cycle: Cycle, highest_order: int) -> tuple[Array, Array]:
    found = order_spectrum(cycle, highest_order)
    return found.torque, found.supply_flow


def results_of(system: System, harmonics: int = HARMONICS) -> list[dict[str, float]]:
    """The results alone, at every operating point; nothing is sampled for pictures."""
    return [_numbers(cycle, harmonics) for cycle in cycles(system)]


def _numbers(cycle: Cycle, harmonics: int) -> dict[str, float]:
    metrics = summarise_compiled(cycle, harmonics)
    return {name: float(value) for name, value in vars(metrics).items()}


def _result(cycle: Cycle, angle: np.ndarray, harmonics: int, error: float) -> Result:
    plate, inside = cycle.motor.valve_plate, _inside(angle)
    waves = waveforms(cycle, inside)
    supply_opening, return_opening = map(np.asarray, _openings(plate, inside))
    torque, flow = map(np.asarray, _by_order(cycle, harmonics))
    return Result(
        point=point_of(cycle.point),
        metrics=_numbers(cycle, harmonics),
        waves=Waves(
            angle=angle,
            **{name: np.asarray(getattr(waves, name)) for name in _WAVES},
            supply_opening=supply_opening,
            return_opening=return_opening,
        ),
        orders=cycle.motor.cam.repeats * np.arange(1, len(torque) + 1),
        torque_amplitudes=torque,
        flow_amplitudes=flow,
        periodicity_residual=float(cycle.periodicity_residual),
        numerical_error=error,
    )


def _start(found: Starting, point: OperatingPoint) -> Start:
    here, other = (np.asarray(found.torque(way)) for way in (point.reverse, not point.reverse))
    return Start(np.asarray(found.angle), here, other, float(found.ideal_torque))


_WAVES: Sequence[str] = (
    "lift",
    "velocity",
    "acceleration",
    "jerk",
    "volume",
    "chamber_pressure",
    "supply_flow",
    "return_flow",
    "leakage_flow",
    "contact_force",
    "contact_stress",
    "torque",
)


def point_of(point: OperatingPoint) -> Point:
    """An operating point as plain numbers."""
    return Point(
        float(point.shaft_speed),
        float(point.supply_pressure),
        float(point.return_pressure),
        float(point.case_pressure),
        float(point.weight),
        point.reverse,
        point.mode,
    )

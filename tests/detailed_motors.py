"""Random motors with every law of the detailed laws at once: one structure, one compilation."""

from dataclasses import replace
from math import pi

import equinox as eqx
import numpy as np
from motors import (
    REVOLUTION_PER_MINUTE,
    STRUCTURES,
    Case,
    Structure,
    shaft_speed,
    sound_case,
    window_widths,
)

from camring.geometry.notch import ReliefNotch
from camring.geometry.piston import ReturnSpring
from camring.geometry.window import RoundWindow
from camring.physics.friction import ViscousFriction
from camring.physics.gap import PistonGap, PlateGap
from camring.physics.leakage import ViscousLeakage
from camring.physics.oil.aerated_fluid import AeratedFluid
from camring.physics.oil.churning import Churning
from camring.physics.orifice import LaminarTurbulentOrifice
from camring.physics.stribeck_friction import StribeckFriction


def detailed_case(seed: int, structure: Structure = STRUCTURES[0]) -> Case:
    """A sound motor with air in its oil, round notched ports, gaps and rubbing rollers."""
    rng = np.random.default_rng([1313, seed])
    motor, fluid, point = sound_case(seed, structure)
    plate = motor.valve_plate
    pitch = plate.pitch
    plate = eqx.tree_at(
        lambda p: (p.window, p.notch),
        plate,
        (
            RoundWindow(rng.uniform(0.3, 1.0)),
            ReliefNotch(pitch * rng.uniform(0.01, 0.06), rng.uniform(0.005, 0.08)),
        ),
        is_leaf=lambda x: x is None,
    )
    motor = eqx.tree_at(
        lambda m: (m.valve_plate, m.orifice, m.friction, m.gap),
        motor,
        (
            plate,
            LaminarTurbulentOrifice(rng.uniform(0.6, 0.7), 10 ** rng.uniform(2, 3.3)),
            ViscousFriction(motor.friction.damping, rng.uniform(0.002, 0.02), rng.uniform(0, 0.1)),
            PistonGap(rng.uniform(5e-6, 2e-5), rng.uniform(0.01, 0.04), rng.uniform(0, 1)),
        ),
        is_leaf=lambda x: x is None,
    )
    oil = AeratedFluid(
        fluid.density,
        fluid.bulk_modulus,
        fluid.vapour_pressure,
        viscosity=10 ** rng.uniform(-5, -4),
        air_fraction=10 ** rng.uniform(-3.5, -1.5),
        polytropic_index=rng.uniform(1.0, 1.4),
        dissolution_pressure=10 ** rng.uniform(6, 7),
        modulus_gain=rng.choice([0.0, rng.uniform(4, 12)]),
    )
    return Case(motor, oil, point)


# Lobes 1 and 3 idle: the pattern repeats twice a revolution, and windows of the supply lead to the
# return with their own numbers.
HALF = (1, 3)
HALF_STRUCTURE = Structure("radial", 6, 4, 10)


def half_case(seed: int, idle: tuple[int, ...] = HALF) -> Case:
    """A motor with every law, a plate that leaks and idle lobes, whose two sides share nothing."""
    case = detailed_case(seed, HALF_STRUCTURE)
    motor, plate = case.motor, case.motor.valve_plate
    rng = np.random.default_rng([4711, seed])
    own = {
        "area": float(plate.port_area) * rng.uniform(0.8, 1.5, size=2),
        "discharge_coefficient": rng.uniform(0.55, 0.85, size=2),
        "ramp": rng.uniform(0.3, 1.0, size=2),
    }
    notches = [
        ReliefNotch(plate.pitch * rng.uniform(0.01, 0.05), rng.uniform(0.005, 0.06))
        for _ in range(2)
    ]
    ports = [
        replace(port, notch=notches[k], **{name: own[name][k] for name in own})
        for k, port in enumerate((plate.supply, plate.return_))
    ]
    plate = replace(plate, supply=ports[0], return_=ports[1], notch=None)
    radii = 0.4 * float(np.min(np.asarray(motor.cam.control_radii)))
    gap = PlateGap(6e-6, radii * np.array([0.8, 0.9, 1.1, 1.25]))
    motor = replace(motor, valve_plate=plate, plate_gap=gap)
    return Case(motor, case.fluid, replace(case.point, idle_lobes=idle))


# The lift counts from the mean radius, so that a spring's travel is another number than it.
FURTHER_STRUCTURE = Structure("radial", 5, 4, 12, reference="mean")


def further_case(seed: int) -> Case:
    """With springs, contacts that stick at rest, a plate that leaks and oil that is churned."""
    rng = np.random.default_rng([1818, seed])
    case = detailed_case(seed, FURTHER_STRUCTURE)
    motor, speed = case.motor, float(case.point.shaft_speed)
    stroke = float(np.ptp(np.asarray(motor.cam.control_radii)))
    preload = 0.02 * float(case.point.pressure_drop * motor.piston.area)
    surface = speed * float(np.mean(np.asarray(motor.cam.control_radii)))
    friction = StribeckFriction(
        damping=motor.friction.damping,
        roller=rng.uniform(0.003, 0.01),
        roller_static=rng.uniform(0.03, 0.08),
        roller_stribeck=surface * rng.uniform(0.3, 1.5),
        side=rng.uniform(0.01, 0.05),
        side_static=rng.uniform(0.08, 0.15),
        side_stribeck=0.3 * surface * rng.uniform(0.2, 1.0),
    )
    spring = ReturnSpring(preload / stroke * rng.uniform(0.3, 0.9), preload)
    ports = 0.4 * float(np.min(np.asarray(motor.cam.control_radii)))
    plate = PlateGap(rng.uniform(4e-6, 8e-6), ports * np.array([0.8, 0.9, 1.1, 1.25]))
    leakage = ViscousLeakage(motor.leakage.coefficient, float(case.fluid.viscosity) * 1.7)
    churning = Churning(rng.uniform(0.02, 0.1), float(np.max(np.asarray(motor.cam.control_radii))))
    motor = eqx.tree_at(
        lambda m: (m.friction, m.piston.spring, m.plate_gap, m.leakage, m.churning),
        motor,
        (friction, spring, plate, leakage, churning),
        is_leaf=lambda x: x is None,
    )
    return Case(motor, case.fluid, case.point)


def quiet_case(seed: int) -> Case:
    """A detailed motor whose cam has no geometric ripple: what is left are small numbers.

    Eight pistons on six lobes: a rising slope of four equal control steps, smoothed, is
    ripple-free (docs/theory.md section 11).
    """
    rng = np.random.default_rng([7170, seed])
    case = detailed_case(seed)
    radii = np.asarray(case.motor.cam.control_radii)
    side = rng.uniform(0.2, 1)
    kernel = np.array([side, rng.uniform(0.2, 1), side])
    steps = np.convolve(np.ones(4), kernel / kernel.sum())
    rise = np.append(np.cumsum(steps), [steps.sum()] * (8 - len(steps))) / steps.sum()
    lift = np.roll(np.append(rise, 1 - rise), 1)  # its middle in the supply window's
    return case.changed(lambda c: c.motor.cam.control_radii, radii.min() + np.ptp(radii) * lift)


TROUBLES = ("trapped", "nearly touching", "crawling", "no leakage", "racing", "much air")


def _notch(case: Case):
    return case.motor.valve_plate.notch.angle, case.motor.valve_plate.notch.area


def _clearance(case: Case):
    return case.motor.gap.clearance, case.motor.leakage.coefficient


def hard_case(seed: int, trouble: str, structure: Structure = STRUCTURES[0]) -> Case:
    """A detailed motor pushed to where solvers have trouble."""
    rng = np.random.default_rng([99, seed])
    case = detailed_case(seed, structure)
    pitch = case.motor.valve_plate.pitch
    match trouble:
        case "trapped":  # closed over a good part of the stroke: vacuum, then thousands of bar
            tight = case.changed(_clearance, (1e-7, 1e-16)).changed(_notch, (1e-4, 1e-4))
            return tight.changed(window_widths, tuple(pitch / 2 * rng.uniform(0.6, 0.75, size=2)))
        case "nearly touching":
            close = case.changed(window_widths, (pitch / 2 * (1 - 1e-6),) * 2)
            return close.changed(shaft_speed, 20 * REVOLUTION_PER_MINUTE)
        case "crawling":
            return case.changed(shaft_speed, 1 * REVOLUTION_PER_MINUTE)
        case "no leakage":
            return case.changed(_clearance, (1e-8, 0.0))
        case "racing":
            return case.changed(shaft_speed, 1500 * REVOLUTION_PER_MINUTE)
        case "much air":
            return case.changed(lambda c: c.fluid.air_fraction, 0.2)
    raise ValueError(trouble)


def lens_area_by_quadrature(overlap: float, count: int = 4000) -> float:
    """Area common to two circles over that of one, by strips; `overlap` over the diameter."""
    # Strips across the line of centres, at the angle where the chord ends.
    angle = np.linspace(0, np.arccos(1 - overlap), count)
    height = np.sin(angle)
    middle = (height[1:] + height[:-1]) / 2
    return float(np.sum(2 * 2 * middle * np.abs(np.diff(np.cos(angle))))) / pi

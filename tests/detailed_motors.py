"""Random motors with every law of the detailed laws at once: one structure, one compilation."""

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
from camring.geometry.window import RoundWindow
from camring.physics.friction import ViscousFriction
from camring.physics.gap import PistonGap
from camring.physics.oil.aerated_fluid import AeratedFluid
from camring.physics.orifice import LaminarTurbulentOrifice


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

"""The published trend: tuned relief notches cut a motor's torque pulsation by half or more."""

from itertools import product
from math import pi

import numpy as np
import pytest
from both_solvers import run_all
from motors import STEEL, Case

from camring.geometry.cam import RadialCam
from camring.geometry.notch import ReliefNotch
from camring.geometry.piston import Piston, Roller
from camring.geometry.profiles import zero_ripple_cams
from camring.geometry.valve_plate import Port, ValvePlate
from camring.geometry.window import RoundWindow
from camring.physics.friction import ViscousFriction
from camring.physics.leakage import ConstantLeakage
from camring.physics.motor import Motor
from camring.physics.oil.aerated_fluid import AeratedFluid
from camring.physics.operating_point import OperatingPoint
from camring.physics.orifice import TurbulentOrifice
from camring.physics.resolution import Resolution

PISTONS, LOBES = 8, 6
PITCH = 2 * pi / LOBES
ANGLES = PITCH * np.array([0.005, 0.01, 0.02, 0.03, 0.04])
AREAS = np.array([0.003, 0.01, 0.03, 0.1, 0.8])


def motor_with(notch):
    """A cam without ripple of its own, so what is left comes from the commutation."""
    cam = max(zero_ripple_cams(PISTONS, LOBES, 24), key=lambda found: len(found.steps))
    radii = 0.18 + 0.015 * cam.control_values(24)
    ports = (Port(0.455 * PITCH, PITCH / 4), Port(0.455 * PITCH, 3 * PITCH / 4))
    plate = ValvePlate(6e-5, *ports, RoundWindow(0.3), 0.0, notch, lobes=LOBES)
    return Motor(
        RadialCam(radii, repeats=LOBES),
        Piston(0.036, 0.5),
        Roller(0.016, 0.036, STEEL),
        STEEL,
        plate,
        5e-6,
        TurbulentOrifice(0.65),
        ConstantLeakage(2e-13),
        ViscousFriction(80.0),
        pistons=PISTONS,
        lobes=LOBES,
    )


@pytest.mark.slow
def test_a_tuned_notch_cuts_the_torque_pulsation_by_half_or_more():
    oil = AeratedFluid(870.0, 1.4e9, 3e3)
    point = OperatingPoint(100 * pi / 30, 250e5, 10e5, 10e5)

    # A notch without area is none.
    choices = np.array([(ANGLES[0], 0.0), *product(ANGLES, AREAS)])
    cases = [Case(motor_with(ReliefNotch(*each)), oil, point) for each in choices]
    cycles, found = run_all(cases, Resolution.coarse())
    assert np.all(cycles.verdict.code == 0)
    ripple, swing = found.torque_ripple, found.torque_ripple_peak_to_peak * found.mean_torque
    best = int(np.argmin(swing))
    print(
        f"notch of {np.degrees(choices[best, 0]):.2f} deg and {choices[best, 1]:.3f} of the port: "
        f"pulsation {float(swing[0]):.1f} to {float(swing[best]):.1f} N m, "
        f"ripple {float(ripple[0]):.4f} to {float(ripple[best]):.4f}"
    )
    assert float(swing[best]) <= 0.5 * float(swing[0])
    assert float(ripple[best]) <= 0.5 * float(ripple[0])
    # Too large a groove joins the ports and is no tuning: the least lies inside the range.
    assert float(swing[best]) < float(swing[-1])

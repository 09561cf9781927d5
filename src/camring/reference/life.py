"""Rating life of ring and rollers by the second solver: from survival, not from capacities.

The chance to survive `n` revolutions is written down as Lundberg and Palmgren do, for every
piece of ring and roller by itself, and the number is sought at which nine of ten survive.
"""

from math import log, pi

import numpy as np

from camring.reference.machine import Machine
from camring.reference.shape import Jet

DISPERSION, EXPONENT = 1.125, 10 / 3
STEEL, EDGES = 1.1, 0.83  # ISO 281 and ISO/TR 1281-1


def capacity_in_bearing(machine: Machine, relative: np.ndarray, raceway: float) -> np.ndarray:
    """Contact load of a million single cycles, N: that of an outer raceway with this geometry.

    The bearing is sought in which a roller of diameter D has the relative radius
    `D (1 + g) / 2` and the raceway `pi D (1 + g) / g`, in millimetres.
    """
    curved, length = 1e3 * relative, 1e3 * raceway
    g = 2 * pi * curved / length
    diameter = 2 * curved / (1 + g)
    # Its capacity falls with (Z (1 - g))^(1/4) as its cycles a turn, Z (1 - g) / 2, rise.
    qc = 552 * 0.5**0.25 * (1 + g) ** (29 / 27) * g ** (2 / 9) * diameter ** (29 / 27)
    return STEEL * EDGES * qc * (1e3 * machine.roller_length) ** (7 / 9)


def rating_life(
    machine: Machine, jet: Jet, undercut: np.ndarray, normal: np.ndarray, weight: np.ndarray
) -> float:
    """Seconds that nine of ten motors run, from quadrature points over a period."""
    step = weight / np.sum(weight) * undercut * np.hypot(jet[0], jet[1])  # m of ring a radian
    ring, roller = 2 * pi * float(np.sum(step)), 2 * pi * machine.roller_radius
    share, load = step / np.sum(step), np.maximum(normal, 0)
    relative = machine.roller_radius * undercut
    one, other = (capacity_in_bearing(machine, relative, round_) for round_ in (ring, roller))
    # As capacities fall with the fourth root of cycles, so does what a million turns allow.
    of_ring = (load / one * machine.pistons**0.25) ** EXPONENT
    of_roller = (load / other * (ring / roller) ** 0.25) ** EXPONENT
    hazard = float(share @ of_ring**DISPERSION)
    hazard += machine.pistons * float(share @ of_roller) ** DISPERSION
    # ln(1/S) = ln(1/0.9) * hazard * (million turns)^(9/8); S = 0.9.
    millions = (log(1 / 0.9) / (log(1 / 0.9) * hazard)) ** (1 / DISPERSION)
    return 1e6 * millions * 2 * pi / machine.shaft_speed

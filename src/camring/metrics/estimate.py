"""A motor with a sine cam in closed form: what a sketch on paper would give.

Nothing is simulated: pressure is the supply's on the rise and the return's on the
fall. Every number may be an array, so thousands of sketches cost one call.
"""

from math import pi
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from camring.geometry.contour import undercut_factor
from camring.geometry.material import Material
from camring.geometry.piston import Roller
from camring.numerics.quantity import Q, real
from camring.numerics.spline import Jet
from camring.physics.contact import hertz_stress

Numbers = Float[np.ndarray, "*sketch"]
Share = Q[Numbers, "1"]

DISCHARGE_COEFFICIENT = 0.65
RAMPS = 1.9  # what windows with ramps of 0.3 throttle beside ones that are open at once


class Sketch(NamedTuple):
    """The hardware of a motor with a sine cam, SI."""

    pistons: Numbers
    lobes: Numbers
    bore: Numbers
    stroke: Numbers
    mean_radius: Numbers  # of the pitch curve
    roller_radius: Numbers
    roller_length: Numbers
    port_area: Numbers
    dead_volume: Numbers
    piston_mass: Numbers
    viscous_damping: Numbers
    leakage_coefficient: Numbers

    @property
    def area(self) -> Q[Numbers, "m2"]:
        return pi * self.bore**2 / 4

    @property
    def displacement(self) -> Q[Numbers, "m3"]:
        """Volume of a revolution: `Np NL Ap stroke`."""
        return self.pistons * self.lobes * self.area * self.stroke

    @property
    def least_radius(self) -> Q[Numbers, "m"]:
        """Of the pitch curve, at the inner dead centre."""
        return self.mean_radius - self.stroke / 2

    @property
    def greatest_radius(self) -> Q[Numbers, "m"]:
        """Of the pitch curve, at the outer dead centre."""
        return self.mean_radius + self.stroke / 2

    @property
    def phases(self) -> Numbers:
        """Distinct piston phases, `Np / gcd(Np, NL)`."""
        return self.pistons // np.gcd(self.pistons, self.lobes)


class Duty(NamedTuple):
    """Speed, pressures and oil of a sketch."""

    shaft_speed: float
    supply_pressure: float
    return_pressure: float | Numbers
    case_pressure: float
    density: float
    bulk_modulus: float

    @property
    def drop(self) -> Q[Numbers, "Pa"]:
        return np.asarray(self.supply_pressure - self.return_pressure)


def inner_dead_centre(sketch: Sketch) -> Jet:
    """The pitch radius where the sine cam bends outwards most, with its derivatives."""
    bend = real(sketch.stroke / 2 * sketch.lobes**2)
    nothing = 0 * bend
    return Jet(real(sketch.least_radius), nothing, bend, nothing)


def least_undercut_factor(sketch: Sketch) -> Share:
    """`1 + kappa Rf` at the inner dead centre, its least for a sine."""
    return np.asarray(undercut_factor(inner_dead_centre(sketch), real(sketch.roller_radius)))


def contact_stress(sketch: Sketch, duty: Duty, steel: Material) -> Q[Numbers, "Pa"]:
    """Hertz stress at the inner dead centre at full supply pressure, without inertia.

    Ring and roller of one material. Infinite where the roller undercuts the ring.
    """
    force = real(sketch.area) * (duty.supply_pressure - duty.case_pressure)
    roller = Roller(real(sketch.roller_radius), real(sketch.roller_length), steel)
    return np.asarray(hertz_stress(force, inner_dead_centre(sketch), roller, steel))


def greatest_pressure_angle(sketch: Sketch) -> Q[Numbers, "rad"]:
    """Exact for a sine: `tan phi = b NL / sqrt(R^2 - b^2)`, `b` half the stroke."""
    b = sketch.stroke / 2
    inside = np.maximum(sketch.mean_radius**2 - b**2, 1e-300)
    return np.arctan2(b * sketch.lobes, np.sqrt(inside))


def piston_speed(sketch: Sketch, duty: Duty) -> Q[Numbers, "m/s"]:
    """Greatest speed of a piston in its bore."""
    return duty.shaft_speed * sketch.lobes * sketch.stroke / 2


def port_drop(sketch: Sketch, duty: Duty) -> Q[Numbers, "Pa"]:
    """Pressure lost across a fully open port at the greatest piston speed."""
    jet = piston_speed(sketch, duty) * sketch.area / (DISCHARGE_COEFFICIENT * sketch.port_area)
    return duty.density / 2 * jet**2


def inertia_pressure(sketch: Sketch, duty: Duty) -> Q[Numbers, "Pa"]:
    """Pressure above the case's that keeps the rollers on the ring on their way in."""
    acceleration = (duty.shaft_speed * sketch.lobes) ** 2 * sketch.stroke / 2
    return sketch.piston_mass * acceleration / sketch.area


def pre_compression(sketch: Sketch, duty: Duty) -> Q[Numbers, "rad"]:
    """Shaft angle in which a sealed piston raises the oil to supply pressure, about the
    inner dead centre.

    `V_dead dp / beta` of travel, of the `stroke/2 (1 - cos(NL angle))` that a sine gives.
    """
    travel = sketch.dead_volume * duty.drop / duty.bulk_modulus / sketch.area
    return np.arccos(np.clip(1 - 2 * travel / sketch.stroke, -1, 1)) / sketch.lobes


def pressure_leaked_away(sketch: Sketch, duty: Duty, shut: Q[Numbers, "rad"]) -> Q[Numbers, "Pa"]:
    """What a chamber loses while it is shut about the inner dead centre.

    Shut over `shut`, half before and half after it, the oil is pressed together and let
    expand again; what leaked out meanwhile is missing afterwards. Pressure over a short
    angle is a parabola, two thirds of its height on the mean. Above the truth, because
    what has leaked no longer presses.
    """
    half = shut * sketch.lobes / 2
    swept, stiffness = sketch.area * sketch.stroke, duty.bulk_modulus / sketch.dead_volume
    height = stiffness * swept / 2 * (1 - np.cos(half))
    mean = 2 / 3 * height + duty.return_pressure - duty.case_pressure
    return stiffness * sketch.leakage_coefficient * mean * shut / duty.shaft_speed


def efficiency(sketch: Sketch, duty: Duty) -> Share:
    """Shaft power over hydraulic power, each loss as a share of `dp V_D w / (2 pi)`.

    Leakage over the half of the time that a chamber is under pressure; throttling of a
    sine, flow-weighted mean two thirds of the greatest, on both sides; viscous friction;
    commutation `V_dead dp / (beta Ap stroke)`: windows that are symmetric about the dead
    centres waste the compression of the dead volume, and the swept volume's comes back.

    Notes
    -----
    Within a point of the simulation for the three example motors.
    """
    ideal = duty.drop * sketch.displacement * duty.shaft_speed / (2 * pi)
    above_case = (duty.drop / 2) * duty.drop
    leakage = sketch.pistons * sketch.leakage_coefficient * above_case / ideal
    throttling = 2 * (2 / 3) * RAMPS * port_drop(sketch, duty) / duty.drop
    friction = sketch.pistons * sketch.viscous_damping * piston_speed(sketch, duty) ** 2 / 2 / ideal
    swept = sketch.area * sketch.stroke
    commutation = sketch.dead_volume * duty.drop / (duty.bulk_modulus * swept)
    return 1 / (1 + leakage) - throttling - friction - commutation


def sine_torque_ripple(phases: Numbers) -> Share:
    """One-sided geometric torque ripple of a sine cam with ideal switching.

    The torque of `q` phases is a cosine over `pi/K` either side of its top, `K = q` for
    even `q` and `2q` for odd (model.md section 11); infinite for one phase.
    """
    q = np.asarray(phases)
    k = np.where(q % 2, 2 * q, q)
    mean = k / pi * np.sin(pi / k)
    square = 1 / 2 + k / (4 * pi) * np.sin(2 * pi / k)
    return np.sqrt(np.maximum(square / mean**2 - 1, 0) / 2)

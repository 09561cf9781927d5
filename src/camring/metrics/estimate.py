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
    viscous_damping: Numbers  # of film and everything else
    leakage_coefficient: Numbers  # of gap and valve plate together
    roller_friction: Numbers
    side_friction: Numbers

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


class Conditions(NamedTuple):
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


def contact_stress(sketch: Sketch, conditions: Conditions, steel: Material) -> Q[Numbers, "Pa"]:
    """Hertz stress at the inner dead centre at full supply pressure, without inertia.

    Ring and roller of one material. Infinite where the roller undercuts the ring.
    """
    force = real(sketch.area) * (conditions.supply_pressure - conditions.case_pressure)
    roller = Roller(real(sketch.roller_radius), real(sketch.roller_length), steel)
    return np.asarray(hertz_stress(force, inner_dead_centre(sketch), roller, steel))


def greatest_pressure_angle(sketch: Sketch) -> Q[Numbers, "rad"]:
    """Exact for a sine: `tan phi = b NL / sqrt(R^2 - b^2)`, `b` half the stroke."""
    b = sketch.stroke / 2
    inside = np.maximum(sketch.mean_radius**2 - b**2, 1e-300)
    return np.arctan2(b * sketch.lobes, np.sqrt(inside))


def piston_speed(sketch: Sketch, conditions: Conditions) -> Q[Numbers, "m/s"]:
    """Greatest speed of a piston in its bore."""
    return conditions.shaft_speed * sketch.lobes * sketch.stroke / 2


def port_drop(sketch: Sketch, conditions: Conditions) -> Q[Numbers, "Pa"]:
    """Pressure lost across a fully open port at the greatest piston speed."""
    jet = (
        piston_speed(sketch, conditions) * sketch.area / (DISCHARGE_COEFFICIENT * sketch.port_area)
    )
    return conditions.density / 2 * jet**2


def inertia_pressure(sketch: Sketch, conditions: Conditions) -> Q[Numbers, "Pa"]:
    """Pressure above the case's that keeps the rollers on the ring on their way in."""
    acceleration = (conditions.shaft_speed * sketch.lobes) ** 2 * sketch.stroke / 2
    return sketch.piston_mass * acceleration / sketch.area


def pre_compression(sketch: Sketch, conditions: Conditions) -> Q[Numbers, "rad"]:
    """Shaft angle in which a sealed piston raises the oil to supply pressure, about the
    inner dead centre.

    `V_dead dp / beta` of travel, of the `stroke/2 (1 - cos(NL angle))` that a sine gives.
    """
    travel = sketch.dead_volume * conditions.drop / conditions.bulk_modulus / sketch.area
    return np.arccos(np.clip(1 - 2 * travel / sketch.stroke, -1, 1)) / sketch.lobes


def pressure_leaked_away(
    sketch: Sketch, conditions: Conditions, shut: Q[Numbers, "rad"]
) -> Q[Numbers, "Pa"]:
    """What a chamber loses while it is shut about the inner dead centre.

    Shut over `shut`, half before and half after it, the oil is pressed together and let
    expand again; what leaked out meanwhile is missing afterwards. Pressure over a short
    angle is a parabola, two thirds of its height on the mean. Above the truth, because
    what has leaked no longer presses.
    """
    half = shut * sketch.lobes / 2
    swept, stiffness = sketch.area * sketch.stroke, conditions.bulk_modulus / sketch.dead_volume
    height = stiffness * swept / 2 * (1 - np.cos(half))
    mean = 2 / 3 * height + conditions.return_pressure - conditions.case_pressure
    return stiffness * sketch.leakage_coefficient * mean * shut / conditions.shaft_speed


def contact_friction(sketch: Sketch, conditions: Conditions) -> Share:
    """Torque lost where rollers turn and pistons lean, over the ideal torque.

    `physics.friction`'s law for a sine whose chambers stand half a turn each at supply and at
    return pressure, with `sin^2` and `tan^2` in their means and the ring's radius in its own.
    """
    above_case = (
        conditions.supply_pressure + conditions.return_pressure - 2 * conditions.case_pressure
    )
    pressed = above_case / conditions.drop
    steepness = np.tan(greatest_pressure_angle(sketch))
    travel = sketch.stroke * sketch.lobes
    arc = (sketch.mean_radius + sketch.roller_radius) * (1 + steepness**2 / 2)
    rolling = sketch.roller_friction * pi * arc / travel
    leaning = sketch.side_friction * pi * travel / (8 * sketch.mean_radius)
    return pressed * (rolling + leaning)


def volumetric_efficiency(sketch: Sketch, conditions: Conditions) -> Share:
    """Displacement times speed over supply flow: what leaks while a chamber is under pressure,
    half of the time."""
    mean_pressure = (
        conditions.supply_pressure + conditions.return_pressure
    ) / 2 - conditions.case_pressure
    leaking = sketch.pistons * sketch.leakage_coefficient * mean_pressure
    return 1 / (1 + leaking * 2 * pi / (sketch.displacement * conditions.shaft_speed))


def hydromechanical_efficiency(sketch: Sketch, conditions: Conditions) -> Share:
    """Torque over `dp V_D / (2 pi)`, each loss as a share of that.

    Throttling of a sine, flow-weighted mean two thirds of the greatest, on both sides; viscous
    friction and that of the contacts; commutation `V_dead dp / (beta Ap stroke)`: windows that
    are symmetric about the dead centres waste the compression of the dead volume, and the
    swept volume's comes back.
    """
    ideal = conditions.drop * sketch.displacement * conditions.shaft_speed / (2 * pi)
    throttling = 2 * (2 / 3) * RAMPS * port_drop(sketch, conditions) / conditions.drop
    friction = (
        sketch.pistons * sketch.viscous_damping * piston_speed(sketch, conditions) ** 2 / 2 / ideal
    )
    swept = sketch.area * sketch.stroke
    commutation = sketch.dead_volume * conditions.drop / (conditions.bulk_modulus * swept)
    return 1 - throttling - friction - contact_friction(sketch, conditions) - commutation


def efficiency(sketch: Sketch, conditions: Conditions) -> Share:
    """Shaft power over `dp` times supply flow, as a test bench reads it (ISO 4409).

    Notes
    -----
    Within half a point of the simulation for the motors that `camring new` writes.
    """
    return volumetric_efficiency(sketch, conditions) * hydromechanical_efficiency(
        sketch, conditions
    )


def sine_torque_ripple(phases: Numbers) -> Share:
    """One-sided geometric torque ripple of a sine cam with ideal switching.

    The torque of `q` phases is a cosine over `pi/K` either side of its top, `K = q` for
    even `q` and `2q` for odd (docs/theory.md section 11); infinite for one phase.
    """
    q = np.asarray(phases)
    k = np.where(q % 2, 2 * q, q)
    mean = k / pi * np.sin(pi / k)
    square = 1 / 2 + k / (4 * pi) * np.sin(2 * pi / k)
    return np.sqrt(np.maximum(square / mean**2 - 1, 0) / 2)

"""The wheel motor at its first operating point, as it is and in variants."""

from dataclasses import replace
from pathlib import Path

import equinox as eqx
import jax.numpy as jnp

import camring
from camring.files.motor import MotorFile, parse_motor_file
from camring.geometry.piston import ReturnSpring
from camring.physics.gap import PistonGap, PlateGap
from camring.physics.heat.thermal import Thermal
from camring.physics.leakage import ViscousLeakage
from camring.physics.oil.aerated_fluid import AeratedFluid
from camring.physics.oil.churning import Churning
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.oil.viscosity_line import ViscosityLine
from camring.physics.stribeck_friction import StribeckFriction
from camring.physics.system import System

PATH = Path(__file__).parents[1] / "examples" / "derivation_motor.toml"
MORE_VARIABLES = """[design_space]
"motor.valve_plate.port_area" = ["50 mm^2", "70 mm^2"]
"motor.valve_plate.discharge_coefficient" = [0.6, 0.7]
"motor.dead_volume" = ["5 cm^3", "7 cm^3"]
"""


def as_given() -> MotorFile:
    return camring.read_motor_file(PATH)


def of_twenty_variables() -> MotorFile:
    """Sines beside the cosines of the cam, and three numbers more."""
    text = PATH.read_text().replace("mirror = true", "mirror = false")
    return parse_motor_file(text.replace("[design_space]\n", MORE_VARIABLES), PATH)


def at_one_point(system: System) -> System:
    """The same with the first of its operating points alone."""
    points = system.operating_points[:1]
    return eqx.tree_at(lambda each: each.operating_points, system, points)


def with_air(system: System) -> System:
    return eqx.tree_at(lambda each: each.fluid, system, aerated(system.fluid))


def aerated(oil: AbstractFluid) -> AeratedFluid:
    """The same oil with half a per cent of air."""
    return AeratedFluid(oil.density, oil.bulk_modulus, oil.vapour_pressure, oil.transition_pressure)


def with_every_law(system: System) -> System:
    """With air, and every law of docs/theory.md section 14 but the heat balance."""
    motor, oil, speed = system.motor, system.fluid, system.operating_points[0].shaft_speed
    radius = float(jnp.max(jnp.asarray(motor.cam.control_radii)))
    surface = float(speed) * radius
    friction = StribeckFriction(0.0, 0.006, 0.03, 0.5 * surface, 0.02, 0.1, 0.1 * surface)
    motor = replace(
        motor,
        friction=friction,
        piston=replace(motor.piston, spring=ReturnSpring(5e3, 200.0)),
        leakage=ViscousLeakage(motor.leakage.coefficient, 4.6e-5),
        gap=PistonGap(1e-5, 0.03),
        plate_gap=PlateGap(5e-6, 0.4 * radius * jnp.array([0.8, 0.9, 1.1, 1.25])),
        churning=Churning(0.05, radius),
    )
    oil = replace(aerated(oil), viscosity=4e-5)
    return replace(system, motor=motor, fluid=oil)


def with_heat(system: System) -> System:
    """With every law, the heat balance too."""
    every = with_every_law(system)
    oil = replace(every.fluid, line=ViscosityLine.of_oil("ISO VG 46", 323.15))
    return replace(every, motor=replace(every.motor, thermal=Thermal(293.15, 20.0)), fluid=oil)


def free_ring(system: System) -> System:
    """The same motor, its ring described lobe by lobe."""
    cam = system.motor.cam
    ring = type(cam)(jnp.tile(cam.control_radii, cam.repeats), repeats=1, degree=cam.degree)
    return eqx.tree_at(lambda each: each.motor.cam, system, ring)

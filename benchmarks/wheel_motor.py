"""The wheel motor at its first operating point, as it is and in variants."""

from pathlib import Path

import equinox as eqx
import jax.numpy as jnp

import camring
from camring.files.motor import MotorFile, parse_motor_file
from camring.physics.oil.aerated_fluid import AeratedFluid
from camring.physics.oil.fluid import AbstractFluid
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


def free_ring(system: System) -> System:
    """The same motor, its ring described lobe by lobe."""
    cam = system.motor.cam
    ring = type(cam)(jnp.tile(cam.control_radii, cam.repeats), repeats=1, degree=cam.degree)
    return eqx.tree_at(lambda each: each.motor.cam, system, ring)

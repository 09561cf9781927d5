"""Hydraulic stiffness of a chamber, and the oscillator it would make with a piston.

The cam prescribes the motion, so nothing here can ring; the numbers describe
the derivation's small-signal picture and are reported for comparison.
"""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.numerics.quantity import Q
from camring.physics.cycle import Cycle


class Oscillator(eqx.Module):
    """A piston's mass on its chamber's oil. docs/theory.md section 4."""

    stiffness: Q[Float[Array, ""], "N/m"]
    natural_frequency: Q[Float[Array, ""], "rad/s"]
    damping_ratio: Q[Float[Array, ""], "1"]


def oscillator(cycle: Cycle, mean_volume: Q[Float[Array, ""], "m3"]) -> Oscillator:
    """`kf = beta Ap^2 / mean V`, its frequency with the piston's mass, and the damping ratio."""
    motor, fluid = cycle.motor, cycle.fluid
    stiffness = fluid.bulk_modulus * motor.piston.area**2 / mean_volume
    damping = motor.viscous_damping(fluid)
    return Oscillator(
        stiffness,
        jnp.sqrt(stiffness / motor.piston.mass),
        damping / (2 * jnp.sqrt(motor.piston.mass * stiffness)),
    )

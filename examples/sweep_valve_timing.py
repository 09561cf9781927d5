"""Many motors at once: turn the valve plate, and see ripple and pressure peak follow."""

from pathlib import Path

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

import camring

system = camring.read_motor_file(Path(__file__).with_name("wheel_motor.toml")).system


def turned(shift):
    """Torque ripple and highest pressure with the valve plate turned by `shift`, rad."""
    motor = eqx.tree_at(lambda each: each.valve_plate.shift, system.motor, shift)
    results = camring.summarise(camring.simulate(motor, system.fluid, system.operating_points[0]))
    return results.torque_ripple, results.max_pressure


shifts = np.radians(np.linspace(-1, 1, 9))
ripples, pressures = jax.jit(jax.vmap(turned))(jnp.asarray(shifts))
for shift, ripple, pressure in zip(shifts, ripples, pressures, strict=True):
    print(
        f"{np.degrees(shift):+5.2f}°  ripple {100 * ripple:5.2f} %  peak {pressure / 1e5:4.0f} bar"
    )

"""Exact sensitivities: which variable of the design space moves torque ripple most?"""

from pathlib import Path

import jax
import jax.numpy as jnp

import camring

motor_file = camring.read_motor_file(Path(__file__).with_name("wheel_motor.toml"))
system, space = motor_file.system, motor_file.design_space


def ripple(unit_point):
    """Torque ripple of one design at the first operating point."""
    design = space.apply(system, unit_point)
    cycle = camring.simulate(design.motor, design.fluid, design.operating_points[0])
    return camring.summarise(cycle).torque_ripple


given = jnp.asarray(space.locate(system))
value, slope = jax.jit(jax.value_and_grad(ripple))(given)
print(
    f"torque ripple {100 * value:.2f} %; over the whole range of each variable it would change by"
)
for name, share in sorted(zip(space.names, slope, strict=True), key=lambda pair: -abs(pair[1])):
    print(f"{name:32} {100 * share:+8.2f} points")

"""Four laws of lift in the same motor: the textbook's smoothest is not the steadiest."""

from pathlib import Path

import equinox as eqx
import jax.numpy as jnp
import numpy as np

import camring
from camring.geometry.profiles import LAWS, control_values, zero_ripple_cams

system = camring.read_motor_file(Path(__file__).with_name("wheel_motor.toml")).system
motor, count = system.motor, system.motor.cam.control_count
inner, stroke = float(jnp.min(motor.cam.control_radii)), float(jnp.ptp(motor.cam.control_radii))

cams = {name: control_values(law, count) for name, law in LAWS.items()}
gentlest = min(
    zero_ripple_cams(motor.pistons, motor.lobes, count),
    key=lambda cam: np.max(np.abs(np.diff(cam.control_values(count), n=2))),
)
cams["zero ripple"] = gentlest.control_values(count)

for name, lift in cams.items():
    changed = eqx.tree_at(lambda each: each.cam.control_radii, motor, inner + stroke * lift)
    results = camring.summarise(camring.simulate(changed, system.fluid, system.operating_points[0]))
    print(
        f"{name:22} torque ripple {100 * float(results.torque_ripple):5.2f} %, "
        f"least undercut factor {float(results.min_undercut_factor):.2f}"
    )

"""A sweep: turn the valve plate, and see ripple and pressure peak follow."""

from pathlib import Path

import equinox as eqx
import numpy as np

import camring

system = camring.read_motor_file(Path(__file__).with_name("wheel_motor.toml")).system

for degrees in np.linspace(-1, 1, 9):
    motor = eqx.tree_at(lambda each: each.valve_plate.shift, system.motor, np.radians(degrees))
    cycle = camring.simulate(motor, system.fluid, system.operating_points[0])
    results = camring.summarise(cycle)
    print(
        f"{degrees:+5.2f}°  ripple {100 * results.torque_ripple:5.2f} %"
        f"  peak {results.max_pressure / 1e5:4.0f} bar"
    )

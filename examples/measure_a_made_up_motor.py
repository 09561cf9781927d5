"""Synthetic bench rows: the derivation's motor with other constants, and noise on what is read.

    python examples/measure_a_made_up_motor.py > examples/wheel_motor_measured.csv

gives the table that ships beside it; `camring fit` finds the constants again.
"""

from pathlib import Path

import equinox as eqx
import numpy as np

import camring
from camring.objective.measurable import measurable

file = camring.read_motor_file(Path(__file__).with_name("derivation_motor.toml"))
motor, fluid, point = file.system.motor, file.system.fluid, file.system.operating_points[0]
motor = eqx.tree_at(
    lambda m: (m.leakage.coefficient, m.friction.roller, m.orifice.discharge_coefficient),
    motor,
    tuple(np.array([2.4e-13, 0.011, 0.58])),
)
read = eqx.filter_jit(measurable)
names, factors = ("mean_torque", "supply_flow", "case_drain"), (1.0, 6e4, 6e4)
noise = np.array([0.004, 0.003, 0.02])
random = np.random.default_rng(5)

print("# Synthetic: the motor of derivation_motor.toml simulated with leakage_coefficient")
print("# 2.4e-13 m^3/(s*Pa), roller friction 0.011 and discharge_coefficient 0.58; noise of")
print("# 0.4 % on torque, 0.3 % on supply flow, 2 % on case drain. Return and case as there.")
print("shaft speed [rpm],supply pressure [bar],mean torque [Nm],supply flow [L/min],", end="")
print("case drain [L/min]")
for rpm in (20, 60, 120, 200, 300):
    for bar in (100, 175, 250, 350):
        values = np.array([rpm * np.pi / 30, bar * 1e5])
        varied = eqx.tree_at(lambda p: (p.shaft_speed, p.supply_pressure), point, tuple(values))
        found = read(camring.simulate(motor, fluid, varied), names)
        seen = np.array([float(found[name]) for name in names]) * factors
        torque, flow, drain = seen * (1 + noise * random.normal(size=3))
        print(f"{rpm},{bar},{torque:.1f},{flow:.2f},{drain:.3f}")

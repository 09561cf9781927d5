"""One motor at its operating points: what a data sheet would say, and is it true?"""

from pathlib import Path

import camring

motor_file = camring.read_motor_file(Path(__file__).with_name("wheel_motor.toml"))
system = motor_file.system

for point in system.operating_points:
    cycle = camring.simulate(system.motor, system.fluid, point)
    results = camring.summarise(cycle)
    print(
        f"{float(point.shaft_speed) * 9.5493:5.0f} rpm: {float(results.mean_torque):7.1f} N·m, "
        f"torque ripple {100 * float(results.torque_ripple):.2f} %, "
        f"efficiency {100 * float(results.efficiency):.2f} %"
    )
    assert cycle.verdict.sound, cycle.verdict.explain()

"""A stand-in for your own expensive model: camring runs it once for each design.

    camring optimise examples/wheel_motor.toml --out own --budget 14 \
        --evaluator "python examples/user_model.py" --timeout "60 s"

It reads one JSON document and prints one. This one simulates the motor, adds a loss
that camring's model does not have, a drag that grows with the windows' width, and takes
0.2 s longer than it needs. Yours would start a CFD run or ask a test rig.
"""

import json
import sys
import time

import camring
from camring.programs.compilation_cache import keep_compiled_programs

DRAG = 15.0  # N*m per radian of both windows' width, at 300 rpm

keep_compiled_programs()
asked = json.load(sys.stdin)
system = camring.read_motor_file(asked["motor_file"]).system
plate = system.motor.valve_plate
answer = []
for point in system.operating_points:
    cycle = camring.simulate(system.motor, system.fluid, point)
    results = camring.summarise(cycle)
    width = float(plate.supply.width + plate.return_.width)
    lost = DRAG * width * float(point.shaft_speed) / 31.4
    torque = float(results.mean_torque) - lost
    share = torque / float(results.mean_torque)
    answer.append(
        {
            "mean_torque": torque,
            "torque_ripple": float(results.torque_ripple) / share,
            "efficiency": float(results.efficiency) * share,
        }
    )
time.sleep(0.2)
json.dump({"results": answer}, sys.stdout)

"""Draws the picture of docs/guide/fmu.md: the wheel motor's FMU starts a load and lets it run down.

Run from the root of a checkout, with the extra `fmu`: `python docs/pictures/draw_fmu.py`.
"""

import tempfile
from math import pi
from pathlib import Path

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave
from matplotlib.figure import Figure

import camring
from camring.exchange.drawings import export

HERE = Path(__file__).parent
MOTOR = HERE.parent.parent / "examples" / "wheel_motor.toml"
STEP, STOP = 2e-4, 1.6  # s
INERTIA = 12.0  # kg m2
SUPPLY, RETURN, CASE = 200e5, 15e5, 2e5  # Pa; the last two are the operating points'


def supply_pressure(time: float) -> float:
    """Up to 200 bar in half a second, down from one second on."""
    up, down = np.clip(time / 0.5, 0, 1), np.clip((time - 1.0) / 0.3, 0, 1)
    return RETURN + (SUPPLY - RETURN) * (up - down)


def load(speed: float) -> float:
    """Rolling resistance and drag, N m."""
    return 500 * np.tanh(speed / 0.3) + 12 * speed


def run(fmu: Path) -> dict[str, np.ndarray]:
    """The importer: it owns the inertia, the motor's FMU the torque."""
    description = fmpy.read_model_description(str(fmu))
    number = {each.name: each.valueReference for each in description.modelVariables}
    inputs = [number[name] for name in ("speed", "supplyPressure", "returnPressure",
                                        "casePressure")]  # fmt: skip
    outputs = [number[name] for name in ("torque", "supplyFlow")]
    motor = FMU2Slave(
        guid=description.guid,
        unzipDirectory=fmpy.extract(str(fmu)),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="motor",
    )
    motor.instantiate()
    motor.setupExperiment(startTime=0.0)
    motor.enterInitializationMode()
    motor.exitInitializationMode()
    speed, rows = 0.0, []
    for time in STEP * np.arange(round(STOP / STEP)):
        motor.setReal(inputs, [speed, supply_pressure(time), RETURN, CASE])
        torque, flow = motor.getReal(outputs)
        rows.append((time, speed, torque, flow, supply_pressure(time)))
        motor.doStep(time, STEP)
        speed += STEP * (torque - load(speed)) / INERTIA
    motor.terminate()
    motor.freeInstance()
    return dict(zip(("time", "speed", "torque", "flow", "pressure"), np.array(rows).T, strict=True))


def figure(found: dict[str, np.ndarray]) -> Figure:
    """Speed, torque and flow over time."""
    drawn = Figure(figsize=(7.2, 5.6), layout="constrained")
    above = drawn.subplots(4, 1, sharex=True)
    curves = (
        (found["pressure"] / 1e5, "Supply, bar"),
        (found["speed"] * 30 / pi, "Speed, rpm"),
        (found["torque"], "Torque, N·m"),
        (found["flow"] * 6e4, "Supply flow, L/min"),
    )
    for axes, (values, label) in zip(above, curves, strict=True):
        axes.plot(found["time"], values, color="#1f4e79", linewidth=0.9)
        axes.set_ylabel(label)
        axes.grid(alpha=0.3)
    above[-1].set_xlabel("Time, s")
    drawn.align_ylabels()
    return drawn


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        written = export(camring.read_motor_file(MOTOR), folder, only=["fmu"])
        figure(run(written[0].path)).savefig(HERE / "fmu_start.png", dpi=110)

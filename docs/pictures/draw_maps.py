"""Draws the pictures of docs/guide/maps.md from the wheel motor of the examples.

Run from the root of a checkout: `python docs/pictures/draw_maps.py`.
"""

from pathlib import Path

import equinox as eqx
from matplotlib.figure import Figure

import camring
from camring import plots
from camring.files.units import to_si

HERE = Path(__file__).parent
MOTOR = HERE.parent.parent / "examples" / "wheel_motor.toml"
SHIFT = "motor.valve_plate.shift"
TURNED = "-0.55 deg"  # the quietest of the sweep
BEYOND = {"speed": "20 rpm..400 rpm", "pressure": "50 bar..450 bar"}  # its envelope


def figures() -> dict[str, Figure]:
    """Every picture of the page by its file's name."""
    file = camring.read_motor_file(MOTOR)
    motor, fluid, point = file.system.motor, file.system.fluid, file.system.operating_points[0]
    turned = eqx.tree_at(lambda each: each.valve_plate.shift, motor, to_si(TURNED, "rad"))
    cycles = [camring.simulate(each, fluid, point) for each in (motor, turned)]
    names = ("as given", f"plate turned by {TURNED.replace('-', '−')}")
    over = camring.operating_map(file, **BEYOND)
    along = camring.sweep(file, {SHIFT: "-2 deg..1 deg"}, points="61")
    both = camring.sweep(file, {SHIFT: "-2 deg..1 deg", "motor.valve_plate.ramp": "0.1..0.8"})
    return {
        "map_efficiency": plots.efficiency_map(over),
        "map_ripple": plots.ripple_map(over),
        "sweep_shift": plots.sweep_curves(along, ["torque_ripple", "efficiency", "max_pressure"]),
        "sweep_shift_ramp": plots.result_map(both, "torque_ripple"),
        "compare_waveforms": plots.waveforms(*cycles, labels=names),
        "compare_torque": plots.torque(*cycles, labels=names),
        "pressure_volume": plots.pressure_volume(*cycles, labels=names),
        "order_spectrum": plots.spectrum(*cycles, labels=names),
        "cam": plots.cam(motor),
    }


if __name__ == "__main__":
    for name, figure in figures().items():
        figure.savefig(HERE / f"{name}.png", dpi=90, pil_kwargs={"optimize": True})

"""Draws the README's second picture: the wheel motor before and after `camring optimise`.

Run from the root of a checkout: `python docs/pictures/draw_before_after.py [STUDY]`, STUDY the
folder of a finished study of `examples/wheel_motor.toml`; without it the study is run first.
"""

import sys
import tempfile
from math import pi
from pathlib import Path

import jax.numpy as jnp
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import camring
from camring import plots
from camring.drawing.palette import INK, QUIET, SUPPLY
from camring.plots.style import sheet, styled

HERE = Path(__file__).parent
MOTOR = HERE.parent.parent / "examples" / "wheel_motor.toml"
COLOURS = {"as given": QUIET, "found": SUPPLY}


@styled
def before_after(study: Path) -> Figure:
    """Lift of the cam over one lobe, and shaft torque at both operating points."""
    files = dict(
        zip(COLOURS, map(camring.read_motor_file, (MOTOR, study / "best.toml")), strict=True)
    )
    figure = sheet(8.6, 3.0)
    left, *right = figure.subplots(1, 3, width_ratios=[1, 1.1, 1.1])
    _lift(left, files)
    for place, axes in enumerate(right):
        _torque(axes, files, place)
    right[1].sharey(right[0])
    right[0].set_ylabel("Shaft torque, % of its mean")
    return figure


def _lift(axes: Axes, files: dict[str, "camring.MotorFile"]) -> None:
    angle = np.linspace(0, pi / 3, 721)
    for name, file in files.items():
        radius = np.asarray(file.system.motor.cam.pitch_radius(jnp.asarray(angle)).value)
        axes.plot(np.degrees(angle), 1e3 * (radius - radius.min()), color=COLOURS[name], label=name)
    axes.set(xlabel="Angle over one lobe, deg", ylabel="Lift of the roller, mm", xlim=(0, 60))
    axes.set_title("The cam")
    axes.legend(loc="lower center", fontsize=8)


def _torque(axes: Axes, files: dict[str, "camring.MotorFile"], place: int) -> None:
    angle = jnp.linspace(0, pi / 3, 721)
    said = []
    for name, file in files.items():
        cycle = camring.simulate(file)[place]
        torque = np.asarray(camring.waveforms(cycle, angle).torque)
        ripple = float(camring.summarise(cycle).torque_ripple)
        said.append(f"{100 * ripple:.1f}")
        axes.plot(np.degrees(angle), 100 * torque / torque.mean(), color=COLOURS[name])
    point = file.system.operating_points[place]
    speed = float(point.shaft_speed) * 30 / pi
    axes.set(xlabel="Shaft angle over one lobe, deg", xlim=(0, 60))
    axes.set_title(f"{speed:.0f} rpm: ripple {' to '.join(said)} %")
    axes.axhline(100, color=INK, linewidth=0.5)


def drawn(study: Path) -> None:
    """Write the picture beside this file."""
    plots.save(before_after(study), HERE / "before_after.png")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        drawn(Path(sys.argv[1]))
    else:
        with tempfile.TemporaryDirectory() as folder:
            camring.optimise(MOTOR, Path(folder) / "study")
            drawn(Path(folder) / "study")

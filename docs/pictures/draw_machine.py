"""Draws the first picture of the documentation: a radial-piston motor with its parts named.

Run from the root of a checkout: `python docs/pictures/draw_machine.py`.
The wheel motor of the examples to scale, beside it the torque of one piston and of all.
"""

from math import pi
from pathlib import Path

import jax.numpy as jnp
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon

import camring
from camring import plots
from camring.drawing.palette import INK, QUIET, RETURN, SUPPLY
from camring.plots.style import sheet, styled

HERE = Path(__file__).parent
MOTOR = HERE.parent.parent / "examples" / "wheel_motor.toml"
STEEL, BLOCK, PALE = "#c9d1d8", "#e6eaee", "#f6f8f9"
MILLIMETRE = 1e3
TURNED = 0.11  # rad, so that no piston stands on a dead centre


@styled
def machine() -> Figure:
    """Cross-section with names, and what the shaft feels."""
    file = camring.read_motor_file(MOTOR)
    system = file.system
    figure = sheet(8.6, 4.6)
    left, right = figure.subplots(1, 2, width_ratios=[1.35, 1])
    _cross_section(left, system.motor)
    cycle = camring.simulate(system.motor, system.fluid, system.operating_points[0])
    angle = jnp.linspace(0, pi / 3, 721)
    one = camring.waveforms(cycle, angle)
    piston = np.asarray(camring.waveforms(cycle, angle).torque)
    mean = float(camring.summarise(cycle).mean_torque)
    degrees = np.degrees(np.asarray(angle))
    right.plot(degrees, piston, color=INK, linewidth=1.8)
    right.axhline(mean, color=QUIET, linewidth=0.9, linestyle=(0, (4, 3)))
    alone = np.asarray(one.contact_force) * np.asarray(one.velocity)
    alone = alone / float(cycle.point.shaft_speed)
    right.plot(degrees, alone, color=SUPPLY, linewidth=1.4)
    right.annotate(
        "all 8 pistons: the ripple",
        (30, piston.max()),
        (30, piston.max() * 1.06),
        ha="center",
        va="bottom",
        fontsize=8.5,
    )
    right.annotate(
        "mean", (7.5, mean), (7.5, mean * 0.985), ha="center", va="top", fontsize=8, color=QUIET
    )
    right.annotate(
        "one piston: pushes for half a lobe",
        (14, alone.max()),
        (30, alone.max() * 1.12),
        ha="center",
        va="bottom",
        fontsize=8.5,
        color=SUPPLY,
    )
    right.set(
        xlabel="Shaft angle over one lobe, deg",
        ylabel="Torque, N m",
        xlim=(0, 60),
        ylim=(-0.06 * piston.max(), piston.max() * 1.2),
    )
    right.set_title("What the shaft feels")
    return figure


def _cross_section(axes: Axes, motor: "camring.Motor") -> None:
    angle = np.linspace(0, 2 * pi, 1441)
    radius = motor.cam.pitch_radius(jnp.asarray(angle))
    pitch, slope = (np.asarray(each) * MILLIMETRE for each in (radius.value, radius.first))
    roller = float(motor.roller.radius) * MILLIMETRE
    radial = np.stack([np.cos(angle), np.sin(angle)])
    along = np.stack([-np.sin(angle), np.cos(angle)])
    normal = (pitch * radial - slope * along) / np.hypot(pitch, slope)
    surface = pitch * radial + roller * normal
    outside = 1.14 * np.max(np.hypot(*surface))
    axes.add_patch(Circle((0, 0), outside, facecolor=STEEL, edgecolor=INK, linewidth=0.9))
    axes.add_patch(Polygon(surface.T, facecolor="white", edgecolor=INK, linewidth=1.3))
    inner = 0.985 * np.min(pitch) - roller
    axes.add_patch(Circle((0, 0), inner, facecolor=BLOCK, edgecolor=INK, linewidth=0.9))
    bore = float(motor.piston.bore) * MILLIMETRE
    for number in range(motor.pistons):
        _piston(axes, motor, TURNED + 2 * pi * number / motor.pistons, roller, bore, inner)
    axes.add_patch(Circle((0, 0), 0.30 * inner, facecolor=PALE, edgecolor=INK, linewidth=0.9))
    axes.text(0, 0, "shaft", ha="center", va="center", fontsize=8.5)
    names = (
        (
            "cam ring, 6 lobes,\nstands still",
            1.07 * outside * np.array([0.98, 0.62]),
            0.97 * outside * np.array([np.cos(0.42), np.sin(0.42)]),
        ),
        (
            "roller",
            1.07 * outside * np.array([0.98, -0.30]),
            _on(motor, TURNED - 0 * pi / 4 - pi / 4 * 0) * MILLIMETRE,
        ),
        (
            "chamber under supply",
            1.07 * outside * np.array([0.98, -0.62]),
            0.55 * inner * np.array([np.cos(TURNED - pi / 4), np.sin(TURNED - pi / 4)]),
        ),
        (
            "cylinder block,\nturns with the shaft",
            1.07 * outside * np.array([0.98, 0.24]),
            0.62 * inner * np.array([np.cos(0.50), np.sin(0.50)]),
        ),
    )
    for text, place, at in names:
        axes.annotate(
            text,
            at,
            place,
            fontsize=8.5,
            va="center",
            ha="left",
            arrowprops={"arrowstyle": "-", "color": QUIET, "linewidth": 0.8, "shrinkB": 0},
        )
    axes.annotate(
        "",
        0.36 * inner * np.array([np.cos(2.7), np.sin(2.7)]),
        0.36 * inner * np.array([np.cos(1.4), np.sin(1.4)]),
        arrowprops={
            "arrowstyle": "-|>",
            "color": INK,
            "connectionstyle": "arc3,rad=0.25",
            "linewidth": 1.2,
        },
    )
    axes.set(
        aspect="equal",
        xlim=(-1.03 * outside, 1.95 * outside),
        ylim=(-1.05 * outside, 1.05 * outside),
    )
    axes.axis("off")
    axes.set_title("Purple chambers see supply pressure, green ones the return")


def _on(motor: "camring.Motor", angle: float) -> np.ndarray:
    radius = float(motor.cam.pitch_radius(jnp.asarray(angle)).value)
    return radius * np.array([np.cos(angle), np.sin(angle)])


def _piston(
    axes: Axes, motor: "camring.Motor", angle: float, roller: float, bore: float, inner: float
) -> None:
    plate = motor.valve_plate
    under_supply = float(plate.opening(plate.supply, jnp.asarray(angle)))
    under_return = float(plate.opening(plate.return_, jnp.asarray(angle)))
    colour = "white"
    if under_supply > 0 or under_return > 0:
        colour = SUPPLY if under_supply > under_return else RETURN
    out, side = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    centre = _on(motor, angle) * MILLIMETRE
    crown = float(np.hypot(*centre)) - 0.75 * roller
    floor, foot = 0.42 * inner, crown - 0.95 * bore

    def box(low: float, high: float) -> list[np.ndarray]:
        return [
            low * out - bore / 2 * side,
            high * out - bore / 2 * side,
            high * out + bore / 2 * side,
            low * out + bore / 2 * side,
        ]

    axes.add_patch(
        Polygon(box(floor, foot), facecolor=colour, alpha=0.55, edgecolor=INK, linewidth=0.8)
    )
    axes.add_patch(Polygon(box(foot, crown), facecolor=STEEL, edgecolor=INK, linewidth=0.8))
    axes.add_patch(Circle(tuple(centre), roller, facecolor=PALE, edgecolor=INK, linewidth=1.0))


if __name__ == "__main__":
    plots.save(machine(), HERE / "machine.png")

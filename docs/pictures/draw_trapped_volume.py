"""Draws docs/pictures/trapped_volume.svg: a chamber closed too long, with both oils.

Run from the root of a checkout: `python docs/pictures/draw_trapped_volume.py`.
"""

from math import pi
from pathlib import Path

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jax import Array

from camring.files.motor import read_motor_file
from camring.physics.heat.simulation import simulate
from camring.physics.motor import Motor
from camring.physics.oil.fluid import ConstantFluid
from camring.physics.waves.waveforms import waveforms

HERE = Path(__file__).parent
MOTOR = HERE.parent.parent / "tests" / "published" / "data" / "mid_aerated.toml"
CLOSED = 11 * pi / 180  # of each half lobe pitch, rad
WIDTH, HEIGHT, LEFT, TOP, RIGHT, BOTTOM = 760, 420, 70, 40, 20, 50
COLOURS = {"constant modulus": "#b5432a", "with 0.5 % of air, mass conserved": "#1f6f9f"}


def window_widths(motor: Motor) -> tuple[Array, Array]:
    return motor.valve_plate.supply.width, motor.valve_plate.return_.width


def pressures() -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Chamber pressure over one lobe pitch, bar, for each oil."""
    system = read_motor_file(MOTOR).system
    air, point = system.fluid, system.operating_points[0]
    width = jnp.asarray(pi / 6 - CLOSED)
    motor = eqx.tree_at(window_widths, system.motor, (width, width))
    plain = ConstantFluid(
        air.density, air.bulk_modulus, air.vapour_pressure, air.transition_pressure
    )
    angle = jnp.linspace(0, pi / 3, 901)
    run = eqx.filter_jit(lambda oil: waveforms(simulate(motor, oil, point), angle))
    found = (run(oil).chamber_pressure / 1e5 for oil in (plain, air))
    return np.degrees(angle), dict(zip(COLOURS, map(np.asarray, found), strict=True))


def drawing(angle: np.ndarray, curves: dict[str, np.ndarray]) -> str:
    low = 500 * np.floor(min(c.min() for c in curves.values()) / 500)
    high = 500 * np.ceil(max(c.max() for c in curves.values()) / 500)
    across = (WIDTH - LEFT - RIGHT) / angle[-1]
    up = (HEIGHT - TOP - BOTTOM) / (high - low)

    def x(at: float) -> float:
        return LEFT + at * across

    def y(at: float) -> float:
        return HEIGHT - BOTTOM - (at - low) * up

    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
        'font-family="sans-serif" font-size="13">',
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
    ]
    for tick in np.arange(low, high + 1, 500):
        strong = "#555" if tick == 0 else "#ddd"
        parts.append(
            f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y(tick):.1f}" y2="{y(tick):.1f}" '
            f'stroke="{strong}"/>'
            f'<text x="{LEFT - 8}" y="{y(tick) + 4:.1f}" text-anchor="end">{tick:.0f}</text>'
        )
    for tick in range(0, 61, 10):
        parts.append(
            f'<text x="{x(tick):.1f}" y="{HEIGHT - BOTTOM + 20}" text-anchor="middle">{tick}</text>'
        )
    for k, (name, curve) in enumerate(curves.items()):
        points = " ".join(f"{x(a):.1f},{y(p):.1f}" for a, p in zip(angle, curve, strict=True))
        colour = COLOURS[name]
        parts.append(
            f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="2"/>'
        )
        label = f"{name}: {curve.min():.4g} to {curve.max():.4g} bar"
        parts.append(f'<text x="{LEFT + 150}" y="{TOP + 18 * k}" fill="{colour}">{label}</text>')
    parts.append(
        f'<text x="{WIDTH / 2}" y="{HEIGHT - 10}" text-anchor="middle">shaft angle, deg</text>'
        f'<text x="{LEFT}" y="{TOP - 20}">chamber pressure, bar (absolute)</text></svg>'
    )
    return "\n".join(parts) + "\n"


if __name__ == "__main__":
    (HERE / "trapped_volume.svg").write_text(drawing(*pressures()), encoding="utf-8")

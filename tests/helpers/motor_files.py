"""Motor files for the reader's tests, and ways to spoil them."""

import re
from pathlib import Path

import numpy as np

SOUND = (Path(__file__).parents[1] / "derivation" / "wheel_motor.toml").read_text()


def with_line(line, text=SOUND):
    """The text with the line that begins with the same key replaced, or put at its table's end."""
    key = re.escape(line.split("=")[0].strip())
    changed, count = re.subn(rf"^{key} = .*$", line.replace("\\", r"\\"), text, count=1, flags=re.M)
    assert count == 1, f"no line {key}"
    return changed


def without_line(key, text=SOUND):
    changed, count = re.subn(rf"^{re.escape(key)} = .*\n", "", text, count=1, flags=re.M)
    assert count == 1
    return changed


def added(table, line, text=SOUND):
    """The text with a line below the header of a table, or in a new table at the end."""
    if f"\n{table}\n" not in text:
        return f"{text}\n{table}\n{line}\n"
    return text.replace(f"\n{table}\n", f"\n{table}\n{line}\n", 1)


def without_table(header, text=SOUND):
    name = re.escape(header)
    return re.sub(rf"^{name}\n(?:(?!\[).*\n)*", "", text, flags=re.M)


def planar(repeats=6, count=12, spoil=None, text=SOUND):
    """The motor with a planar cam; `spoil` changes the points before they are written."""
    angle = 2 * np.pi / repeats * np.arange(count) / count
    radius = 0.0909 - 0.0061 * np.cos(6 * angle)
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    if spoil is not None:
        points = spoil(points)
    symmetry = 'symmetry = "ring"\n' if repeats == 1 else ""
    lines = f'representation = "planar"\n{symmetry}control_points = {points.tolist()}\n'
    text = re.sub(r"control_radii = \[[^\]]*\]\n", lines, text)
    return text.replace("modes = 8", "modes = 6")


def ring(count=96, text=SOUND):
    """The motor with control radii all round the ring."""
    radius = 0.0909 - 0.0061 * np.cos(6 * 2 * np.pi * np.arange(count) / count)
    lines = f'symmetry = "ring"\ncontrol_radii = {radius.tolist()}\n'
    return re.sub(r"control_radii = \[[^\]]*\]\n", lines, text)

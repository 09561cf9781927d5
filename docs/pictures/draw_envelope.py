"""Draws the pictures of two guides: what an envelope makes of the wheel motor.

Run from the root of a checkout: `python docs/pictures/draw_envelope.py`. Three motors over
speed and supply pressure, forwards: as given, the best of a search that knows the two
operating points alone, and the best of one that knows the envelope.
"""

import re
import tempfile
from dataclasses import replace
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

import camring
from camring import plots
from camring.evaluation.envelope_batch import at_points
from camring.physics.envelope import Envelope

matplotlib.use("Agg")
HERE = Path(__file__).parent
MOTOR = HERE.parent.parent / "examples" / "wheel_motor.toml"
SPEEDS, PRESSURES = 25, 25


def motors() -> dict[str, camring.MotorFile]:
    """The motor files of the three panels by their titles."""
    text = MOTOR.read_text()
    blind = re.sub(r"(?ms)^\[envelope\].*?(?=^\[|\Z)", "", text)
    blind = re.sub(r"(?m)^envelope_ripple = .*\n", "", blind)
    found = {"as given": camring.read_motor_file(MOTOR)}
    with tempfile.TemporaryDirectory() as scratch:
        for name, words in (
            ("best at two operating points", blind),
            ("best over the envelope", text),
        ):
            folder = Path(scratch) / name.replace(" ", "_")
            motor = folder.with_suffix(".toml")
            motor.write_text(words)
            camring.optimise(motor, folder)
            found[name] = camring.read_motor_file(folder / "best.toml")
    return found


def figure(found: dict[str, camring.MotorFile]) -> Figure:
    """Torque ripple in colour; hatched where a roller lifts off or a chamber cavitates."""
    given = next(iter(found.values()))
    assert given.envelope is not None
    envelope: Envelope = replace(given.envelope, both_directions=False)
    grid = envelope.grid(SPEEDS, PRESSURES)
    speeds = np.unique(grid.shaft_speed) * 30 / np.pi
    pressures = np.unique(grid.supply_pressure) / 1e5
    drawing = Figure(figsize=(9.6, 3.5), layout="constrained")
    panels = drawing.subplots(1, len(found), sharey=True)
    for panel, (title, file) in zip(panels, found.items(), strict=True):
        result = at_points(file.system, given.goal, envelope, grid)
        shape = (SPEEDS, PRESSURES)
        ripple = 100 * np.asarray(result.metrics.torque_ripple).reshape(shape)
        use = np.maximum(result.limits["min_contact_force"], result.limits["min_pressure"])
        image = panel.pcolormesh(
            speeds, pressures, ripple.T, norm=LogNorm(0.3, 12), cmap="viridis_r", shading="gouraud"
        )
        bad = use.reshape(shape).T > 0
        if bad.any():
            panel.contourf(
                speeds, pressures, bad, levels=[0.5, 1.5], colors="none", hatches=["////"]
            )
            panel.contour(speeds, pressures, bad, levels=[0.5], colors="k", linewidths=1)
        for point in given.system.operating_points:
            place = float(point.shaft_speed) * 30 / np.pi, float(point.supply_pressure) / 1e5
            panel.plot(*place, "o", color="white", markeredgecolor="black", clip_on=False)
        panel.set_xscale("log")
        panel.set_xticks([30, 60, 100, 300], labels=["30", "60", "100", "300"])
        panel.minorticks_off()
        share = 100 * np.count_nonzero(bad) / bad.size
        said = f"{title}\nmean ripple {ripple.mean():.2g} %, unusable {share:.0f} %"
        panel.set_title(said, fontsize=9)
        panel.set_xlabel("Shaft speed, rpm")
    panels[0].set_ylabel("Supply pressure, bar")
    bar = drawing.colorbar(image, ax=panels, ticks=[0.3, 1, 3, 10])
    bar.ax.set_yticklabels(["0.3", "1", "3", "10"])
    bar.set_label("Torque ripple, %")
    return drawing


def beside(found: dict[str, camring.MotorFile]) -> Figure:
    """Efficiency of the motor as given and of its best, for the guide of maps."""
    titles = ("as given", "best over the envelope")
    grids = [replace(camring.operating_map(found[title]), title=title) for title in titles]
    return plots.result_maps(grids, "efficiency")


if __name__ == "__main__":
    found = motors()
    figure(found).savefig(HERE / "envelope.png", dpi=110)
    beside(found).savefig(HERE / "map_beside.png", dpi=90, pil_kwargs={"optimize": True})

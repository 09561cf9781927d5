"""What the shipped motors lose as given, beside what makers publish, and where they run.

    python benchmarks/shipped_motors.py [NAME ...]

One row for each motor of the library (three of them are the examples) and for the template
of `camring new`: the efficiencies of ISO 4409 at the slowest and the fastest operating point,
and over the envelope, on a grid of 6 by 6 points in each direction of rotation, how many
points break a limit of the file and the least pressure that holds a roller on the ring. A
minute for each count of pistons and lobes on a busy machine, most of it compilation.
"""

import argparse
from dataclasses import fields, replace
from math import pi

import numpy as np

from camring.programs.compilation_cache import keep_compiled_programs

if __name__ == "__main__":  # before JAX is imported
    keep_compiled_programs()

from camring.evaluation.envelope_batch import AtPoints, at_points
from camring.files.motor import MotorFile, parse_motor_file
from camring.files.starting.library import library
from camring.files.starting.template import template
from camring.physics.envelope import EnvelopeGrid

CUBIC_CENTIMETRE, BAR, RPM = 1e-6, 1e5, pi / 30
POINTS = 6  # of the envelope, on each axis

STAFFA_HMB = "Kawasaki, Staffa HMB Series, data sheet M-2005/08.18 (2018)"
STAFFA_HMC = "Kawasaki, Staffa HMC Series, data sheet M-2002/03.17 (2017)"
PUBLISHED = (
    ("HMB125", 2050, 30.66, STAFFA_HMB),
    ("HMB150", 2470, 36.95, STAFFA_HMB),
    ("HMB200", 3087, 46.07, STAFFA_HMB),
    ("HMC325", 5326, 22110 / 275, STAFFA_HMC),
    ("HMC125", 125 * 16.387, 8220 / 275, STAFFA_HMC),
    ("HMC030", 492, 1655 / 241, STAFFA_HMC),
)
"""Motor, displacement in cm3, actual torque in N m for each bar, source."""


def published_rows() -> list[tuple[str, float, float, str]]:
    """Motor, displacement in L, hydromechanical efficiency, source."""
    return [
        (name, volume / 1e3, torque / (volume * CUBIC_CENTIMETRE * BAR / (2 * pi)), source)
        for name, volume, torque, source in PUBLISHED
    ]


def shipped() -> dict[str, str]:
    """The text of every motor by its name."""
    return {**library(), "template": template("sine")}


def everywhere(file: MotorFile, points: int = POINTS) -> AtPoints:
    """A motor at its operating points, then over its envelope."""
    assert file.envelope is not None
    rated = file.system.operating_points
    grid = file.envelope.grid(points, points)
    first = EnvelopeGrid(
        *(
            np.array([float(getattr(each, name)) for each in rated])
            for name in ("shaft_speed", "supply_pressure", "return_pressure", "case_pressure")
        ),
        backwards=np.array([each.reverse for each in rated]),
        fluid=np.zeros(len(rated), int),
    )
    both = EnvelopeGrid(
        *(
            np.concatenate([getattr(first, each.name), getattr(grid, each.name)])
            for each in fields(EnvelopeGrid)
        )
    )
    # A name would cost a compilation.
    system = replace(file.system, motor=replace(file.system.motor, name=""))
    return at_points(system, file.goal, file.envelope, both)


def row(name: str, file: MotorFile, found: AtPoints) -> str:
    """One line of the table."""
    count, metrics = len(file.system.operating_points), found.metrics
    speeds = found.grid.shaft_speed[:count]
    slow, fast = int(np.argmin(speeds)), int(np.argmax(speeds))
    broken = np.max(np.stack(list(found.limits.values())), axis=0) > 0
    held = metrics.min_contact_force / float(file.system.motor.piston.area) / BAR
    return (
        f"{name:9} {1e3 * metrics.displacement[0]:6.2f}"
        f" {speeds[slow] / RPM:6.0f} {metrics.hydromechanical_efficiency[slow]:8.3f}"
        f" {metrics.volumetric_efficiency[slow]:6.3f} {metrics.efficiency[slow]:6.3f}"
        f" {speeds[fast] / RPM:6.0f} {metrics.efficiency[fast]:6.3f}"
        f" {100 * metrics.torque_ripple[slow]:6.2f} {100 * metrics.torque_ripple[fast]:5.2f}"
        f" {metrics.max_contact_stress[:count].max() / 1e9:6.2f}"
        f" {int(np.sum(broken[count:])):4d} of {len(broken) - count:3d} {held[count:].min():6.1f}"
    )


def main(names: list[str]) -> None:
    print("Published          L/rev  hydromechanical")
    for name, litres, efficiency, source in published_rows():
        print(f"{name:16} {litres:7.2f} {efficiency:8.3f}          {source}")
    print()
    print("                 ---- slow: rpm, hydromechanical, volumetric, total; fast: rpm, total;")
    print("                      ripple slow and fast %, stress GPa; envelope: points broken,")
    print("                      least pressure on a roller bar")
    for name, text in shipped().items():
        if not names or name in names:
            file = parse_motor_file(text)
            print(row(name, file, everywhere(file)), flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help="motors; all unless given")
    main(parser.parse_args().names)

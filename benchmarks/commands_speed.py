"""How long commands take that simulate many operating points: in batches, and one by one.

    python benchmarks/commands_speed.py [--motor MOTOR.toml] [--only map fit sweep fmu simulate]

Once to compile, once to measure: processor time of the second, and by the clock. "One by
one" is the way of motors that batches cannot hold, with the same programs as `camring
simulate`, on all cores. `simulate` is measured as a command, in processes of its own: the
first has no compiled programs, the second finds them.
"""

import argparse
import contextlib
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

from camring.analyses.operating_map import operating_map
from camring.analyses.sweep import sweep
from camring.evaluation.simulations import repeated, results_of_many, stacked
from camring.exchange.fmu.axes import Ranges, axes_of
from camring.exchange.fmu.filling import filled_table
from camring.files.motor import MotorFile, read_motor_file
from camring.fitting.fit import fit
from camring.fitting.measurements.table import MeasuredTable, parse_measured_table
from camring.numerics.quantity import real

EXAMPLES = Path(__file__).parents[1] / "examples"
CAMRING = "from camring.cli.app import main; main()"
WHO_ASKS = ("evaluation.simulations", "fitting.batch_rows", "exchange.fmu.places")
RPM, BAR = np.pi / 30, 1e5
ROWS = 400
NOISE = (0.004, 0.003, 0.02)  # of torque, supply flow and case drain
HEAD = (
    "shaft speed [rpm],supply pressure [bar],"
    "mean torque [Nm],supply flow [L/min],case drain [L/min]"
)


@contextlib.contextmanager
def one_by_one() -> Iterator[None]:
    """No motor fits into a batch."""
    with contextlib.ExitStack() as stack:
        for name in WHO_ASKS:
            stack.enter_context(patch(f"camring.{name}.fits", lambda motor: False))
        yield


def measured_rows(file: MotorFile) -> MeasuredTable:
    """So many rows of operating points of their own, made by the motor itself, with noise."""
    random, first = np.random.default_rng(0), file.system.operating_points[0]
    fastest = max(float(each.shaft_speed) for each in file.system.operating_points) / RPM
    highest = max(float(each.supply_pressure) for each in file.system.operating_points) / BAR
    rpm = random.uniform(0.1 * fastest, fastest, ROWS)
    bar = random.uniform(0.25 * highest, highest, ROWS)
    points = stacked(
        [
            replace(first, shaft_speed=real(speed * RPM), supply_pressure=real(pressure * BAR))
            for speed, pressure in zip(rpm, bar, strict=True)
        ]
    )
    system = file.system
    found, _ = results_of_many(repeated(system.motor, ROWS), repeated(system.fluid, ROWS), points)
    results = found.mean_torque, 6e4 * found.supply_flow, 6e4 * found.case_drain
    noisy = [
        each * (1 + share * random.normal(size=ROWS))
        for each, share in zip(results, NOISE, strict=True)
    ]
    rows = np.stack([rpm, bar, *noisy], axis=1).tolist()
    return parse_measured_table("\n".join([HEAD, *(",".join(map(repr, row)) for row in rows)]))


def tasks(file: MotorFile) -> dict[str, Callable[[], Any]]:
    table: list[MeasuredTable] = []

    def fitted() -> Any:
        if not table:
            table.append(measured_rows(file))
        return fit(file, table[0])

    volume = float(file.system.motor.dead_volume) * 1e6
    ranges = {
        "motor.valve_plate.shift": "-0.5..0.5 deg",
        "motor.dead_volume": f"{0.9 * volume:g}..{1.1 * volume:g} cm^3",
    }
    return {
        "map, 40 x 20": lambda: operating_map(file, points="40x20"),
        f"fit, {ROWS} rows": fitted,
        "sweep, 21 x 21": lambda: sweep(file, ranges),
        "fmu, its table": lambda: filled_table(file, axes_of(file, Ranges())),
    }


def spent(task: Callable[[], Any]) -> tuple[float, float]:
    """Processor time and time by the clock of the second call."""
    task()
    used, began = time.process_time(), time.perf_counter()
    task()
    return time.process_time() - used, time.perf_counter() - began


def command(cache: str, *words: str) -> tuple[float, float]:
    """The same of a command in a process of its own."""
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    environment = {**os.environ, "CAMRING_CACHE": cache}
    environment.pop("CAMRING_PROGRAMS", None)
    subprocess.run(
        [sys.executable, "-c", CAMRING, *words],
        env=environment,
        stdout=subprocess.DEVNULL,
        check=True,
    )
    wall, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return used, wall


def row(name: str, first: tuple[float, float], second: tuple[float, float]) -> None:
    ratio = first[0] / second[0]
    cells = (f"{used:.2f} s, {wall:.2f} s" for used, wall in (first, second))
    print(f"| {name} | {' | '.join(cells)} | {ratio:.1f} |", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--motor", type=Path, default=EXAMPLES / "derivation_motor.toml")
    names = ("map", "fit", "sweep", "fmu", "simulate")
    parser.add_argument("--only", nargs="+", choices=names, default=names)
    asked = parser.parse_args()
    file = read_motor_file(asked.motor)
    print("| what | one by one: processor, clock | in batches | ratio of processor times |")
    print("|---|---|---|---|")
    for name, task in tasks(file).items():
        if name.split(",")[0] in asked.only:
            batched = spent(task)
            with one_by_one():
                alone = spent(task)
            row(name, alone, batched)
    if "simulate" in asked.only:
        with tempfile.TemporaryDirectory() as cache:
            first, again = (command(cache, "simulate", str(asked.motor)) for _ in range(2))
        row("simulate: the first time, and again", first, again)


if __name__ == "__main__":
    main()

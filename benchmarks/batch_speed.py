"""How fast many designs are evaluated side by side, how right they are, and what it takes.

    python benchmarks/batch_speed.py [--designs 20000] [--million]

The designs are random points of the wheel motor's design space at its first operating
point; every result of docs/theory.md section 10, the objective and all constraints are
computed. Rivals in the same run: SciPy's LSODA at tolerance 1e-9 giving the same results,
this program's own solver of one motor under `vmap`, and batches as JAX compiles them,
256 at a time. Times are by the clock, all threads at work, unless they are called
processor time: that is of one call, all its threads added up. Errors are against the
solver of one motor at 640 elements.
"""

import argparse
import json
import os
import resource
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from stopwatch import processor_times, wall_times
from wheel_motor import (
    as_given,
    at_one_point,
    free_ring,
    of_twenty_variables,
    with_air,
    with_every_law,
    with_heat,
)

from camring.evaluation.batch import CHUNK, assess_and_keep, cores, evaluate_many, slopes_in_batch
from camring.metrics.summary import summarise
from camring.objective.batch import measure_designs
from camring.objective.design_space import DesignSpace
from camring.objective.objective import Goal, evaluate
from camring.physics.batch_cycle import BatchResolution
from camring.physics.heat.simulation import simulate
from camring.physics.resolution import Resolution
from camring.physics.system import System
from camring.programs.batch_program import SWITCH, BatchProgram
from camring.programs.compiled import slopes as slopes_alone
from camring.programs.compiled import solve
from camring.reference import independent_results

RESULTS = Path(__file__).with_name("results") / "batch_speed.json"
OF_BATCHES = {"search": BatchResolution.search(), "final": BatchResolution()}
OF_ONE_MOTOR = {"search": Resolution.coarse(), "final": Resolution()}
OF_OBJECTIVE = ("torque_ripple", "pressure_ripple", "efficiency", "jerk_objective")
EXTREMES = ("max_pressure", "max_contact_stress")
JAX_CHUNK = 256
SOME = 256
"""Designs where times are long, or counted by processor."""

Given = tuple[DesignSpace, System, Goal]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--designs", type=int, default=20_000)
    parser.add_argument("--million", action="store_true", help="evaluate a million designs as well")
    parser.add_argument("--json", type=Path, default=RESULTS, help="where the figures go, too")
    asked = parser.parse_args()

    file = as_given()
    given = file.design_space, at_one_point(file.system), file.goal
    points = points_of(given, asked.designs)
    of_million = None
    if asked.million:  # first, while the process holds nothing else
        of_million = million(given)
        print("A million designs: {:.3g} s, {:.2f} GiB at most.\n".format(*of_million))

    rows = speeds(given, points)
    rival = next(iter(rows.values()))
    print(f"{cores()} cores")
    print("| what | a design | designs a second | times faster than SciPy |\n|---|---|---|---|")
    for name, value in rows.items():
        print(f"| {name} | {microseconds(value)} | {1 / value:,.0f} | {rival / value:,.0f} |")

    costs = slope_costs(given)
    print("\n| slopes, search, processor time | evaluation | slopes | ratio |\n|---|---|---|---|")
    for name, (once, slopes) in costs.items():
        print(f"| {name} | {microseconds(once)} | {microseconds(slopes)} | {slopes / once:.3g} |")

    rings = ring_costs(given[1])
    print("\n| cycles and results, search, processor time | a design | ratio |\n|---|---|---|")
    for name, value in rings.items():
        print(f"| {name} | {microseconds(value)} | {value / rings['lobe']:.3g} |")

    laws = law_costs(given)
    print("\n| laws, processor time of one design | search | final | ratios |\n|---|---|---|---|")
    for name, values in laws.items():
        ratios = ", ".join(f"{each:.3g}" for each in np.divide(values, laws["plain"]))
        print(f"| {name} | {' | '.join(map(microseconds, values))} | {ratios} |")

    errors = accuracy(given, points[:64])
    print("\n| resolution | objective terms, median and worst | mean torque | extremes |")
    print("|---|---|---|---|")
    for name, found in errors.items():
        print(f"| {name} | " + " | ".join(found) + " |")

    off = slope_errors(given, points[:32])
    print("\n| slopes of 32 designs | off by, of the objective's largest: median | worst |")
    print("|---|---|---|")
    for name, value in off.items():
        print(f"| {name} | {np.median(value):.1e} | {max(value):.1e} |")

    growth = {}
    for count in (CHUNK, 4 * CHUNK, 16 * CHUNK, 64 * CHUNK):
        many = np.resize(points, (count, points.shape[1]))
        growth[count] = wall_times(partial(evaluate_many, *given, many), 2)[0]
    print("\n| designs | seconds |\n|---|---|")
    for count, value in growth.items():
        print(f"| {count:,} | {value:.3g} |")
    written = {
        "seconds": rows,
        "slope_seconds": costs,
        "ring_seconds": rings,
        "law_seconds": laws,
        "errors": errors,
        "slopes": off,
        "growth": growth,
        "million": of_million,
    }
    asked.json.parent.mkdir(exist_ok=True)
    asked.json.write_text(json.dumps(written, indent=1) + "\n")


def microseconds(seconds: float) -> str:
    return f"{1e6 * seconds:,.{1 if seconds < 1e-4 else 0}f} µs"


def points_of(given: Given, count: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).uniform(size=(count, given[0].dimension))


@contextmanager
def compiled_by_jax() -> Iterator[None]:
    """Within it, batches go through JAX's compiler."""
    before = os.environ.get(SWITCH)
    os.environ[SWITCH] = "off"
    try:
        yield
    finally:
        del os.environ[SWITCH]
        if before is not None:
            os.environ[SWITCH] = before


def million(given: Given) -> tuple[float, float]:
    """Seconds that a million designs take, compilation included, and GiB of memory."""
    many = points_of(given, 1_000_000, seed=1)
    started = time.perf_counter()
    evaluate_many(*given, many)
    seconds = time.perf_counter() - started
    return seconds, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20


def speeds(given: Given, points: np.ndarray) -> dict[str, float]:
    """Seconds a design by the clock; the rival first."""
    space, system, goal = given
    motor, fluid, point = system.motor, system.fluid, system.operating_points[0]
    rival = partial(independent_results, motor, fluid, point, goal.harmonics, 1e-9)
    rows = {"SciPy LSODA, tolerance 1e-9": wall_times(rival, 1)[0]}
    for name, resolution in OF_ONE_MOTOR.items():

        def assessed(at, resolution=resolution):
            return evaluate(space.apply(system, at), goal, resolution)

        alone = partial(eqx.filter_jit(jax.vmap(assessed)), points[:SOME])
        rows[f"one by one under vmap, {name}"] = wall_times(alone, 3)[0] / len(points[:SOME])
    for oil, of_oil in (("", system), (", with air", with_air(system))):
        for name, resolution in OF_BATCHES.items():
            fewer = points[: max(len(points) // 8, JAX_CHUNK)]
            run_batch = partial(evaluate_many, space, of_oil, goal)
            with compiled_by_jax():
                taken = wall_times(partial(run_batch, fewer, resolution, chunk=JAX_CHUNK), 3)[0]
            rows[f"batch by JAX's compiler, {name}{oil}"] = taken / len(fewer)
            taken = wall_times(partial(run_batch, points, resolution), 3)[0]
            rows[f"batch, {name}{oil}"] = taken / len(points)
    return rows


def slope_costs(given: Given) -> dict[str, tuple[float, float]]:
    """Processor seconds a design of an evaluation, and of all slopes from cycles at hand."""
    file = of_twenty_variables()
    wider = file.design_space, at_one_point(file.system), file.goal

    def costs(given: Given) -> tuple[float, float]:
        points, resolution = points_of(given, SOME), OF_BATCHES["search"]
        cycles, _ = assess_and_keep(*given, points, resolution)
        once = partial(evaluate_many, *given, points, resolution, threads=1, chunk=SOME)
        slopes = partial(slopes_in_batch, *given, points, cycles, resolution)
        return processor_times(once, 5)[0] / SOME, processor_times(slopes, 5)[0] / SOME

    with compiled_by_jax():
        rows = {f"{given[0].dimension} variables, by JAX's compiler": costs(given)}
    return rows | {f"{each[0].dimension} variables": costs(each) for each in (given, wider)}


def ring_costs(system: System, count: int = 64) -> dict[str, float]:
    """Processor seconds a design, for one lobe and for a ring of six that may differ."""
    measure, rows = BatchProgram(measure_designs), {}
    for name, each in (("lobe", system), ("free ring of 6 lobes", free_ring(system))):
        designs = jax.tree.map(
            lambda leaf: np.broadcast_to(np.asarray(leaf)[..., None], (*leaf.shape, count)), each
        )
        run = partial(measure, designs, 600, OF_BATCHES["search"])
        rows[name] = processor_times(run, 5)[0] / count
    return rows


def law_costs(given: Given) -> dict[str, list[float]]:
    """Processor seconds of a design of the space at either resolution, by the motor's laws."""
    space, plain, goal = given
    points, rows = points_of(given, SOME), {}
    kinds = {"plain": plain, "with air": with_air(plain)}
    kinds |= {"every law": with_every_law(plain), "every law and heat": with_heat(plain)}
    for name, system in kinds.items():
        run = partial(evaluate_many, space, system, goal, points, threads=1, chunk=SOME)
        rows[name] = [
            processor_times(partial(run, resolution), 20)[0] / SOME
            for resolution in OF_BATCHES.values()
        ]
    return rows


def accuracy(given: Given, points: np.ndarray) -> dict[str, list[str]]:
    """Errors of some results against a fine solution of each design by itself."""
    space, system, goal = given
    fine = Resolution(elements=640)

    @eqx.filter_jit
    def exact(points):
        def one(at):
            design = space.apply(system, at)
            cycle = simulate(design.motor, design.fluid, design.operating_points[0], fine)
            return summarise(cycle, goal.harmonics)

        return jax.lax.map(one, points, batch_size=8)

    truth = exact(points)
    found = {}
    for name, resolution in OF_BATCHES.items():
        metrics = evaluate_many(*given, points, resolution).metrics[0]
        errors = {
            each: np.abs(getattr(metrics, each) / np.asarray(getattr(truth, each)) - 1)
            for each in (*OF_OBJECTIVE, "mean_torque", *EXTREMES)
        }
        found[name] = [
            f"{max(np.median(errors[each]) for each in group):.1e}, "
            f"{max(np.max(errors[each]) for each in group):.1e}"
            for group in (OF_OBJECTIVE, ("mean_torque",), EXTREMES)
        ]
    return found


def slope_errors(given: Given, points: np.ndarray) -> dict[str, list[float]]:
    """Each design's largest difference of the objective's slopes from those by itself."""
    space, system, goal = given
    alone = [
        slopes_alone(space, system, at, solve(space.apply(system, at), goal), goal).objective
        for at in jnp.asarray(points)
    ]
    errors = {}
    for name, resolution in OF_BATCHES.items():
        cycles, _ = assess_and_keep(*given, points, resolution)
        found = slopes_in_batch(*given, points, cycles, resolution).objective
        errors[name] = [
            float(np.max(np.abs(found[:, place] - one)) / np.max(np.abs(one)))
            for place, one in enumerate(alone)
        ]
    return errors


if __name__ == "__main__":
    main()

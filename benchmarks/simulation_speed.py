"""How long simulating takes: one motor, a batch, and the detailed laws beside the first.

    python benchmarks/simulation_speed.py [--designs 1000]

Everything is measured in one run against a rival in the same run: SciPy's LSODA at
tolerance 1e-9 on the same motor (`reference`), which gives results of the
same accuracy. All results of docs/theory.md section 10 are computed, not pressure alone. A
second table has how far the results of one motor are from that solver at 1e-11, by
`simulate` and `summarise` and as a batch of one, final resolution either way.
"""

import argparse
import json
import os
import statistics
from collections.abc import Callable
from functools import partial
from pathlib import Path

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from stopwatch import wall_times
from wheel_motor import aerated, as_given, at_one_point

from camring.metrics.error_estimate import relative_error
from camring.metrics.summary import Metrics, summarise
from camring.objective.batch import measure_designs
from camring.objective.slopes import Operated, directions, result_slopes, results_used
from camring.physics.batch_cycle import BatchResolution
from camring.physics.heat.simulation import simulate
from camring.physics.resolution import Resolution
from camring.physics.system import System
from camring.programs.batch_program import BatchProgram
from camring.reference import independent_results

RESULTS = Path(__file__).with_name("results") / "simulation_speed.json"
REPEATS = 9


def seconds(action: Callable[[], object], repeats: int = REPEATS) -> float:
    return statistics.median(wall_times(action, repeats))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--designs", type=int, default=1000)
    parser.add_argument("--json", type=Path, default=RESULTS, help="where the figures go, too")
    asked = parser.parse_args()
    designs = asked.designs

    motor_file = as_given()
    system = motor_file.system
    motor, fluid, point = system.motor, system.fluid, system.operating_points[0]
    harmonics = motor_file.goal.harmonics

    # Two programs, as in `camring.simulate` and `camring.summarise`.
    def programs(resolution: Resolution, batched: bool):
        def cycle_of(motor, fluid):
            return simulate(motor, fluid, point, resolution)

        def metrics_of(cycle):
            return summarise(cycle, harmonics)

        if batched:
            axes = eqx.tree_at(
                lambda m: m.cam.control_radii, jax.tree.map(lambda _: None, motor), 0, is_leaf=none
            )
            cycle_of = eqx.filter_vmap(cycle_of, in_axes=(axes, None))
            metrics_of = eqx.filter_vmap(metrics_of)
        first, second = eqx.filter_jit(cycle_of), eqx.filter_jit(metrics_of)
        return lambda radii, fluid: second(first(with_radii(radii), fluid))

    def none(leaf):
        return leaf is None

    def with_radii(radii):
        return eqx.tree_at(lambda m: m.cam.control_radii, motor, radii)

    radii = motor.cam.control_radii
    random = np.random.default_rng(0)
    wobble = 1e-4 * jnp.ptp(radii) * random.normal(size=(designs, *radii.shape))
    many = radii + jnp.asarray(wobble)

    rows, off = {}, {}
    in_batch = BatchProgram(measure_designs)
    rival = seconds(lambda: independent_results(motor, fluid, point, harmonics, 1e-9), repeats=1)
    rows["SciPy LSODA, tolerance 1e-9"] = rival
    for name_of_oil, oil in (("constant modulus", fluid), ("with air", aerated(fluid))):
        whole = jax.jit(
            lambda radii, oil=oil: summarise(simulate(with_radii(radii), oil, point), harmonics)
        )
        rows[f"one motor in one program, {name_of_oil}"] = seconds(lambda whole=whole: whole(radii))
        one = programs(Resolution(), batched=False)
        name = f"one motor by `simulate` and `summarise`, {name_of_oil}"
        rows[name] = seconds(lambda one=one, oil=oil: one(radii, oil))
        alone = one_design(eqx.tree_at(lambda each: each.fluid, at_one_point(system), oil))
        measured = partial(in_batch, alone, harmonics, BatchResolution())
        rows[f"one motor as a batch of one, {name_of_oil}"] = seconds(measured)
        truth = independent_results(motor, oil, point, harmonics, 1e-11)
        ((metrics,), _) = measured()
        found = {
            "one motor": one(radii, oil),
            "as a batch of one": jax.tree.map(lambda leaf: leaf[0], metrics),
        }
        off[name_of_oil] = {name: differences(each, truth) for name, each in found.items()}
        for name, resolution in (("final", Resolution()), ("search", Resolution.coarse())):
            batch = programs(resolution, batched=True)
            rows[f"each of {designs}, {name} resolution, {name_of_oil}"] = (
                seconds(lambda batch=batch, oil=oil: batch(many, oil), repeats=3) / designs
            )

    space, goal, names = motor_file.design_space, motor_file.goal, results_used(motor_file.goal)
    along = directions(space, system, space.locate(system))
    several = Operated(along.motor, along.fluid, along.operating_points[0])
    cycle = eqx.filter_jit(simulate)(motor, fluid, point)
    of_results = eqx.filter_jit(result_slopes)
    name = (
        f"gradients of what the objective uses by {space.dimension} variables, from a cycle at hand"
    )
    rows[name] = seconds(lambda: of_results(cycle, several, names, goal.harmonics))

    print(f"{os.cpu_count()} cores; wheel motor at {float(point.shaft_speed) * 9.5493:.0f} rpm")
    print("| what | time | times faster than SciPy |\n|---|---|---|")
    for name, value in rows.items():
        print(f"| {name} | {1e3 * value:.4g} ms | {rival / value:.0f} |")
    asked.json.parent.mkdir(exist_ok=True)
    asked.json.write_text(json.dumps({"seconds": rows, "off": off}, indent=1) + "\n")
    for name_of_oil, columns in off.items():
        print(f"\n| {name_of_oil}: off by | " + " | ".join(columns) + " |\n|---|---|---|")
        for name in next(iter(columns.values())):
            shares = (f"{each.get(name, np.nan):.1e}" for each in columns.values())
            print(f"| {name.replace('_', ' ')} | " + " | ".join(shares) + " |")


def one_design(system: System) -> System:
    return jax.tree.map(lambda leaf: np.asarray(leaf)[..., None], system)


def differences(metrics: Metrics, truth: dict[str, float]) -> dict[str, float]:
    """Of each result, over it or over what it is small beside (`relative_error`)."""
    values = {name: float(value) for name, value in vars(metrics).items()}
    apart = Metrics(**{name: abs(each - truth.get(name, each)) for name, each in values.items()})
    return {name: share for name, share in relative_error(metrics, apart).items() if name in truth}


if __name__ == "__main__":
    main()

"""How long simulating takes: one motor, a batch, and the second rung beside the first.

    python benchmarks/simulation_speed.py [--designs 1000]

Everything is measured in one run against a rival in the same run: SciPy's LSODA at
tolerance 1e-9 on the same motor (`metrics/independent`), which gives results of the
same accuracy. All results of model.md section 10 are computed, not pressure alone.
"""

import argparse
import json
import os
import statistics
import time
from collections.abc import Callable
from pathlib import Path

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

import camring
from camring.metrics.independent import independent_results
from camring.metrics.summary import summarise
from camring.physics.aerated_fluid import AeratedFluid
from camring.physics.cycle import simulate
from camring.physics.fluid import AbstractFluid
from camring.physics.resolution import Resolution

ROOT = Path(__file__).parents[1]
RESULTS = Path(__file__).with_name("results")
REPEATS = 9


def seconds(action: Callable[[], object], repeats: int = REPEATS) -> float:
    """Median wall time, after one run that compiles."""
    jax.block_until_ready(action())
    times = []
    for _ in range(repeats):
        started = time.perf_counter()
        jax.block_until_ready(action())
        times.append(time.perf_counter() - started)
    return statistics.median(times)


def aerated(fluid: AbstractFluid) -> AeratedFluid:
    """The same oil with half a per cent of air."""
    return AeratedFluid(
        fluid.density, fluid.bulk_modulus, fluid.vapour_pressure, fluid.transition_pressure
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--designs", type=int, default=1000)
    designs = parser.parse_args().designs

    motor_file = camring.read_motor_file(ROOT / "examples" / "wheel_motor.toml")
    system = motor_file.system
    motor, fluid, point = system.motor, system.fluid, system.operating_points[0]
    harmonics = motor_file.goal.harmonics

    def all_results(resolution: Resolution, fluid: AbstractFluid):
        def run(radii):
            changed = eqx.tree_at(lambda m: m.cam.control_radii, motor, radii)
            return summarise(simulate(changed, fluid, point, resolution), harmonics)

        return run

    radii = motor.cam.control_radii
    random = np.random.default_rng(0)
    wobble = 1e-4 * jnp.ptp(radii) * random.normal(size=(designs, *radii.shape))
    many = radii + jnp.asarray(wobble)

    rows = {}
    rival = seconds(lambda: independent_results(motor, fluid, point, harmonics, 1e-9), repeats=1)
    rows["SciPy LSODA, tolerance 1e-9"] = rival
    for rung, oil in (("constant modulus", fluid), ("with air", aerated(fluid))):
        one = jax.jit(all_results(Resolution(), oil))
        rows[f"one motor, {rung}"] = seconds(lambda one=one: one(radii))
        for name, resolution in (("final", Resolution()), ("search", Resolution.coarse())):
            batch = jax.jit(jax.vmap(all_results(resolution, oil)))
            rows[f"each of {designs}, {name} resolution, {rung}"] = (
                seconds(lambda batch=batch: batch(many), repeats=3) / designs
            )

    print(f"{os.cpu_count()} cores; wheel motor at {float(point.shaft_speed) * 9.5493:.0f} rpm")
    print("| what | time | times faster than SciPy |\n|---|---|---|")
    for name, value in rows.items():
        print(f"| {name} | {1e3 * value:.4g} ms | {rival / value:.0f} |")
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / "simulation_speed.json").write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()

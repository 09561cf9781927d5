"""How fast many designs are judged side by side, how right they are, and what it takes.

    python benchmarks/batch_speed.py [--designs 20000] [--million]

The designs are random points of the wheel motor's design space at its first operating
point; every result of model.md section 10, the objective and all constraints are
computed. Rivals in the same run: SciPy's LSODA at tolerance 1e-9 giving the same results,
and this program's own solver of one motor under `vmap`, which is how batches went
before. Errors are against that solver at 640 elements, 64 designs.
"""

import argparse
import json
import os
import resource
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from stopwatch import wall_times

import camring
from camring.interfaces.compiled import slopes as slopes_alone
from camring.interfaces.compiled import solve
from camring.interfaces.many import CHUNK, evaluate_many
from camring.metrics.independent import independent_results
from camring.metrics.lane_summary import summarise_lanes
from camring.metrics.summary import summarise
from camring.objective.design_space import DesignSpace
from camring.objective.lanes import designs_in_lanes, slopes_of_designs, solve_designs
from camring.objective.objective import Goal, evaluate
from camring.physics.aerated_fluid import AeratedFluid
from camring.physics.cycle import simulate
from camring.physics.lane_cycle import LanesLook
from camring.physics.resolution import Resolution
from camring.physics.system import System

ROOT = Path(__file__).parents[1]
RESULTS = Path(__file__).with_name("results")
LOOKS = {"search": LanesLook.search(), "final": LanesLook()}
OF_OBJECTIVE = ("torque_ripple", "pressure_ripple", "efficiency", "jerk_objective")
EXTREMES = ("max_pressure", "max_contact_stress")


def fastest(action: Callable[[], object], repeats: int = 3) -> float:
    return wall_times(action, repeats)[0]


def with_air(system: System) -> System:
    oil = system.fluid
    air = AeratedFluid(oil.density, oil.bulk_modulus, oil.vapour_pressure, oil.transition_pressure)
    return eqx.tree_at(lambda each: each.fluid, system, air)


def free_ring(system: System) -> System:
    """The same motor, its ring described lobe by lobe."""
    cam = system.motor.cam
    ring = type(cam)(jnp.tile(cam.control_radii, cam.repeats), repeats=1, degree=cam.degree)
    return eqx.tree_at(lambda each: each.motor.cam, system, ring)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--designs", type=int, default=20_000)
    parser.add_argument("--million", action="store_true", help="judge a million designs as well")
    asked = parser.parse_args()

    motor_file = camring.read_motor_file(ROOT / "examples" / "wheel_motor.toml")
    goal, space = motor_file.goal, motor_file.design_space
    system = eqx.tree_at(
        lambda each: each.operating_points,
        motor_file.system,
        motor_file.system.operating_points[:1],
    )
    points = np.random.default_rng(0).uniform(size=(asked.designs, space.dimension))
    rows: dict[str, float] = {}
    of_million = None
    if asked.million:  # first, while the process holds nothing else
        of_million = million(space, system, goal)
        print("A million designs: {:.3g} s, {:.2f} GiB at most.\n".format(*of_million))

    motor, fluid, point = system.motor, system.fluid, system.operating_points[0]
    rival = fastest(lambda: independent_results(motor, fluid, point, goal.harmonics, 1e-9), 1)
    rows["SciPy LSODA, tolerance 1e-9"] = rival
    some = points[:256]
    for name, resolution in (("search", Resolution.coarse()), ("final", Resolution())):
        rows[f"one by one under vmap, {name}"] = alone(space, system, goal, some, resolution)
    for rung, of_rung in (("", system), (", with air", with_air(system))):
        for name, look in LOOKS.items():
            most = points if name == "search" and not rung else points[: len(points) // 4]
            judged = partial(evaluate_many, space, of_rung, goal, most, look)
            rows[f"in lanes, {name}{rung}"] = fastest(judged) / len(most)
    rows["slopes by 11 variables, search"] = slopes(space, system, goal, some, LOOKS["search"])
    rows["in lanes, cycles and results alone, search"] = solved(repeated(system))
    rows["the same of a free ring of 6 lobes"] = solved(repeated(free_ring(system)))

    print(f"{os.cpu_count()} cores")
    print("| what | a design | designs a second | times faster than SciPy |\n|---|---|---|---|")
    for name, value in rows.items():
        print(f"| {name} | {1e6 * value:.4g} µs | {1 / value:,.0f} | {rival / value:,.0f} |")

    errors = accuracy(space, system, goal, points[:64])
    print("\n| resolution | objective terms, median and worst | mean torque | extremes |")
    print("|---|---|---|---|")
    for name, found in errors.items():
        print(f"| {name} | " + " | ".join(found) + " |")

    off = slope_errors(space, system, goal, points[:32])
    print("\n| slopes of 32 designs | off by, of the objective's largest: median | worst |")
    print("|---|---|---|")
    for name, value in off.items():
        print(f"| {name} | {np.median(value):.1e} | {max(value):.1e} |")

    growth = {}
    for count in (CHUNK, 4 * CHUNK, 16 * CHUNK, 64 * CHUNK):
        many = np.resize(points, (count, space.dimension))
        growth[count] = fastest(lambda many=many: evaluate_many(space, system, goal, many), 2)
    print("\n| designs | seconds |\n|---|---|")
    for count, value in growth.items():
        print(f"| {count:,} | {value:.3g} |")
    RESULTS.mkdir(exist_ok=True)
    written = {
        "seconds": rows,
        "errors": errors,
        "slopes": off,
        "growth": growth,
        "million": of_million,
    }
    (RESULTS / "batch_speed.json").write_text(json.dumps(written, indent=1) + "\n")


def million(space: DesignSpace, system: System, goal: Goal) -> tuple[float, float]:
    """Seconds that a million designs take, compilation included, and GiB of memory."""
    many = np.random.default_rng(1).uniform(size=(1_000_000, space.dimension))
    started = time.perf_counter()
    evaluate_many(space, system, goal, many)
    seconds = time.perf_counter() - started
    return seconds, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20


def alone(
    space: DesignSpace, system: System, goal: Goal, points: np.ndarray, resolution: Resolution
) -> float:
    """Seconds a design of the solver of one motor, batched by `vmap`."""
    judged = eqx.filter_jit(
        jax.vmap(lambda at: evaluate(space.apply(system, at), goal, resolution))
    )
    return fastest(lambda: judged(points)) / len(points)


def slopes(
    space: DesignSpace, system: System, goal: Goal, points: np.ndarray, look: LanesLook
) -> float:
    """Seconds a design for all slopes, from cycles at hand."""
    found = eqx.filter_jit(solve_designs)(designs_in_lanes(space, system, points), look)
    run = eqx.filter_jit(slopes_of_designs)
    return fastest(lambda: run(space, system, points, found, goal, look)) / len(points)


def repeated(system: System, lanes: int = 64) -> System:
    return jax.tree.map(
        lambda leaf: jnp.broadcast_to(leaf[..., None], (*leaf.shape, lanes)), system
    )


def solved(designs: System, lanes: int = 64) -> float:
    """Seconds a design for cycles and results."""
    look = LanesLook.search()
    solve, total = eqx.filter_jit(solve_designs), eqx.filter_jit(summarise_lanes)
    return fastest(lambda: total(solve(designs, look)[0], 600, look.oversampling), 5) / lanes


def slope_errors(
    space: DesignSpace, system: System, goal: Goal, points: np.ndarray
) -> dict[str, list[float]]:
    """Each design's largest difference of the objective's slopes from those by itself."""
    alone = [
        slopes_alone(space, system, at, solve(space.apply(system, at), goal), goal).objective
        for at in points
    ]
    errors = {}
    for name, look in LOOKS.items():
        found = eqx.filter_jit(solve_designs)(designs_in_lanes(space, system, points), look)
        run = eqx.filter_jit(slopes_of_designs)
        lanes = run(space, system, jnp.asarray(points), found, goal, look).objective
        errors[name] = [
            float(np.max(np.abs(lanes[:, place] - one)) / np.max(np.abs(one)))
            for place, one in enumerate(alone)
        ]
    return errors


def accuracy(
    space: DesignSpace, system: System, goal: Goal, points: np.ndarray
) -> dict[str, list[str]]:
    """Errors of some results against a fine look at each design by itself."""
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
    for name, look in LOOKS.items():
        metrics = evaluate_many(space, system, goal, points, look).metrics[0]
        errors = {
            each: np.abs(getattr(metrics, each) / np.asarray(getattr(truth, each)) - 1)
            for each in (*OF_OBJECTIVE, "mean_torque", *EXTREMES)
        }
        groups = (OF_OBJECTIVE, ("mean_torque",), EXTREMES)
        found[name] = [
            f"{max(np.median(errors[each]) for each in group):.1e}, "
            f"{max(np.max(errors[each]) for each in group):.1e}"
            for group in groups
        ]
    return found


if __name__ == "__main__":
    main()

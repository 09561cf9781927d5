"""Work and precision: what each digit of the periodic pressure costs, ours and others'.

    pip install "camring[rivals]"
    python benchmarks/work_precision.py [--motor FILE] [--rounds 7] [--only ours scipy ...]

One motor, one operating point: docs/theory.md section 3. The error is the largest difference of
pressure at 2000 angles from SciPy's LSODA between kinks at tolerance 1e-11, over the
supply-return difference. Times are of warm programs, solving only: processor time, all
threads added up, the least of some rounds in which all solvers take turns.
`benchmarks/results/work_precision.json` has every setting,
docs/pictures/work_precision.svg is the picture, docs/notes/work_precision.md the
reading of both.
"""

import argparse
import json
import os
import statistics
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from itertools import chain
from pathlib import Path

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from rival_solvers import Run, casadi_runs, diffrax_runs, scipy_runs
from stage_times import stage_times
from work_precision_picture import draw

import camring
from camring.numerics.radau import element_powers, horner
from camring.physics.batch_cycle import BatchResolution
from camring.physics.heat.batch_simulation import simulate_batch
from camring.physics.resolution import Resolution
from camring.physics.system import System
from camring.programs.batch_program import BatchProgram
from camring.programs.compilation_cache import keep_compiled_programs
from camring.reference.machine import machine_of
from camring.reference.orbit import Orbit, periodic_orbit

ROOT = Path(__file__).parents[1]
MOTOR = ROOT / "tests" / "published" / "data" / "mid.toml"
RESULTS = Path(__file__).with_name("results") / "work_precision.json"
PICTURE = ROOT / "docs" / "pictures" / "work_precision.svg"

ANGLES = 2000
ELEMENTS = (40, 80, 160, 320, 640, 1280, 2560)
BATCH_ELEMENTS = (40, 80, 120, 240, 480)
MEMBERS = 256
WANTED = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
OURS = "camring, one motor"
BATCH = f"camring, {MEMBERS} in a batch"
ENOUGH = 1.0
"""Processor seconds after which a setting takes no more turns."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--motor", type=Path, default=MOTOR, help="a motor file, plain laws")
    parser.add_argument("--rounds", type=int, default=7, help="turns of each solver")
    kinds = ("scipy", "casadi", "diffrax", "batch", "ours")
    parser.add_argument("--only", nargs="+", choices=kinds, default=kinds)
    asked = parser.parse_args()
    keep_programs()

    system = camring.read_motor_file(asked.motor).system
    point = system.operating_points[0]
    machine = machine_of(system.motor, system.fluid, point)
    shapes = {(port.shape, port.notch_area) for port in (machine.supply, machine.return_)}
    plain_laws = machine.oil.law == "constant" and machine.orifice == "turbulent"
    if not plain_laws or shapes != {("linear", 0.0)} or machine.manifolds:
        raise SystemExit("CasADi has the plain laws alone; take a motor file without others")
    orbit = periodic_orbit(machine, 1e-11)
    if orbit.multiplier > 1e-9:
        raise SystemExit(
            f"a disturbance is only forgotten to {orbit.multiplier:.1e} in a period, so two "
            "periods are no fair measure of the rivals; take a motor with open ports"
        )
    chamber = orbit.chamber
    angles = chamber.start + (np.arange(ANGLES) + 0.5) / ANGLES * chamber.machine.period
    many = neighbours(system)
    makers = {
        "ours": lambda: our_runs(system, angles),
        "batch": lambda: batch_runs(system, many, angles),
        "scipy": lambda: scipy_runs(chamber, angles),
        "casadi": lambda: casadi_runs(chamber, angles),
        "diffrax": lambda: diffrax_runs(system, chamber, angles, many),
    }
    runs = list(chain.from_iterable(present(kind, makers[kind]()) for kind in asked.only))
    truth = orbit.pressure(angles)
    rows = measured(runs, truth, chamber.scale, asked.rounds)
    agreement = min((r["largest_error"] for r in rows if r["solver"] == OURS), default=np.nan)
    order = orders(rows)
    stages = stage_times(system) if "ours" in asked.only else {}

    print(f"{os.cpu_count()} cores; {asked.motor.name}, {orbit_said(orbit)}")
    print(f"reference and our finest mesh differ by {agreement:.1e}\n")
    print(table(rows))
    for norm, value in order.items():
        print(f"\norder of convergence, {norm}: {value:.2f}", end="")
    print("\n\n| stage | ms | of all stages |\n|---|---|---|")
    together = next((v for name, v in stages.items() if name.startswith("all stages")), 1.0)
    for name, value in stages.items():
        print(f"| {name} | {1e3 * value:.3f} | {value / together:.0%} |")
    if set(asked.only) == set(kinds):
        written = {"agreement": agreement, "order": order, "stages": stages, "runs": rows}
        RESULTS.write_text(json.dumps(written, indent=1) + "\n")
        try:
            draw(rows, PICTURE)
        except ImportError:
            print('No picture without matplotlib: pip install "camring[plot]" brings it.')


def keep_programs() -> None:
    """A second run compiles nothing: JAX stands imported, so it is set directly."""
    folder = keep_compiled_programs()
    if folder:
        jax.config.update("jax_compilation_cache_dir", str(folder))
        jax.config.update("jax_persistent_cache_min_compile_time_secs", 0)
        jax.config.update("jax_persistent_cache_min_entry_size_bytes", -1)


def orbit_said(orbit: Orbit) -> str:
    machine = orbit.chamber.machine
    return f"{machine.shaft_speed * 30 / np.pi:.0f} rpm, {orbit.chamber.scale / 1e5:.0f} bar"


def present(kind: str, runs: Iterator[Run]) -> Iterator[Run]:
    """The runs; a sentence in place of a package that is not installed."""
    try:
        yield from runs
    except ImportError as missing:
        print(f'{kind} is left out ({missing}): pip install "camring[rivals]" brings it.')


def neighbours(system: System) -> np.ndarray:
    """Control radii of the motor's cam and of others near it, one a row."""
    radii = np.asarray(system.motor.cam.control_radii)
    wobble = 1e-3 * np.ptp(radii) * np.random.default_rng(0).normal(size=(MEMBERS, *radii.shape))
    return radii + np.where(np.arange(MEMBERS)[:, None] > 0, wobble, 0)


def our_runs(system: System, angles: np.ndarray) -> Iterator[Run]:
    motor, fluid, point = system.motor, system.fluid, system.operating_points[0]
    for elements in ELEMENTS:
        resolution = Resolution(elements=elements)
        run = partial(camring.simulate, motor, fluid, point, resolution)

        def pressure(run=run) -> np.ndarray:
            orbit = run().orbit
            first = float(orbit.mesh.start[0])
            within = first + (angles - first) % motor.cam.period
            return np.asarray(fluid.pressure(orbit.at_position(jnp.asarray(within))))

        yield Run(OURS, str(elements), lambda run=run: jax.block_until_ready(run()), pressure)


def batch_runs(system: System, many: np.ndarray, angles: np.ndarray) -> Iterator[Run]:
    """One call of one thread, as `evaluate_many` makes many; the first is the motor itself."""
    point = system.operating_points[0]
    wide = jax.tree.map(
        lambda leaf: jnp.broadcast_to(leaf[..., None], (*leaf.shape, len(many))),
        (system.motor, system.fluid, point),
    )
    motor, fluid, point = eqx.tree_at(
        lambda each: each[0].cam.control_radii, wide, jnp.asarray(many.T)
    )
    for elements in BATCH_ELEMENTS:
        like = (
            BatchResolution()
            if elements > BatchResolution.search().elements
            else BatchResolution.search()
        )
        fine = replace(like, elements=elements)
        run = partial(BatchProgram(simulate_batch), motor, fluid, point, fine)

        def pressure(run=run) -> np.ndarray:
            orbit = run().cycle.orbit
            start, width = (np.asarray(leaf)[:, 0] for leaf in orbit.mesh[:2])
            powers = np.asarray(element_powers(orbit.node_state, orbit.stage_state))[..., 0]
            within = start[0] + (angles - start[0]) % system.motor.cam.period
            element = np.searchsorted(start, within, side="right") - 1
            fraction = (within - start[element]) / width[element]
            return np.asarray(system.fluid.pressure(horner(powers[:, element], fraction)))

        ready = partial(_ready, run)
        yield Run(BATCH, str(elements), ready, pressure, designs=len(many))


def _ready(run: Callable[[], object]) -> object:
    return jax.block_until_ready(run())


def measured(runs: list[Run], truth: np.ndarray, scale: float, rounds: int) -> list[dict]:
    """One row for each run: its errors, and its processor times of a design in s."""
    rows = []
    for run in runs:
        print(run.solver, run.setting, file=sys.stderr, flush=True)
        error = np.abs(run.pressure() - truth) / scale
        run.solve()  # compiles
        rows.append(
            {
                "solver": run.solver,
                "setting": run.setting,
                "largest_error": float(np.max(error)),
                "rms_error": float(np.sqrt(np.mean(error**2))),
            }
        )
    times: list[list[float]] = [[] for _ in runs]
    for _ in range(rounds):
        for run, taken in zip(runs, times, strict=True):
            if sum(taken) * run.designs < ENOUGH:
                started = time.process_time()
                run.solve()
                taken.append((time.process_time() - started) / run.designs)
    for row, taken in zip(rows, times, strict=True):
        row.update(seconds=min(taken), median_seconds=statistics.median(taken), turns=len(taken))
    return rows


def cheapest(rows: list[dict], solver: str, error: float) -> dict | None:
    """The fastest setting of a solver that errs by no more; None where there is none."""
    good = [row for row in rows if row["solver"] == solver and row["largest_error"] <= error]
    return min(good, key=lambda row: row["seconds"], default=None)


def table(rows: list[dict], wanted: tuple[float, ...] = WANTED) -> str:
    """Milliseconds of a design for a wanted error, and how often ours of one motor fits in."""
    lines = ["| solver | " + " | ".join(f"{error:.0e}" for error in wanted) + " |"]
    lines.append("|---" * (1 + len(wanted)) + "|")
    for solver in dict.fromkeys(row["solver"] for row in rows):
        cells = []
        for error in wanted:
            found, ours = cheapest(rows, solver, error), cheapest(rows, OURS, error)
            if found is None:
                cells.append("–")
                continue
            ratio = f" ({found['seconds'] / ours['seconds']:.2g}×)" if ours else ""
            cells.append(f"{1e3 * found['seconds']:.3g} ms{ratio}")
        lines.append(f"| {solver} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def orders(rows: list[dict]) -> dict[str, float]:
    """Slope of error against elements of ours, where it is the mesh that errs."""
    ours = [row for row in rows if row["solver"] == OURS and int(row["setting"]) >= 160]
    found = {}
    for norm in ("largest_error", "rms_error"):
        good = [row for row in ours if row[norm] > 1e-10]
        if len(good) > 1:
            sizes = [np.log(float(row["setting"])) for row in good]
            found[norm] = -float(np.polyfit(sizes, [np.log(row[norm]) for row in good], 1)[0])
    return found


if __name__ == "__main__":
    main()

"""Where the time of many designs side by side goes: its stages compiled and timed apart.

    python benchmarks/batch_stages.py [--designs 256] [--air]

Random designs of the wheel motor at search resolution. Each stage is a program of its
own, once as machine code of our making and once by JAX's compiler; the first and the last
are JAX's in either case. Processor time of all threads together, the least of 25; stages
apart cost more than together, for each has its own call and its own arrays.
"""

import argparse
from collections.abc import Callable
from functools import partial
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from stopwatch import processor_times
from wheel_motor import as_given, at_one_point, with_air

from camring.compiler.program import NativeProgram
from camring.metrics import batch_summary as summary
from camring.metrics.batch_spectra import sampled_spectra
from camring.metrics.power_balance import power_balance
from camring.numerics import batch_periodic as solver
from camring.numerics.batch_extremum import largest
from camring.numerics.batch_mesh import EvenSegments, graded_batch
from camring.numerics.radau import STAGES
from camring.objective.batch import designs_in_batch, measure_designs, say_of_designs
from camring.physics import batch_cycle as cycles
from camring.physics.cycle import Cycle
from camring.programs.between_arrays import Program, between_arrays
from camring.programs.leaves import is_array

REPEATS = 25
OPTIONS = {"xla_cpu_prefer_vector_width": 512, "xla_cpu_multi_thread_eigen": False}


class Stages:
    """Microseconds a design of each, added up under its name: our code's, and JAX's."""

    def __init__(self, count: int) -> None:
        self._count = count
        self.native: dict[str, float] = {}
        self.jax: dict[str, float] = {}

    def run(self, name: str, function: Callable, *inputs: Any) -> Any:
        """The stage's result, after both programs have been timed."""
        inputs = jax.tree.map(self._in_batch, inputs)
        found, _ = self._by_jax(name, function, inputs)
        arrays = [np.asarray(leaf) for leaf in jax.tree.leaves(inputs) if is_array(leaf)]
        called, result = between_arrays(function, (inputs, {}))
        native = NativeProgram(called, arrays)
        self._add(self.native, name, partial(Program(native, result.tree), arrays))
        return found

    def run_by_jax(self, name: str, function: Callable, *inputs: Any) -> Any:
        found, spent = self._by_jax(name, function, inputs)
        self.native[name] = spent
        return found

    def _by_jax(self, name: str, function: Callable, inputs: tuple) -> tuple[Any, float]:
        run = partial(eqx.filter_jit(function, compiler_options=OPTIONS), *inputs)
        return run(), self._add(self.jax, name, run)

    def _add(self, table: dict[str, float], name: str, run: Callable[[], object]) -> float:
        spent = 1e6 * processor_times(run, REPEATS)[0] / self._count
        table[name] = table.get(name, 0) + spent
        return spent

    def _in_batch(self, leaf: Any) -> Any:
        """An array of one design as one of so many equal ones."""
        if not is_array(leaf) or not leaf.ndim or leaf.shape[-1] == self._count:
            return leaf
        return jnp.broadcast_to(leaf, (*leaf.shape[:-1], self._count))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--designs", type=int, default=256)
    parser.add_argument("--air", action="store_true", help="oil with air instead of the plain law")
    asked = parser.parse_args()
    stages = Stages(asked.designs)
    run = stages.run

    file, resolution = as_given(), cycles.BatchResolution.search()
    space, goal, given = file.design_space, file.goal, at_one_point(file.system)
    system = with_air(given) if asked.air else given
    points = jnp.asarray(np.random.default_rng(0).uniform(size=(asked.designs, space.dimension)))
    name = "design space: cam modes at equal displacement"
    designs = stages.run_by_jax(name, designs_in_batch, space, system, points)
    motor, fluid, point = designs.motor, designs.fluid, designs.operating_points[0]
    period, at = motor.cam.period, jnp.asarray(STAGES)

    name = "cam round the lobe, breakpoints"
    cam = run(name, cycles.round_the_cam, motor.cam)
    reference = run(name, cycles.reference_radii, motor, cam)
    breakpoints, sharp, own = run(name, cycles._breakpoints, motor, resolution.knots)
    periodic = solver.PeriodicResolution(
        resolution.elements + own, resolution.per_segment, resolution.tolerance
    )
    equation = cycles._equation(motor, fluid, point, reference)

    def forcing(equation, mesh):
        return equation.forcing(mesh, at)

    def begin(breakpoints):
        return graded_batch(breakpoints, period, resolution.per_segment)

    def lay(equation, rough, node, found, breakpoints, sharp):
        segments = EvenSegments(resolution.per_segment)
        known = solver.Known(rough, segments, node, found)
        laid = solver.lay_from(equation, known, breakpoints, sharp, period, periodic.elements)
        return laid[0], laid[2]

    def step(equation, here, mesh, found):
        node, found = solver._step(equation, here, mesh, list(found))
        return node, jnp.stack(found)

    def newton(equation, here, mesh, found, tolerance):
        return solver._newton(equation, here, mesh, found, tolerance, periodic.limit)

    both = "forcing on both meshes"
    rough = run("laying the meshes, sampling the guess", begin, breakpoints)
    here = run(both, forcing, equation, rough)
    name, guess = "Newton on the graded mesh", equation.guess(here)
    found, first = run(name, newton, equation, here, rough, guess, periodic.rough_tolerance)
    node, found = run(name, step, equation, here, rough, found)
    name = "laying the meshes, sampling the guess"
    mesh, found = run(name, lay, equation, rough, node, found, breakpoints, sharp)
    here = run(both, forcing, equation, mesh)
    name = "Newton on the mesh"
    found, second = run(name, newton, equation, here, mesh, found, periodic.tolerance)
    name = "last step, residual, multiplier"
    solved = run(name, solver._settled, equation, here, mesh, found, second)

    cycle = Cycle(motor, fluid, point, reference, solved.orbit, None, cycles.verdict())
    solution = cycles.BatchCycle(cycle, cam, solved.at_stages)
    samples = run("power balance", summary.at_collocation_points, solution)
    run("power balance", power_balance, cycle, samples)

    def extremes(cycle, piston):
        corners = summary.with_starts(summary.Corners, summary.at_starts(cycle), piston)
        both = corners.chamber_pressure, corners.force
        return [largest(each) for each in (*corners, *(-each for each in both))]

    run("extremes", extremes, cycle, samples.piston)
    name, harmonics = "waves at fixed places, spectra", goal.harmonics
    run(name, sampled_spectra, cycle, harmonics, resolution.oversampling)
    whole, name = Stages(asked.designs), "all but the first and the last, as one program"
    metrics, faults = whole.run(name, measure_designs, designs, harmonics, resolution)
    stages.run_by_jax("objective and limits", say_of_designs, designs, metrics, faults, goal)

    print(f"{asked.designs} designs, {periodic.elements} elements, Newton steps {first}, {second}")
    print("| stage | µs of processor time a design | by JAX's compiler |\n|---|---|---|")
    for name, value in stages.native.items():
        print(f"| {name} | {value:.2f} | {stages.jax[name]:.1f} |")
    print(f"| sum | {sum(stages.native.values()):.1f} | {sum(stages.jax.values()):.1f} |")
    for name, value in whole.native.items():
        print(f"| {name} | {value:.1f} | {whole.jax[name]:.1f} |")


if __name__ == "__main__":
    main()

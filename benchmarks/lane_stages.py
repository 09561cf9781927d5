"""Where the time of many designs side by side goes: its stages compiled and timed apart.

    python benchmarks/lane_stages.py [--lanes 256] [--air]

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

from camring.interfaces.kept_program import Program, between_arrays, is_array
from camring.metrics import lane_summary as summary
from camring.metrics.power_balance import power_balance
from camring.numerics import lane_periodic as solver
from camring.numerics.lane_fourier import power_of_orders
from camring.numerics.lane_mesh import equidistribute_lanes, graded_lanes
from camring.numerics.mesh import fourth_derivative_density
from camring.numerics.native.program import NativeProgram
from camring.numerics.periodic import extent
from camring.numerics.radau import STAGES, element_powers
from camring.objective.lanes import designs_in_lanes, measure_designs, say_of_designs
from camring.physics import lane_cycle as cycles
from camring.physics.cycle import Cycle

REPEATS = 25
OPTIONS = {"xla_cpu_prefer_vector_width": 512, "xla_cpu_multi_thread_eigen": False}


class Stages:
    """Microseconds a design of each, added up under its name: our code's, and JAX's."""

    def __init__(self, lanes: int) -> None:
        self._lanes = lanes
        self.native: dict[str, float] = {}
        self.jax: dict[str, float] = {}

    def run(self, name: str, function: Callable, *inputs: Any) -> Any:
        """The stage's result, after both programs have been timed."""
        inputs = jax.tree.map(self._in_lanes, inputs)
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
        spent = 1e6 * processor_times(run, REPEATS)[0] / self._lanes
        table[name] = table.get(name, 0) + spent
        return spent

    def _in_lanes(self, leaf: Any) -> Any:
        """An array with lanes, where all of them are the same and it has one."""
        if not is_array(leaf) or not leaf.ndim or leaf.shape[-1] == self._lanes:
            return leaf
        return jnp.broadcast_to(leaf, (*leaf.shape[:-1], self._lanes))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--lanes", type=int, default=256)
    parser.add_argument("--air", action="store_true", help="oil with air instead of the plain law")
    asked = parser.parse_args()
    stages = Stages(asked.lanes)
    run = stages.run

    file, look = as_given(), cycles.LanesLook.search()
    space, goal, given = file.design_space, file.goal, at_one_point(file.system)
    system = with_air(given) if asked.air else given
    points = jnp.asarray(np.random.default_rng(0).uniform(size=(asked.lanes, space.dimension)))
    name = "design space: cam modes at equal displacement"
    designs = stages.run_by_jax(name, designs_in_lanes, space, system, points)
    motor, fluid, point = designs.motor, designs.fluid, designs.operating_points[0]
    period, at = motor.cam.period, jnp.asarray(STAGES)

    name = "cam round the lobe, breakpoints"
    cam = run(name, cycles.round_the_cam, motor.cam)
    reference = run(name, cycles.reference_radii, motor, cam)
    breakpoints, sharp, own = run(name, cycles._breakpoints, motor, look.knots)
    resolution = solver.LaneResolution(look.elements + own, look.per_segment, look.tolerance)
    equation = cycles._equation(motor, fluid, point, reference)

    def forcing(equation, mesh):
        return equation.forcing(mesh, at)

    def begin(breakpoints):
        return graded_lanes(breakpoints, period, look.per_segment)

    def lay(equation, rough, node, found, breakpoints, sharp):
        powers = element_powers(node, found)
        density = fourth_derivative_density(rough, powers[3], extent(found), period)
        layer = solver._layer_width(equation, rough, node, period, look.per_segment)
        mesh, within = equidistribute_lanes(
            rough, density, breakpoints, sharp, layer, period, resolution.elements
        )
        return mesh, solver._carried_over(rough, powers, mesh, within)

    def step(equation, here, mesh, found):
        node, found = solver._step(equation, here, mesh, list(found))
        return node, jnp.stack(found)

    def newton(equation, here, mesh, found, tolerance):
        return solver._newton(equation, here, mesh, found, tolerance, resolution.limit)

    both = "forcing on both meshes"
    rough = run("laying the meshes, sampling the guess", begin, breakpoints)
    here = run(both, forcing, equation, rough)
    name, guess = "Newton on the graded mesh", equation.guess(here)
    found, first = run(name, newton, equation, here, rough, guess, resolution.rough_tolerance)
    node, found = run(name, step, equation, here, rough, found)
    name = "laying the meshes, sampling the guess"
    mesh, found = run(name, lay, equation, rough, node, found, breakpoints, sharp)
    here = run(both, forcing, equation, mesh)
    name = "Newton on the mesh"
    found, second = run(name, newton, equation, here, mesh, found, resolution.tolerance)
    name = "last step, residual, multiplier"
    solved = run(name, solver._settled, equation, here, mesh, found, second)

    cycle = Cycle(motor, fluid, point, reference, solved.orbit, None, cycles.verdict())
    solution = cycles.LaneCycle(cycle, cam, solved.at_stages)
    samples = run("power balance", summary._at_collocation_points, solution)
    run("power balance", power_balance, cycle, samples)

    def extremes(cycle, piston):
        corners = summary._with_starts(cycle, piston)
        both = corners.chamber_pressure, corners.force
        return [summary._largest(each) for each in (*corners, *(-each for each in both))]

    run("extremes", extremes, cycle, samples.piston)
    name, harmonics = "waves at fixed places, spectra", goal.harmonics
    waves = run(name, summary._at_fixed_places, cycle, harmonics, look.oversampling)
    orders = harmonics // motor.cam.repeats

    def spectra(waves, motor):
        sums = [summary._of_all_pistons(each, motor) for each in waves[:2]]
        of_sum = orders // motor.distinct_phases
        return [power_of_orders(each, of_sum) for each in sums], power_of_orders(waves[2], orders)

    run(name, spectra, waves, motor)
    whole, name = Stages(asked.lanes), "all but the first and the last, as one program"
    metrics, faults = whole.run(name, measure_designs, designs, harmonics, look)
    stages.run_by_jax("objective and limits", say_of_designs, designs, metrics, faults, goal)

    print(f"{asked.lanes} designs, {resolution.elements} elements, Newton steps {first}, {second}")
    print("| stage | µs of processor time a design | by JAX's compiler |\n|---|---|---|")
    for name, value in stages.native.items():
        print(f"| {name} | {value:.2f} | {stages.jax[name]:.1f} |")
    print(f"| sum | {sum(stages.native.values()):.1f} | {sum(stages.jax.values()):.1f} |")
    for name, value in whole.native.items():
        print(f"| {name} | {value:.1f} | {whole.jax[name]:.1f} |")


if __name__ == "__main__":
    main()

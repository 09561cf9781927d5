"""Where the time of many designs side by side goes: its stages compiled and timed apart.

    python benchmarks/lane_stages.py [--lanes 64] [--air]

Random designs of the wheel motor at search resolution. Processor time of all threads
together, the least of 25; stages apart cost more than together, for each has its own call.
"""

import argparse
import time
from collections.abc import Callable
from pathlib import Path

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from batch_speed import with_air

import camring
from camring.metrics import lane_summary as summary
from camring.metrics.power_balance import power_balance
from camring.numerics import lane_periodic as solver
from camring.numerics.lane_mesh import equidistribute_lanes, graded_lanes, positions
from camring.numerics.mesh import fourth_derivative_density
from camring.numerics.newton import damped_newton
from camring.numerics.periodic import extent, newton_step
from camring.numerics.radau import STAGES, element_powers
from camring.objective.lanes import designs_in_lanes
from camring.physics import lane_cycle as cycles
from camring.physics.cycle import Cycle

ROOT = Path(__file__).parents[1]
REPEATS = 25


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--lanes", type=int, default=64)
    parser.add_argument("--air", action="store_true", help="oil with air instead of the plain law")
    asked = parser.parse_args()
    lanes = asked.lanes
    spent: dict[str, float] = {}

    def timed(name: str, function: Callable, *inputs):
        program = eqx.filter_jit(function)
        found = jax.block_until_ready(program(*inputs))
        times = []
        for _ in range(REPEATS):
            started = time.process_time()
            jax.block_until_ready(program(*inputs))
            times.append(time.process_time() - started)
        spent[name] = spent.get(name, 0) + 1e6 * min(times) / lanes
        return found

    file = camring.read_motor_file(ROOT / "examples" / "wheel_motor.toml")
    space, look = file.design_space, cycles.LanesLook.search()
    points = jnp.asarray(np.random.default_rng(0).uniform(size=(lanes, space.dimension)))
    name = "design space: cam modes at equal displacement"
    system = with_air(file.system) if asked.air else file.system
    designs = timed(name, lambda at: designs_in_lanes(space, system, at), points)
    motor, fluid, point = designs.motor, designs.fluid, designs.operating_points[0]
    period, at = motor.cam.period, jnp.asarray(STAGES)
    resolution = solver.LaneResolution(look.elements + 24, look.per_segment, look.tolerance)

    name = "cam round the lobe, breakpoints"
    cam = timed(name, cycles.round_the_cam, motor.cam)
    reference = timed(name, cycles.reference_radii, motor, cam)
    breakpoints, sharp, _ = timed(name, lambda m: cycles._breakpoints(m, look.knots), motor)
    equation = cycles._equation(motor, fluid, point, reference)

    def force(equation, mesh):
        return equation.forcing(mesh, at)

    def solve(equation, here, mesh, stages, tolerance):
        def improved(now):
            return newton_step(equation, here, mesh, now)[1]

        return damped_newton(improved, extent, stages, tolerance, resolution.limit)

    def lay(equation, mesh, node, stages):
        powers = element_powers(node, stages)
        density = fourth_derivative_density(mesh, powers[3], extent(stages), period)
        layer = solver._layer_width(equation, mesh, node, period, look.per_segment)
        finer = equidistribute_lanes(
            mesh, density, breakpoints, sharp, layer, period, resolution.elements
        )
        return finer, solver._sampled(mesh, powers, positions(finer, at))

    rough = graded_lanes(breakpoints, period, look.per_segment)
    here = timed("forcing on both meshes", force, equation, rough)
    name = "Newton on the graded mesh"
    guess = equation.guess(here)
    stages, first = timed(name, solve, equation, here, rough, guess, resolution.rough_tolerance)
    node, stages = timed(name, newton_step, equation, here, rough, stages)
    name = "laying the mesh, sampling the guess on it"
    mesh, stages = timed(name, lay, equation, rough, node, stages)
    here = timed("forcing on both meshes", force, equation, mesh)
    name = "Newton on the mesh"
    stages, second = timed(name, solve, equation, here, mesh, stages, resolution.tolerance)
    name = "last step, residual, multiplier"
    solved = timed(name, solver._settled, equation, here, mesh, stages, second)

    cycle = Cycle(motor, fluid, point, reference, solved.orbit, None, cycles.verdict())
    found = cycles.LaneCycle(cycle, cam, solved.at_stages)
    samples = timed("power balance", summary._at_collocation_points, found)
    timed("power balance", power_balance, cycle, samples)
    corners = timed("extremes", summary._with_starts, cycle, samples.piston)
    timed(
        "extremes",
        lambda c: [summary._largest(x) for x in (*c, -c.chamber_pressure, -c.force)],
        corners,
    )
    name = "waves at fixed places, spectra"
    harmonics = file.goal.harmonics
    waves = timed(name, lambda c: summary._at_fixed_places(c, harmonics, look.oversampling), cycle)
    orders = harmonics // motor.cam.repeats

    def spectra(waves):
        both = [summary._of_all_pistons(each, motor) for each in waves[:2]]
        of_sum = orders // motor.distinct_phases
        return [summary._power(each, of_sum) for each in both], summary._power(waves[2], orders)

    timed(name, spectra, waves)
    print(f"{lanes} designs, {resolution.elements} elements, Newton steps {first} and {second}")
    print("| stage | µs of processor time a design |\n|---|---|")
    for name, value in spent.items():
        print(f"| {name} | {value:.1f} |")
    print(f"| sum | {sum(spent.values()):.1f} |")


if __name__ == "__main__":
    main()

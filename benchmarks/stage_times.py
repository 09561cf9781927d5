"""Where the time of one simulation goes: its stages compiled and timed one by one."""

from collections.abc import Callable

import equinox as eqx
import jax.numpy as jnp
from stopwatch import wall_times

import camring
from camring.numerics.mesh import (
    ElementCount,
    equidistribute,
    fourth_derivative_density,
    graded_mesh,
)
from camring.numerics.newton import damped_newton
from camring.numerics.periodic import _interpolate as interpolate
from camring.numerics.periodic import _layer_width as layer_width
from camring.numerics.periodic import extent, newton_step, settle, share_of_range
from camring.numerics.radau import STAGES, element_powers
from camring.physics.cycle import _assessed as assessed
from camring.physics.cycle import _equation as equation_of
from camring.physics.cycle import reference_radius
from camring.physics.resolution import Resolution
from camring.physics.system import System


def fastest(action: Callable[[], object]) -> float:
    return wall_times(action, 40)[0]


def stage_times(system: System) -> dict[str, float]:
    """Seconds of each stage at the default resolution, and of `simulate` as a whole.

    Stages apart cost more than together: each has its own call, some 20 microseconds.
    """
    motor, fluid, point = system.motor, system.fluid, system.operating_points[0]
    resolution = Resolution()
    elements = resolution.elements * (motor.lobes // motor.cam.repeats) + motor.promised_elements()
    promised = ElementCount(elements, elements)
    period, at = motor.cam.period, jnp.asarray(STAGES)
    jit = eqx.filter_jit
    known = reference_radius(motor)
    equation, breakpoints = equation_of(motor, fluid, point, known), motor.breakpoints()

    reference = jit(reference_radius)
    grade = jit(lambda fixed: graded_mesh(fixed.position, period))
    force = jit(lambda equation, mesh: equation.forcing(mesh, at))
    guess = jit(lambda equation, here: equation.guess(here))

    @jit
    def solve(equation, here, mesh, stages, tolerance):
        def improved(now):
            return newton_step(equation, here, mesh, now)[1]

        return damped_newton(improved, share_of_range, stages, tolerance, 40)

    @jit
    def lay(equation, here, mesh, stages, fixed):
        """The next mesh, with the states at its collocation points."""
        node_state, stages = newton_step(equation, here, mesh, stages)
        powers = element_powers(node_state, stages)
        density = fourth_derivative_density(mesh, powers[3], extent(stages), period)
        layer = layer_width(equation, mesh, node_state, period, fixed)
        finer = equidistribute(mesh, density, fixed, layer, period, promised)
        return finer, interpolate(mesh, powers, finer.at(at))

    @jit
    def finish(equation, fixed, mesh, stages, count):
        return settle(equation, fixed, period, mesh, stages, count)

    assess = jit(assessed)
    spent: dict[str, float] = {}

    def timed(name, action):
        spent[name] = spent.get(name, 0) + fastest(action)
        return action()

    timed("reference radius of the cam", lambda: reference(motor))
    mesh = timed("graded first mesh", lambda: grade(breakpoints))
    here = timed("forcing (cam, openings) on the first mesh", lambda: force(equation, mesh))
    stages = guess(equation, here)
    name = "Newton on the first mesh"
    stages, count = timed(name, lambda: solve(equation, here, mesh, stages, 1e-3))
    steps = [int(count)]
    for turn in range(resolution.refinements):
        mesh, stages = timed(
            "laying meshes anew, three times",
            lambda h=here, m=mesh, s=stages: lay(equation, h, m, s, breakpoints),
        )
        here = timed("forcing on three full meshes", lambda m=mesh: force(equation, m))
        wanted = 1e-9 if turn == resolution.refinements - 1 else 1e-3
        stages, count = timed(
            "Newton on three full meshes",
            lambda h=here, m=mesh, s=stages, w=wanted: solve(equation, h, m, s, w),
        )
        steps.append(int(count))
    orbit = timed(
        "last step and residual", lambda: finish(equation, breakpoints, mesh, stages, count)
    )
    timed("verdict", lambda: assess(motor, fluid, point, known, orbit))
    spent[f"all stages, one by one (Newton steps {steps})"] = sum(spent.values())
    spent["whole"] = fastest(lambda: camring.simulate(motor, fluid, point, resolution))
    cycle = camring.simulate(motor, fluid, point, resolution)
    spent["results of section 10, beside it"] = fastest(lambda: camring.summarise(cycle, 600))
    empty = jit(lambda motor, fluid, point: point.shaft_speed)
    spent["a call that does nothing"] = fastest(lambda: empty(motor, fluid, point))
    return spent

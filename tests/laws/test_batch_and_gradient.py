"""A batch is its members one by one, and derivatives are slopes."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from both_roads import RESULTS, relative_errors, run_all
from motors import STRUCTURES, Case, sound_case

from camring.metrics.independent import independent_results
from camring.metrics.summary import summarise
from camring.physics.cycle import simulate

STRUCTURE = STRUCTURES[0]


@eqx.filter_jit
def results_of(motor, fluid, point):
    metrics = summarise(simulate(motor, fluid, point))
    return jnp.stack([getattr(metrics, name) for name in RESULTS])


def test_a_batch_of_motors_is_its_motors_one_by_one():
    cases = [sound_case(seed, STRUCTURE) for seed in range(5)]
    _, metrics = run_all(cases)
    for index, case in enumerate(cases):
        alone = dict(zip(RESULTS, np.asarray(results_of(*case)).tolist(), strict=True))
        batch = {name: float(getattr(metrics, name)[index]) for name in RESULTS}
        errors = relative_errors(batch, alone, case)
        assert max(errors.values()) < 1e-8, errors


def test_order_in_the_batch_does_not_matter():
    cases = [sound_case(seed, STRUCTURE) for seed in range(5)]
    _, forward = run_all(cases)
    _, backward = run_all(cases[::-1])
    for name in RESULTS:
        np.testing.assert_allclose(
            getattr(forward, name), getattr(backward, name)[::-1], rtol=1e-12
        )


SMOOTH = ("mean_torque", "torque_ripple", "pressure_ripple", "efficiency", "flow_ripple",
          "leakage_loss", "spectral_torque", "jerk_objective")  # fmt: skip
"""Results that are integrals: no extremum that could jump from one place to another."""

DIRECTIONS = {
    "bore": lambda c: c.motor.piston.bore,
    "dead volume": lambda c: c.motor.dead_volume,
    "supply width": lambda c: c.motor.valve_plate.supply.width,
    "shift": lambda c: c.motor.valve_plate.shift,
    "ramp": lambda c: c.motor.valve_plate.window.ramp,
    "port area": lambda c: c.motor.valve_plate.port_area,
    "bulk modulus": lambda c: c.fluid.bulk_modulus,
    "shaft speed": lambda c: c.point.shaft_speed,
    "supply pressure": lambda c: c.point.supply_pressure,
    "cam": lambda c: c.motor.cam.control_radii,
}


def step_along(case: Case, direction: str) -> np.ndarray:
    """A change of the number, of a size that a designer would call small."""
    where = DIRECTIONS[direction]
    here = np.asarray(where(case))
    if direction == "cam":
        return 0.01 * np.ptp(here) * np.sin(1 + 2.3 * np.arange(len(here)))
    if direction == "shift":
        return np.asarray(0.01 * case.motor.valve_plate.pitch)
    return 0.01 * here


@eqx.filter_jit
def _slopes(tree, tangents):
    def along(tangent):
        return jax.jvp(lambda *tree: results_of(*tree), tree, tangent)[1]

    return jax.vmap(along)(tangents)


def test_gradients_are_central_differences_of_the_independent_solver():
    case = sound_case(4, STRUCTURE)
    tree = tuple(case)
    zero = jax.tree.map(jnp.zeros_like, tree)
    tangents = []
    for direction, where in DIRECTIONS.items():
        step = step_along(case, direction)
        tangents.append(
            eqx.tree_at(lambda t, where=where: where(Case(*t)), zero, jnp.asarray(step))
        )
    found = np.asarray(_slopes(tree, jax.tree.map(lambda *leaves: jnp.stack(leaves), *tangents)))
    share = 0.02
    for index, (direction, where) in enumerate(DIRECTIONS.items()):
        here, step = np.asarray(where(case)), step_along(case, direction)
        ahead, behind = (
            independent_results(*case.changed(where, here + sign * share * step), tolerance=1e-10)
            for sign in (1, -1)
        )
        for name in SMOOTH:
            slope = (ahead[name] - behind[name]) / (2 * share)
            got = found[index, RESULTS.index(name)]
            assert got == pytest.approx(slope, rel=2e-3, abs=2e-6 * abs(ahead[name])), (
                f"d {name} / d {direction}"
            )

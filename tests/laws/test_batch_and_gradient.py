"""A batch is its members one by one, and derivatives are slopes."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from both_solvers import RESULTS, records, relative_errors, run_all
from motors import STRUCTURES, Case, sound_case, stacked

from camring.metrics.summary import summarise
from camring.physics.heat.simulation import simulate
from camring.reference import independent_results

STRUCTURE = STRUCTURES[0]


def results_of(motor, fluid, point):
    metrics = summarise(simulate(motor, fluid, point))
    return {name: getattr(metrics, name) for name in RESULTS}


@eqx.filter_jit
@jax.vmap
def batch_and_slopes(tree, tangent):
    """Results of a batch of motors, and slopes of some along one way each: one compilation."""
    results, slopes = jax.jvp(lambda *tree: results_of(*tree), tree, tangent)
    return results, {name: slopes[name] for name in SMOOTH}


def batch_of(cases):
    """Results of as many motors as there are directions, each of shape (motor,)."""
    batch = stacked([cases[k % len(cases)] for k in range(len(DIRECTIONS))])
    return jax.device_get(batch_and_slopes(batch, jax.tree.map(jnp.zeros_like, batch))[0])


def test_a_batch_of_motors_is_its_motors_one_by_one():
    cases = [sound_case(seed, STRUCTURE) for seed in range(5)]
    found = batch_of(cases)
    _, alone = run_all(cases)
    for place, (one, case) in enumerate(zip(records(alone), cases, strict=True)):
        errors = relative_errors({name: found[name][place] for name in RESULTS}, one, case)
        assert max(errors.values()) < 1e-8, errors


def test_order_in_the_batch_does_not_matter():
    cases = [sound_case(seed, STRUCTURE) for seed in range(5)]
    forward, backward = batch_of(cases), batch_of(cases[::-1])
    for name in RESULTS:
        np.testing.assert_allclose(forward[name], backward[name][::-1], rtol=1e-12, err_msg=name)


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
    ways = jax.tree.map(lambda *leaves: jnp.stack(leaves), *tangents)
    found = jax.device_get(batch_and_slopes(stacked([case] * len(tangents)), ways)[1])
    share = 0.02
    for index, (direction, where) in enumerate(DIRECTIONS.items()):
        here, step = np.asarray(where(case)), step_along(case, direction)
        ahead, behind = (
            independent_results(*case.changed(where, here + sign * share * step), tolerance=1e-10)
            for sign in (1, -1)
        )
        for name in SMOOTH:
            slope = (ahead[name] - behind[name]) / (2 * share)
            got = found[name][index]
            assert got == pytest.approx(slope, rel=2e-3, abs=2e-6 * abs(ahead[name])), (
                f"d {name} / d {direction}"
            )

"""Net radial force of the pistons, and a mode of a ring whose lobes are unequal."""

from dataclasses import replace

import jax
import numpy as np
import pytest
from both_solvers import RESULTS, relative_errors, run
from detailed_motors import detailed_case
from motors import Case, Structure

from camring.geometry.cam import RadialCam
from camring.metrics.idle_drag import idle_drag
from camring.metrics.radial_load import radial_load, ring_orders, shaft_orders
from camring.physics.resolution import Resolution
from camring.reference import independent_solution
from camring.reference.results import Quadrature, motion

STRUCTURE = Structure("radial", 3, 2, 8)
STROKES = (0.7, 1.1)  # of the lobes, over the drawn one's
IDLE = (0,)


@pytest.fixture(scope="module")
def unequal():
    """Three pistons on two lobes of other strokes, the first idle; and by the second solver."""
    motor, fluid, point = detailed_case(3, STRUCTURE)
    radii = np.asarray(motor.cam.control_radii)
    low = radii.min()
    ring = np.concatenate([low + stroke * (radii - low) for stroke in STROKES])
    motor = replace(motor, cam=RadialCam(ring, repeats=1))
    case = Case(motor, fluid, replace(point, idle_lobes=IDLE))
    cycle, metrics = run(case, Resolution(elements=1500))
    return case, cycle, metrics, independent_solution(*case, tolerance=1e-9)


def test_a_mode_of_unequal_lobes_is_that_of_the_second_solver(unequal):
    case, cycle, metrics, expected = unequal
    assert int(cycle.verdict.code) == 0
    assert abs(float(metrics.power_residual)) < 1e-9
    mine = {name: float(getattr(metrics, name)) for name in RESULTS}
    errors = relative_errors(mine, expected.results, case)
    assert max(errors.values()) < 1e-5, errors


def test_unequal_lobes_displace_each_what_its_own_rise_makes(unequal):
    case, _, metrics, _ = unequal
    motor = case.motor
    angle = np.linspace(0, np.pi, 20_001)
    risen = [
        np.sum(np.maximum(np.diff(np.asarray(motor.cam.pitch_radius(angle + half).value)), 0))
        for half in (0, np.pi)
    ]
    expected = motor.pistons * float(motor.piston.area) * risen[1]
    assert risen[0] < 0.8 * risen[1]
    assert float(metrics.displacement) == pytest.approx(expected, rel=1e-6)


def test_the_net_radial_force_is_the_sum_over_pistons_of_the_second_solver(unequal):
    case, cycle, _, expected = unequal
    load = jax.device_get(jax.jit(radial_load)(cycle))
    pistons, places = case.motor.pistons, 1440
    angle = 2 * np.pi / (pistons * places) * np.arange(pistons * places)
    state = motion(expected.orbit, angle)
    normal = state.normal_force * np.exp(1j * (angle - np.arctan(state.jet[1] / state.jet[0])))
    vector = normal.reshape(pistons, places).sum(0)
    assert float(load.largest) == pytest.approx(np.abs(vector).max(), rel=1e-3)
    assert float(load.mean) == pytest.approx(np.abs(vector).mean(), rel=1e-4)
    orders = shaft_orders(case.motor)
    np.testing.assert_array_equal(orders % pistons, 0)
    turned = 2 * np.pi / (pistons * places) * np.arange(places)
    for order, part in zip(orders, load.by_order, strict=True):
        found = abs(np.mean(vector * np.exp(-1j * order * turned)))
        assert float(part) == pytest.approx(found, abs=1e-4 * np.abs(vector).max()), order
    total = state.force.reshape(pistons, places).sum(0)
    quadrature = Quadrature(expected.orbit.edges, 60)
    mean = pistons * quadrature.mean(motion(expected.orbit, quadrature.angle).force)
    assert float(load.outwards) == pytest.approx(mean, rel=1e-6)
    first = ring_orders(case.motor)[0]
    amplitude = 2 * abs(np.mean(total * np.exp(-1j * first * turned)))
    assert float(load.outwards_by_order[0]) == pytest.approx(amplitude, rel=1e-3)


def test_parts_by_order_make_up_the_whole(unequal):
    """Parseval: what the parts have in square is at most the vector's, and nearly all of it."""
    _, cycle, _, _ = unequal
    load = jax.device_get(jax.jit(radial_load)(cycle))
    squared = float(np.sum(load.by_order**2))
    assert 0.9 * float(load.mean) ** 2 < squared < float(load.largest) ** 2


def test_opposed_pistons_leave_no_order_that_could_push_the_shaft():
    for pistons, repeats in ((6, 2), (8, 6), (8, 2), (9, 3)):
        assert not len(_orders(pistons, repeats))
    assert list(_orders(3, 2)[:4]) == [-33, -27, -21, -15]
    assert len(_orders(7, 6)) == 4


def _orders(pistons: int, repeats: int) -> np.ndarray:
    motor, _, _ = detailed_case(0, STRUCTURE)
    radii = np.asarray(motor.cam.control_radii)
    ring = RadialCam(radii, repeats=repeats)
    return shaft_orders(replace(motor, cam=ring, pistons=pistons))


def test_idle_lobes_drag_in_an_unequal_ring_too(unequal):
    _, cycle, metrics, _ = unequal
    drag = float(jax.jit(idle_drag)(cycle))
    assert 0 < drag < 0.2 * float(metrics.mean_torque)

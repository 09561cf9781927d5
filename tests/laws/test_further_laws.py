"""Springs, friction with speed, leakage with viscosity and past the plate, rating life."""

from math import pi

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from both_solvers import RESULTS, assert_differences, relative_errors, run, slope_along
from detailed_motors import further_case
from motors import STEEL, STRUCTURES, sound_case

from camring.geometry.piston import Roller
from camring.metrics.batch_summary import summarise_batch
from camring.metrics.rating_life import Endured, contact_capacity, endured, rating_life
from camring.numerics.quantity import real
from camring.physics.batch_cycle import BatchResolution
from camring.physics.heat.batch_simulation import simulate_batch
from camring.physics.piston_state import quadrature_samples
from camring.physics.resolution import Resolution
from camring.programs.batch_program import BatchProgram
from camring.reference import independent_results

FINEST = Resolution(elements=2000)
LOSSES = ("throttling_loss", "leakage_loss", "friction_loss")


@pytest.fixture(scope="module")
def simulated():
    """Two motors with what is simulated of them."""
    cases = [further_case(seed) for seed in range(2)]
    return [(case, *run(case, FINEST)) for case in cases]


def record(metrics):
    return {name: float(getattr(metrics, name)) for name in RESULTS}


def test_every_result_is_that_of_the_second_solver(simulated):
    for case, cycle, metrics in simulated:
        assert int(cycle.verdict.code) == 0
        expected = independent_results(*case, tolerance=1e-9)
        errors = relative_errors(record(metrics), expected, case)
        assert max(errors.values()) < 1e-5, errors


def test_the_balance_closes_and_every_loss_is_a_loss(simulated):
    for _, _, metrics in simulated:
        assert abs(float(metrics.power_residual)) < 1e-9
        assert all(float(getattr(metrics, name)) > 0 for name in LOSSES)


def test_many_side_by_side_are_the_motors_alone(simulated):
    cases = [tuple(case) for case, _, _ in simulated] * 4
    batch = jax.tree.map(lambda *leaves: jnp.stack(leaves, axis=-1), *cases)
    found = BatchProgram(summarise_batch)(BatchProgram(simulate_batch)(*batch, BatchResolution()))
    for place, (case, _, metrics) in enumerate(simulated):
        mine = {name: float(leaf[place]) for name, leaf in vars(found).items()}
        errors = relative_errors(mine, record(metrics), case)
        for name in ("mean_torque", "friction_loss", "case_drain", "efficiency", "l10_life"):
            assert errors[name] < 5e-5, (name, errors[name])


def test_slopes_are_differences(simulated):
    """Along a direction in which every new number changes, each by a share of its own."""
    case, cycle, _ = simulated[0]

    def where(motor):
        friction = motor.friction
        return (
            motor.piston.spring.preload,
            motor.piston.spring.rate,
            friction.roller_static,
            friction.side_stribeck,
            motor.roller.length,
            motor.plate_gap.thickness,
            motor.leakage.reference_viscosity,
        )

    shares = np.array([1.0, -0.6, 0.8, -1.3, 0.7, 0.5, 1.1])
    values = np.array([float(each) for each in where(case.motor)])
    results = ("mean_torque", "friction_loss", "min_contact_force", "l10_life", "case_drain")
    slope = slope_along(cycle, case, where, shares * values)
    slopes = {name: getattr(slope, name) for name in results}
    assert_differences(case, where, shares * values, slopes, FINEST)


def test_a_spring_gives_back_what_it_takes():
    """Its torque has no mean, whatever cam it follows."""
    case = further_case(3)
    cam, spring = case.motor.cam, case.motor.piston.spring
    points, weights = np.polynomial.legendre.leggauss(6)  # exact in each span
    spans = np.arange(cam.control_count)[:, None] + (points + 1) / 2
    radius = cam.pitch_radius(jnp.asarray(cam.period / cam.control_count * spans))
    torque = np.asarray(spring.force(radius.value - jnp.min(radius.value)) * radius.first)
    assert abs(np.mean(torque @ weights)) < 1e-13 * np.abs(torque).max()


def test_oil_passes_the_plate_as_through_a_slit():
    """All of it laminar: as the viscosity falls, and with the cube of the film."""
    case = further_case(0)
    plate, fluid, point = case.motor.plate_gap, case.fluid, case.point
    flows = plate.flows(case.motor.valve_plate, fluid, point)
    assert min(map(float, flows)) >= 0
    thinner = eqx.tree_at(lambda f: f.viscosity, fluid, fluid.viscosity / 2)
    twice = plate.flows(case.motor.valve_plate, thinner, point)
    np.testing.assert_allclose(twice, 2 * np.array(flows), rtol=1e-12)
    wider = eqx.tree_at(lambda p: p.thickness, plate, 2 * plate.thickness)
    np.testing.assert_allclose(
        wider.flows(case.motor.valve_plate, fluid, point), 8 * np.array(flows), rtol=1e-12
    )


def of_constant_load(load, roller_radius, length, ring_radius, rollers, speed=2 * pi):
    """Life of a circular ring under rollers of equal load, s; and its parts."""
    curved = real(roller_radius * (1 + roller_radius / (ring_radius - roller_radius)))
    per_load = (load / float(curved) ** (35 / 27)) ** np.array([15 / 4, 10 / 3])
    found = Endured(*(per_load * ring_radius), real(ring_radius))

    class Ring:
        roller = Roller(roller_radius, length, STEEL)
        pistons = rollers

    return float(rating_life(Ring, real(speed), found))


def test_life_falls_with_load_to_the_power_of_ten_thirds_and_with_speed():
    one = of_constant_load(2e4, 0.012, 0.03, 0.1, 8)
    assert of_constant_load(4e4, 0.012, 0.03, 0.1, 8) == pytest.approx(one / 2 ** (10 / 3))
    assert of_constant_load(2e4, 0.012, 0.03, 0.1, 8, 4 * pi) == pytest.approx(one / 2)


@pytest.mark.parametrize("g", [0.05, 0.1, 0.16, 0.22])
def test_a_roller_bearing_has_the_rating_of_iso_281(g):
    """From the same contact, a catalogue's bearing: `C = b fc (l)^(7/9) Z^(3/4) D^(29/27)`.

    Rollers between two circles under the usual load of half the ring; ISO's factor `fc` is
    that of its table 7 by the formula of ISO/TR 1281-1, millimetres and newtons.
    """
    diameter, length, rollers = 15.0, 16.0, 14
    pitch = diameter / g
    angle = (np.arange(200_000) + 0.5) / 200_000 * pi / 2
    shape = np.cos(angle) ** 1.11  # of load over the loaded half: Stribeck's, for lines

    def half(values):
        return float(np.mean(values)) / 2

    lives = []
    for sign, power in ((-1, 4.0), (1, 4.5)):  # inner turns under its load, outer stands
        curved, ring = diameter / 2 * (1 + sign * g), pi * pitch * (1 + sign * g)
        cycles = rollers * (1 - sign * g) / 2
        capacity = float(contact_capacity(real(length / 1e3), real(ring / 1e3), real(cycles)))
        capacity *= (curved / 1e3) ** (35 / 27)
        # Load of the bearing at which this ring lives a million turns.
        most = capacity / half(shape**power) ** (1 / power)
        lives.append(rollers * half(shape * np.cos(angle)) * most)
    rating = sum(one**-4.5 for one in lives) ** (-1 / 4.5)
    part = (1.04 * ((1 - g) / (1 + g)) ** (143 / 108)) ** 4.5
    fc = 0.83 * 207.9 * g ** (2 / 9) * (1 - g) ** (29 / 27) / (1 + g) ** 0.25
    fc *= (1 + part) ** (-2 / 9)
    catalogue = 1.1 * fc * length ** (7 / 9) * rollers**0.75 * diameter ** (29 / 27)
    assert rating == pytest.approx(catalogue, rel=5e-3)


def test_a_ring_that_is_undercut_does_not_live():
    """Nor does it make anything that is no number, which a search would have to throw away."""
    case = sound_case(0, STRUCTURES[0])
    radius = 40 * float(case.motor.roller.radius)
    case = case.changed(lambda c: c.motor.roller.radius, radius)
    cycle, metrics = run(case)
    assert float(metrics.min_undercut_factor) < 0
    assert 0 <= float(metrics.l10_life) < 1e-9
    damage = endured(quadrature_samples(cycle).piston, case.motor)
    # Some elements have no width: nothing times infinity would be no number.
    assert all(np.all(np.isfinite(each)) for each in damage)

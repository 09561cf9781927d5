"""Nothing gets lost: power, oil, torque in two ways, the beat of the pistons."""

from math import gcd, pi

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from both_solvers import run_all, single
from motors import STRUCTURES, sound_case

from camring.metrics.power_balance import power_balance
from camring.physics.piston_state import quadrature_samples
from camring.physics.torque import torque_by_contact, torque_by_virtual_work
from camring.physics.waves.waveforms import shaft_torque, waveforms
from camring.reference import machine_of, solve_machine

COUNT = 8  # motors in the batch that every test below looks at


@pytest.fixture(scope="module")
def cases():
    return [sound_case(seed, STRUCTURES[0]) for seed in range(COUNT)]


@pytest.fixture(scope="module")
def cycles(cases):
    cycle, _ = run_all(cases)
    assert np.all(np.asarray(cycle.verdict.code) == 0)
    return cycle


@pytest.fixture(scope="module")
def metrics(cases):
    return run_all(cases)[1]


def test_hydraulic_power_in_is_shaft_power_and_every_named_loss(metrics):
    explained = metrics.output_power + metrics.throttling_loss + metrics.leakage_loss
    explained += metrics.friction_loss + metrics.compression_loss
    np.testing.assert_allclose(metrics.input_power, explained, rtol=2e-6)
    left = (metrics.input_power - explained) / metrics.input_power
    np.testing.assert_allclose(metrics.power_residual, left, atol=1e-12)
    left_over = metrics.output_power / metrics.input_power
    np.testing.assert_allclose(metrics.energy_efficiency, left_over, rtol=1e-14)


def test_throttling_and_friction_only_ever_cost_power(metrics):
    assert np.all(np.asarray(metrics.throttling_loss) > 0)
    assert np.all(np.asarray(metrics.friction_loss) > 0)


def test_the_product_of_part_efficiencies_is_the_whole(metrics):
    np.testing.assert_allclose(
        metrics.volumetric_efficiency * metrics.hydromechanical_efficiency,
        metrics.efficiency,
        rtol=1e-12,
    )


def test_by_volume_a_bench_reads_the_balance_of_energy_itself(metrics):
    np.testing.assert_allclose(metrics.efficiency, metrics.energy_efficiency, rtol=1e-12)
    assert np.all(metrics.operating_mode == "motor")


def test_with_return_above_supply_it_is_a_pump_with_a_pumps_efficiencies(cases):
    """Oil comes out at the higher pressure; less than the shaft puts in, at every end."""
    reversed_drop = [
        case.changed(
            lambda c: (c.point.supply_pressure, c.point.return_pressure, c.point.case_pressure),
            (case.point.return_pressure, case.point.supply_pressure, case.point.return_pressure),
        )
        for case in cases
    ]
    _, found = run_all(reversed_drop)
    assert np.all(found.operating_mode == "pump")
    shaft, oil = -np.asarray(found.output_power), -np.asarray(found.input_power)
    np.testing.assert_allclose(found.energy_efficiency, oil / shaft, rtol=1e-12)
    assert np.all((oil > 0) & (oil < shaft))
    np.testing.assert_allclose(
        found.hydromechanical_efficiency, found.ideal_torque / found.mean_torque, rtol=1e-12
    )
    np.testing.assert_allclose(
        found.volumetric_efficiency * found.hydromechanical_efficiency, oil / shaft, rtol=1e-12
    )
    machine = machine_of(*reversed_drop[0])
    other = solve_machine(machine, tolerance=1e-8).results
    for name in ("efficiency", "volumetric_efficiency", "energy_efficiency"):
        assert other[name] == pytest.approx(float(getattr(found, name)[0]), rel=1e-5), name


def test_oil_in_is_oil_out_and_leakage_and_compression(cycles):
    """Mean of (V/beta) dP/dt is -mean of P dV/dt / beta: what is squeezed in at one volume."""

    def books(cycle):
        samples = quadrature_samples(cycle)
        piston, speed = samples.piston, cycle.point.shaft_speed
        net = samples.mean(piston.supply_flow + piston.return_flow - piston.leakage_flow)
        swept = speed * piston.chamber.volume_slope
        squeezed = -samples.mean(piston.chamber_pressure * swept) / cycle.fluid.bulk_modulus
        return net, squeezed, samples.mean(piston.supply_flow)

    net, squeezed, supply = eqx.filter_jit(jax.vmap(books))(cycles)
    np.testing.assert_allclose((net - squeezed) / supply, 0, atol=5e-7)


def test_contact_geometry_and_virtual_work_agree_on_torque(cycles):
    angle = np.linspace(0, 2 * pi / 6, 361)
    for index in range(COUNT):
        cycle = single(cycles, index)
        radius = cycle.motor.cam.pitch_radius(angle)
        force = np.linspace(-1e3, 5e4, 361)
        np.testing.assert_allclose(
            torque_by_contact(force, radius), torque_by_virtual_work(force, radius), rtol=1e-12,
            atol=1e-9,
        )  # fmt: skip


def test_torque_of_the_shaft_is_the_sum_over_pistons_where_they_stand(cycles, cases):
    """And it holds only orders that are multiples of lcm(pistons, lobes)."""
    pistons, lobes = cases[0].motor.pistons, cases[0].motor.lobes
    surviving = pistons * lobes // gcd(pistons, lobes)
    angle = 2 * pi * np.arange(surviving * 60) / (surviving * 60)

    def both(cycle):
        places = angle[:, None] + 2 * pi * np.arange(pistons) / pistons
        one = waveforms(cycle, places.reshape(-1))
        radius = cycle.motor.cam.pitch_radius(places.reshape(-1))
        force = one.contact_force * jnp.cos(jnp.arctan(radius.first / radius.value))
        return (force * radius.first).reshape(places.shape).sum(1), shaft_torque(cycle, angle)

    explicit, shaft = eqx.filter_jit(jax.vmap(both))(cycles)
    np.testing.assert_allclose(explicit, shaft, rtol=1e-10)
    orders = np.abs(np.fft.rfft(np.asarray(explicit), axis=1)) / len(angle)
    foreign = np.arange(orders.shape[1]) % surviving != 0
    assert np.all(orders[:, foreign] < 1e-11 * orders[:, :1])
    assert np.all(orders[:, surviving] > 1e-6 * orders[:, 0])


def test_the_shaft_feels_no_net_radial_load_when_pistons_and_lobes_share_a_divisor(cycles, cases):
    """8 pistons on 6 lobes: opposite pistons are at the same place of a lobe."""
    pistons = cases[0].motor.pistons
    angle = np.linspace(0, 1, 50)

    def net_load(cycle):
        places = angle[:, None] + 2 * pi * np.arange(pistons) / pistons
        one = waveforms(cycle, places.reshape(-1))
        slope = cycle.motor.cam.pitch_radius(places.reshape(-1))
        tilt = jnp.arctan(slope.first / slope.value)
        direction = places.reshape(-1) - tilt
        load = (one.contact_force * jnp.exp(1j * direction)).reshape(places.shape)
        return jnp.abs(load.sum(1)), jnp.abs(load).sum(1)

    net, gross = eqx.filter_jit(jax.vmap(net_load))(cycles)
    assert np.all(np.asarray(net) < 1e-9 * np.asarray(gross))


def test_displacement_times_pressure_is_the_torque_of_a_lossless_motor(metrics, cases):
    for index, case in enumerate(cases):
        ideal = float(case.point.pressure_drop) * float(metrics.displacement[index]) / (2 * pi)
        assert float(metrics.ideal_torque[index]) == pytest.approx(ideal, rel=1e-12)
        assert float(metrics.mean_torque[index]) < ideal


def test_power_balance_alone_says_what_the_summary_says(cycles, metrics):
    balance = eqx.filter_jit(
        jax.vmap(lambda cycle: power_balance(cycle, quadrature_samples(cycle)))
    )(cycles)
    np.testing.assert_allclose(balance.input_power, metrics.input_power, rtol=1e-12)

"""The heat balance of case and films: losses that stay, what drain and surface carry off."""

from dataclasses import replace

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from both_solvers import RESULTS, assert_differences, relative_errors, run
from detailed_motors import further_case
from motors import Case

from camring.metrics.batch_summary import summarise_batch
from camring.metrics.power_balance import power_balance
from camring.numerics.quantity import real
from camring.physics.batch_cycle import BatchResolution
from camring.physics.heat.batch_simulation import neighbour_batch, simulate_batch
from camring.physics.heat.collocation import at_collocation_points
from camring.physics.heat.simulation import neighbour
from camring.physics.heat.thermal import Thermal
from camring.physics.oil.presets import OILS, ZERO_CELSIUS, oil_data
from camring.physics.oil.viscosity_line import ViscosityLine
from camring.physics.piston_state import quadrature_samples
from camring.physics.resolution import Resolution
from camring.programs.batch_program import BatchProgram
from camring.reference import independent_results

FINEST = Resolution(elements=2000)
SLOPED = ("case_heat", "case_temperature_rise", "output_power", "friction_loss", "case_drain")
WARM = ("case_heat", "surface_heat", "case_temperature_rise")


def warm_case(seed):
    """A motor of many laws whose case and films warm: films, contacts, leakage, plate."""
    rng = np.random.default_rng([2929, seed])
    motor, fluid, point = further_case(seed)
    inlet = ZERO_CELSIUS + rng.uniform(25, 60)
    swept = (
        motor.pistons
        * motor.lobes
        * float(motor.piston.area)
        * float(np.ptp(np.asarray(motor.cam.control_radii)))
    )
    loss = 0.1 * swept / (2 * np.pi) * float(point.pressure_drop * point.shaft_speed)  # or so
    cooling = Thermal(
        ambient_temperature=inlet - rng.uniform(5, 40),
        heat_transfer=loss / rng.uniform(40, 200),
        specific_heat=rng.uniform(1700, 2100),
    )
    oil = replace(fluid, line=ViscosityLine.of_oil(OILS[seed % 3], inlet))
    return Case(replace(motor, thermal=cooling), oil, point)


@pytest.fixture(scope="module")
def simulated():
    """Two motors with what is simulated of them."""
    cases = [warm_case(seed) for seed in range(2)]
    return [(case, *run(case, FINEST)) for case in cases]


def record(metrics):
    return {name: float(getattr(metrics, name)) for name in (*RESULTS, *WARM)}


def cooled(case, **numbers):
    thermal = replace(case.motor.thermal, **numbers)
    return Case(replace(case.motor, thermal=thermal), case.fluid, case.point)


def drain_heat(case, metrics):
    """What the oil that leaves the case takes along, W."""
    density = float(case.fluid.density_at(case.point.case_pressure))
    specific = float(case.motor.thermal.specific_heat)
    return density * specific * float(metrics.case_drain * metrics.case_temperature_rise)


def test_every_result_is_that_of_the_second_solver(simulated):
    for case, cycle, metrics in simulated:
        assert int(cycle.verdict.code) == 0
        expected = independent_results(*case, tolerance=1e-8)
        found = record(metrics)
        errors = relative_errors(found, expected, case)
        errors |= {name: abs(found[name] / expected[name] - 1) for name in WARM}
        assert max(errors.values()) < 1e-5, errors


def test_what_stays_in_the_motor_is_what_drain_and_surface_carry_off(simulated):
    for case, _, metrics in simulated:
        carried = drain_heat(case, metrics) + float(metrics.surface_heat)
        assert carried == pytest.approx(float(metrics.case_heat), rel=1e-9)
        assert float(metrics.case_temperature_rise) > 0
        assert abs(float(metrics.power_residual)) < 1e-9


def test_without_heat_transfer_all_that_stays_leaves_with_the_drain(simulated):
    """`t = heat / (mass flow * c)`; the surface gives nothing."""
    case = cooled(simulated[0][0], heat_transfer=real(0.0))
    _, metrics = run(case, FINEST)
    assert float(metrics.surface_heat) == 0
    assert drain_heat(case, metrics) == pytest.approx(float(metrics.case_heat), rel=1e-9)


def test_oil_that_only_leaks_warms_by_its_pressure_over_its_heat(simulated):
    """`t = dp / (rho c)`, however much it is: a plate that loses far more than all else."""
    case = cooled(simulated[0][0], heat_transfer=real(0.0))
    wide = case.changed(lambda c: c.motor.plate_gap.thickness, 2e-4)
    _, metrics = run(wide, FINEST)
    fluid, point = case.fluid, case.point
    supply, back, end = (
        float(fluid.potential(each))
        for each in (point.supply_pressure, point.return_pressure, point.case_pressure)
    )
    flows = wide.motor.plate_flows(fluid, point)
    share = float(flows.supply_to_case / (flows.supply_to_case + flows.return_to_case))
    heat = share * supply + (1 - share) * back - end  # J/kg, of oil whose amount is its mass
    expected = heat / float(case.motor.thermal.specific_heat)
    assert float(metrics.case_temperature_rise) == pytest.approx(expected, rel=2e-3)


def test_a_boundless_heat_transfer_keeps_the_temperature_of_the_surroundings(simulated):
    case = cooled(simulated[0][0], heat_transfer=real(1e9))
    _, metrics = run(case, FINEST)
    thermal, line = case.motor.thermal, case.fluid.line
    found = float(line.temperature + metrics.case_temperature_rise)
    assert found == pytest.approx(float(thermal.ambient_temperature), abs=1e-4)
    assert float(metrics.case_temperature_rise) < 0  # it is colder there than the oil that comes in


def test_the_temperature_rises_with_what_is_lost(simulated):
    case, _, metrics = simulated[0]
    rises = [float(metrics.case_temperature_rise)]
    for times in (2.0, 4.0):
        rough = case.changed(
            lambda c: c.motor.friction.roller, times * float(case.motor.friction.roller)
        )
        rises.append(float(run(rough, FINEST)[1].case_temperature_rise))
    assert rises == sorted(rises)
    assert rises[-1] > rises[0] + 0.1


def test_a_motor_at_the_temperature_that_was_found_is_the_same_motor(simulated):
    """Its oil as viscous from the start, in a case that stays cold: only ports see other oil."""
    case, _, metrics = simulated[0]
    thin = float(case.fluid.viscosity * case.fluid.line.ratio(metrics.case_temperature_rise))
    critical = float(case.motor.orifice.critical_flow_number)
    ratio = float(case.fluid.viscosity) / thin
    # The flow number of a port holds the viscosity beneath and its limit above.
    as_warm = case.changed(lambda c: c.fluid.viscosity, thin)
    as_warm = as_warm.changed(lambda c: c.motor.orifice.critical_flow_number, critical * ratio)
    inlet = case.fluid.line.temperature
    _, alone = run(cooled(as_warm, ambient_temperature=inlet, heat_transfer=real(1e12)), FINEST)
    assert abs(float(alone.case_temperature_rise)) < 1e-7
    for name in ("mean_torque", "case_drain", "friction_loss", "leakage_loss", "case_heat"):
        assert float(getattr(alone, name)) == pytest.approx(float(getattr(metrics, name)), rel=1e-8)


def test_many_side_by_side_are_the_motors_alone(simulated):
    batch, found, _ = in_batch(simulated)
    assert not np.any(np.asarray(batch.cycle.verdict.code))
    for place, (case, _, metrics) in enumerate(simulated):
        mine = {name: float(leaf[place]) for name, leaf in vars(found).items()}
        errors = relative_errors(mine, record(metrics), case)
        for name in ("mean_torque", "friction_loss", "case_drain", "efficiency"):
            assert errors[name] < 5e-5, (name, errors[name])
        for name in WARM:
            assert mine[name] == pytest.approx(float(getattr(metrics, name)), rel=5e-5), name


def in_batch(simulated):
    stacked = side_by_side([case for case, _, _ in simulated] * 4)
    batch = IN_BATCH(*stacked, BatchResolution())
    return batch, BatchProgram(summarise_batch)(batch), stacked


IN_BATCH = BatchProgram(simulate_batch)


def side_by_side(cases):
    return jax.tree.map(lambda *leaves: jnp.stack(leaves, axis=-1), *map(tuple, cases))


def test_balances_close_from_slow_to_fast_and_from_cold_to_warm(simulated):
    """Slow motors' pressure hangs on what leaks: rise and pressure take more turns."""
    rng = np.random.default_rng(4)
    cases = []
    for case in [case for case, _, _ in simulated] * 32:
        inlet = float(case.fluid.line.temperature)
        cooling = {
            "ambient_temperature": real(inlet + rng.uniform(-60, 10)),
            "heat_transfer": rng.uniform(0, 4) * case.motor.thermal.heat_transfer,
        }
        point = replace(
            case.point,
            shaft_speed=case.point.shaft_speed * rng.uniform(0.05, 1.5),
            supply_pressure=case.point.supply_pressure * rng.uniform(0.3, 1.2),
        )
        cases.append(Case(cooled(case, **cooling).motor, case.fluid, point))
    batch = IN_BATCH(*side_by_side(cases), BatchResolution())
    assert not np.any(np.asarray(batch.cycle.verdict.code))
    rise = np.asarray(batch.cycle.motor.thermal.rise)
    assert np.min(rise) < 0
    assert np.max(rise) > 20


def test_a_motor_without_a_number_leaves_the_others_as_they_are(simulated):
    case, other = (case for case, _, _ in simulated)
    none = cooled(case, ambient_temperature=real(np.nan))
    beside = IN_BATCH(*side_by_side([none, other]), BatchResolution()).cycle
    alone = IN_BATCH(*side_by_side([other, other]), BatchResolution()).cycle
    assert int(beside.verdict.code[0]) != 0
    assert int(beside.verdict.code[1]) == 0
    assert float(beside.motor.thermal.rise[1]) == float(alone.motor.thermal.rise[1])


def changed_numbers(motor):
    thermal = motor.thermal
    return (
        thermal.ambient_temperature,
        thermal.heat_transfer,
        thermal.specific_heat,
        motor.gap.clearance,
        motor.friction.roller,
        motor.leakage.reference_viscosity,
        motor.churning.moment_coefficient,
    )


SHARES = np.array([0.05, -0.6, 0.8, 0.4, 0.7, 1.1, 0.9])


def test_slopes_are_differences(simulated):
    """Along a direction in which numbers of the balance and of its losses change."""
    case, cycle, _ = simulated[0]
    values = np.array([float(each) for each in changed_numbers(case.motor)])
    still = jax.tree.map(jnp.zeros_like, case.motor)
    along = eqx.tree_at(changed_numbers, still, tuple(map(real, SHARES * values)))
    slope = _slope(cycle, *case, along)
    slopes = {name: slope[name] for name in SLOPED}
    assert_differences(case, changed_numbers, SHARES * values, slopes, FINEST)


@jax.jit
def _slope(cycle, motor, fluid, point, along):
    def found(motor):
        near = neighbour(cycle, motor, fluid, point)
        return sloped(near, quadrature_samples(near))

    return jax.jvp(found, (motor,), (along,))[1]


def sloped(cycle, samples):
    """Results that need no spectrum, whose program would take a minute to make."""
    power = vars(power_balance(cycle, samples))
    found = {name: power[name] for name in SLOPED if name in power}
    return {**found, "case_temperature_rise": cycle.motor.thermal.rise}


def test_slopes_of_a_batch_are_those_of_its_motors(simulated):
    case, cycle, _ = simulated[0]
    batch, _, stacked = in_batch(simulated)
    values = changed_numbers(case.motor)
    still = jax.tree.map(jnp.zeros_like, case.motor)
    alone = _slope(
        cycle,
        *case,
        eqx.tree_at(
            changed_numbers, still, tuple(real(s) * v for s, v in zip(SHARES, values, strict=True))
        ),
    )
    together = _batch_slope(batch.cycle, *stacked)
    for name in SLOPED:
        assert float(together[name][0]) == pytest.approx(float(alone[name]), rel=2e-4), name


@jax.jit
def _batch_slope(known, motor, fluid, point):
    def found(motor):
        near = neighbour_batch(known, motor, fluid, point, BatchResolution())
        return sloped(near.cycle, at_collocation_points(near))

    values = changed_numbers(motor)
    still = jax.tree.map(jnp.zeros_like, motor)
    moved = tuple(share * value for share, value in zip(SHARES, values, strict=True))
    return jax.jvp(found, (motor,), (eqx.tree_at(changed_numbers, still, moved),))[1]


def test_the_block_takes_what_the_oil_in_the_case_resists(simulated):
    """`C rho w^2 R^5 / 2`, at every angle, beside all other friction; nothing at standstill."""
    case = simulated[0][0]
    smooth = case.changed(lambda c: c.motor.churning.moment_coefficient, 0.0)
    smooth = cooled(smooth, heat_transfer=real(1e12))
    rough = cooled(case, heat_transfer=real(1e12))  # at one temperature, so that nothing else moves
    without, with_it = (run(each, FINEST)[1] for each in (smooth, rough))
    speed = float(case.point.shaft_speed)
    block = case.motor.churning
    resisted = float(block.moment_coefficient * block.radius**5 * case.fluid.density) * speed**2 / 2
    assert float(without.mean_torque - with_it.mean_torque) == pytest.approx(resisted, rel=1e-7)
    taken = float(with_it.friction_loss - without.friction_loss)
    assert taken == pytest.approx(resisted * speed, rel=1e-7)
    still = case.motor.churning.torque(case.fluid, real(0.0))
    assert float(still) == 0


@pytest.mark.parametrize("name", OILS)
def test_the_viscosity_line_is_that_of_the_oils(name):
    """From one temperature to another, as `oil = NAME, temperature = ...` would have it."""
    line = ViscosityLine.of_oil(name, 320.0)
    for kelvin in (260.0, 300.0, 370.0):
        expected = oil_data(name, kelvin).viscosity / oil_data(name, 320.0).viscosity
        assert float(line.ratio(kelvin - 320.0)) == pytest.approx(expected, rel=1e-12)

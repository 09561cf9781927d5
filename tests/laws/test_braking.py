"""The four quadrants: with the return above the supply the load drives, and the machine brakes."""

from dataclasses import replace

import jax
import numpy as np
import pytest
from both_solvers import RESULTS, scales
from motors import STRUCTURES, Case, sound_case

from camring.physics.resolution import Resolution
from camring.programs.compiled import simulate, summarise
from camring.reference import independent_results

FINE = Resolution(elements=2000)
QUADRANTS = [(False, 1), (True, -1), (True, 1), (False, -1)]  # backwards, sign of the drop


def in_quadrant(backwards: bool, sign: int, case_low: bool = True) -> Case:
    """A motor that is other forwards than backwards, its pressures exchanged where it brakes."""
    case = sound_case(8, STRUCTURES[0])
    case = case.changed(lambda c: c.motor.valve_plate.shift, 0.004 * case.motor.valve_plate.pitch)
    motor, fluid, point = case
    ends = (point.supply_pressure, point.return_pressure)
    supply, back = ends if sign > 0 else ends[::-1]
    drained = point.return_pressure if case_low else back
    asked = replace(
        point, supply_pressure=supply, return_pressure=back, case_pressure=drained,
        reverse=backwards,
    )  # fmt: skip
    return Case(motor, fluid, asked)


def results(case: Case, resolution: Resolution | None = None):
    return jax.device_get(summarise(simulate(*case, resolution)))


@pytest.fixture(scope="module")
def found():
    return {each: results(in_quadrant(*each), FINE) for each in QUADRANTS}


@pytest.mark.parametrize("quadrant", QUADRANTS)
def test_the_balance_of_energy_closes_in_every_quadrant(found, quadrant):
    assert abs(float(found[quadrant].power_residual)) < 1e-9


@pytest.mark.parametrize("quadrant", QUADRANTS)
def test_where_the_load_drives_the_machine_is_a_pump_and_loses_what_a_pump_loses(found, quadrant):
    here = found[quadrant]
    assert here.operating_mode == ("motor" if quadrant[1] > 0 else "pump")
    assert 0.5 < float(here.efficiency) < 1
    assert float(here.throttling_loss) > 0
    assert float(here.friction_loss) > 0
    assert np.sign(float(here.mean_torque)) == np.sign(float(here.ideal_torque)) == quadrant[1]


@pytest.mark.parametrize("quadrant", QUADRANTS[1::2])
def test_efficiency_of_a_brake_is_oil_over_shaft_by_the_flow_it_takes_in(found, quadrant):
    here, point = found[quadrant], in_quadrant(*quadrant).point
    oil = -float(point.pressure_drop) * float(here.supply_flow)
    shaft = -float(here.mean_torque) * float(point.shaft_speed)
    assert float(here.efficiency) == pytest.approx(oil / shaft, rel=1e-12)
    product = float(here.volumetric_efficiency) * float(here.hydromechanical_efficiency)
    assert float(here.efficiency) == pytest.approx(product, rel=1e-12)


@pytest.mark.parametrize("quadrant", QUADRANTS)
def test_down_to_a_drained_case_no_loss_is_negative_and_the_balance_closes(found, quadrant):
    """What leaks counts to where it arrives; input and leakage alike leave out nothing."""
    here = found[quadrant]
    losses = ("throttling_loss", "full_leakage_loss", "friction_loss")
    assert all(float(getattr(here, name)) > 0 for name in losses)
    explained = float(here.output_power) + float(here.compression_loss)
    explained += sum(float(getattr(here, name)) for name in losses)
    assert float(here.port_power) == pytest.approx(explained, rel=1e-9)
    assert 0 < float(here.port_efficiency) < 1


@pytest.mark.parametrize("quadrant", QUADRANTS)
def test_between_the_ports_counts_what_flows_there_above_the_case(found, quadrant):
    """ISO 4409's overall efficiency: power at both ports, each by its own flow, and the shaft.

    Oil that works on pistons swells by that work over its modulus, so that more leaves by volume.
    """
    _, fluid, point = in_quadrant(*quadrant)
    here = found[quadrant]
    case, flow = float(point.case_pressure), float(here.supply_flow)
    swells = (float(here.output_power) + float(here.friction_loss)) / float(fluid.bulk_modulus)
    out = float(here.return_flow) + float(here.case_drain)
    assert flow + swells == pytest.approx(out, rel=1e-8)
    fed = (float(point.supply_pressure) - case) * flow
    given = (float(point.return_pressure) - case) * float(here.return_flow)
    swollen = (float(point.return_pressure) - case) * swells
    assert float(here.port_power) == pytest.approx(fed - given + swollen, rel=1e-8)
    ratio = float(here.output_power) / float(here.port_power)
    expected = ratio if quadrant[1] > 0 else 1 / ratio
    assert float(here.port_efficiency) == pytest.approx(expected, rel=1e-12)


def test_a_brake_that_leaks_more_is_worse_by_what_it_delivers():
    """By what it takes in it is better: drained oil counts as delivered."""
    tight = in_quadrant(False, -1)
    leaky = tight.changed(
        lambda c: c.motor.leakage.coefficient, 10 * tight.motor.leakage.coefficient
    )
    tight, leaky = results(tight), results(leaky)
    assert float(leaky.leakage_loss) < float(tight.leakage_loss) < 0
    assert float(leaky.full_leakage_loss) > 3 * float(tight.full_leakage_loss)
    assert float(leaky.port_efficiency) < float(tight.port_efficiency)
    assert float(leaky.return_flow) < float(tight.return_flow)


@pytest.mark.parametrize("quadrant", QUADRANTS[1::2])
def test_with_the_case_at_its_return_every_loss_of_a_brake_is_one(quadrant):
    here = results(in_quadrant(*quadrant, case_low=False))
    for name in ("throttling_loss", "leakage_loss", "friction_loss"):
        assert float(getattr(here, name)) > 0, name


@pytest.mark.parametrize("quadrant", QUADRANTS[1::2])
def test_the_second_solver_agrees_where_the_machine_brakes(quadrant):
    case = in_quadrant(*quadrant)
    here, expected = results(case), independent_results(*case, tolerance=1e-9)
    size = scales(expected, replace_drop(case))
    for name in RESULTS:
        error = abs(float(getattr(here, name)) - expected[name])
        assert error < 1e-5 * size[name], name


def replace_drop(case: Case) -> Case:
    """With its pressures the other way round: a scale of pressure has no sign."""
    point = case.point
    return Case(
        case.motor,
        case.fluid,
        replace(
            point,
            supply_pressure=point.return_pressure,
            return_pressure=point.supply_pressure,
        ),
    )


def test_over_and_undershoot_count_from_the_higher_and_the_lower_pressure(found):
    here, point = found[False, -1], in_quadrant(False, -1).point
    over = float(here.max_pressure) - float(point.return_pressure)
    assert float(here.pressure_overshoot) == pytest.approx(max(over, 0.0), abs=1e-3)
    under = float(point.supply_pressure) - float(here.min_pressure)
    assert float(here.pressure_undershoot) == pytest.approx(max(under, 0.0), abs=1e-3)
    assert np.isfinite(float(here.torque_ripple))

"""The reference motors that came with the issue, from another adaptive solver.

The independent solver is tested first, then the product by the 1e-5 it promises.
"""

import dataclasses

import numpy as np
import pytest
from both_solvers import records, run_all
from motors import Case
from reference_files import DATA, reference_machines, reference_results
from scipy.integrate import solve_ivp

from camring.files.motor import read_motor_file
from camring.reference import machine_of, solve_machine
from camring.reference.orbit import periodic_orbit

MOTORS = ("mid", "wheel_motor", "winch_motor", "mill_motor", "mid_aerated")

# The references sample their extremes and integrate to 1e-10 of a large pressure; the
# independent solver, converged to 1e-9, differs from them by at most this.
REFERENCE_ACCURACY = 5e-6


@pytest.mark.parametrize("name", MOTORS)
def test_the_independent_solver_meets_the_references(name):
    for machine, expected in zip(reference_machines(name), reference_results(name), strict=True):
        found = solve_machine(machine, tolerance=1e-8).results
        assert found.keys() >= expected.keys()
        for result, value in expected.items():
            assert found[result] == pytest.approx(value, rel=REFERENCE_ACCURACY, abs=1e-12), result


@pytest.mark.parametrize("name", ["wheel_motor", "mid_aerated"])
def test_the_independent_solver_has_converged(name):
    machine = reference_machines(name)[0]
    coarse = solve_machine(machine, tolerance=1e-8).results
    fine = solve_machine(machine, tolerance=1e-11).results
    for result, value in fine.items():
        assert coarse[result] == pytest.approx(value, rel=1e-7, abs=1e-12), result


@pytest.mark.parametrize("name", MOTORS)
def test_the_independent_power_balance_closes(name):
    for machine in reference_machines(name):
        found = solve_machine(machine, tolerance=1e-8).results
        losses = sum(found[f"{k}_loss"] for k in ("throttling", "leakage", "friction"))
        losses += found["compression_loss"]
        left = found["input_power"] - found["output_power"] - losses
        assert abs(left) < 1e-8 * found["input_power"]


def test_lsoda_and_radau_find_the_same_orbit():
    """The stiff solver under the independent solver is not taken on trust either."""
    machine = reference_machines("mid")[0]
    orbit = periodic_orbit(machine, 1e-9)
    chamber = orbit.chamber
    pressure = float(orbit.pressure(np.array([chamber.edges[0]]))[0])
    for start, end in zip(chamber.edges[:-1], chamber.edges[1:], strict=True):
        shift = chamber.shift_at(start, end)
        slopes = chamber.slopes(start, end, shift)
        step = solve_ivp(
            lambda angle, y, slopes=slopes: [slopes(float(y[0]), angle)[0]],
            (start, end),
            [chamber.state(pressure, shift)],
            method="Radau",
            rtol=1e-8,
            atol=1e-11,
        )
        pressure = float(chamber.pressure(step.y[0, -1], shift))
        expected = float(orbit.pressure(np.array([end - 1e-13]))[0])
        assert abs(pressure - expected) < 1e-8 * chamber.scale


@pytest.mark.parametrize("name", MOTORS)
def test_the_product_meets_the_references(name):
    """1e-5 relative on each result, read from the same file that the commands read."""
    system = read_motor_file(DATA / f"{name}.toml").system
    motor = dataclasses.replace(system.motor, name="")  # a name would cost a compilation
    cases = [Case(motor, system.fluid, point) for point in system.operating_points]
    cycles, metrics = run_all(cases)
    assert np.all(np.asarray(cycles.verdict.code) == 0)
    for found, expected in zip(records(metrics), reference_results(name), strict=True):
        for result, value in expected.items():
            assert found[result] == pytest.approx(value, rel=1e-5, abs=1e-12), result


@pytest.mark.parametrize("name", MOTORS)
def test_both_readers_of_a_reference_file_agree(name):
    """The tests' own few lines of TOML and the product's reader give the same machine."""
    system = read_motor_file(DATA / f"{name}.toml").system
    for machine, point in zip(reference_machines(name), system.operating_points, strict=True):
        other = machine_of(system.motor, system.fluid, point)
        for field in dataclasses.fields(machine):
            one, two = getattr(machine, field.name), getattr(other, field.name)
            if dataclasses.is_dataclass(one):
                one, two = dataclasses.astuple(one), dataclasses.astuple(two)
            if one is None or isinstance(one, str | frozenset):
                assert one == two, field.name
            elif isinstance(one, tuple):
                for a, b in zip(one, two, strict=True):
                    assert a == b if isinstance(a, str | tuple) else a == pytest.approx(b)
            else:
                np.testing.assert_allclose(one, two, rtol=1e-12, err_msg=field.name)

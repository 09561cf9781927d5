"""A motor with laws that this package does not have: they see pressure and sliding speed."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from both_solvers import RESULTS, relative_errors, run
from jaxtyping import Array, Float
from motors import STRUCTURES, Case, sound_case

from camring.numerics.quantity import Q, real
from camring.physics.friction import AbstractFriction
from camring.physics.leakage import AbstractLeakage
from camring.physics.piston_state import quadrature_samples
from camring.reference import (
    FRICTIONS,
    LEAKAGES,
    Friction,
    NoSecondSolver,
    independent_results,
    machine_of,
)


class StiffeningLeakage(AbstractLeakage):
    """A gap whose oil thickens with pressure: `Q = Cl drop exp(-a mean pressure)`."""

    coefficient: Q[Float[Array, ""], "m3/(s.Pa)"] = eqx.field(converter=real)
    thickening: Q[Float[Array, ""], "1/Pa"] = eqx.field(converter=real)

    def flow(self, ends, piston, fluid) -> Q[Float[Array, "*grid"], "m3/s"]:
        mean = (ends.chamber_pressure + ends.case_pressure) / 2
        return self.coefficient * ends.drop * jnp.exp(-self.thickening * mean)


class FallingFriction(AbstractFriction):
    """Stribeck's fall of friction with the roller's sliding speed, and a side that rubs."""

    damping: Q[Float[Array, ""], "N.s/m"] = eqx.field(converter=real)
    slow: Q[Float[Array, ""], "1"] = eqx.field(converter=real)
    fast: Q[Float[Array, ""], "1"] = eqx.field(converter=real)
    stribeck_speed: Q[Float[Array, ""], "m/s"] = eqx.field(converter=real)

    def coefficient(self, speed):
        return self.fast + (self.slow - self.fast) * jnp.exp(-speed / self.stribeck_speed)

    def viscous_damping(self, piston, fluid) -> Q[Float[Array, ""], "N.s/m"]:
        return self.damping

    def loss_torque(self, contacts, piston, fluid) -> Q[Float[Array, "*grid"], "N.m"]:
        pressed = jnp.maximum(contacts.normal_force, 0) * contacts.ring_length
        rubbed = contacts.side_force * jnp.abs(contacts.radius.first)
        of_roller = self.coefficient(contacts.roller_speed) * pressed
        return of_roller + self.coefficient(contacts.piston_speed) * rubbed


def leakage_anew(law, motor, fluid):
    coefficient, thickening = float(law.coefficient), float(law.thickening)

    def flow(pressure, case):
        return coefficient * (pressure - case) * np.exp(-thickening * (pressure + case) / 2)

    return flow


def friction_anew(law, motor, fluid):
    slow, fast, speed = float(law.slow), float(law.fast), float(law.stribeck_speed)

    def share(at):
        return fast + (slow - fast) * np.exp(-at / speed)

    def lost(at):
        rolling = share(at.roller_speed) * np.maximum(at.normal_force, 0) * at.ring_length
        return rolling + share(at.piston_speed) * at.side_force * np.abs(at.slope)

    return Friction(float(law.damping), lost)


@pytest.fixture(scope="module")
def case():
    motor, fluid, point = sound_case(0, STRUCTURES[0])
    speed = float(point.shaft_speed)
    laws = (
        StiffeningLeakage(30 * motor.leakage.coefficient, 3e-8),
        FallingFriction(motor.friction.damping, 0.04, 0.008, 0.1 * speed),
    )
    motor = eqx.tree_at(lambda m: (m.leakage, m.friction), motor, laws)
    return Case(motor, fluid, point)


@pytest.fixture(scope="module")
def simulated(case):
    cycle, metrics = run(case)
    assert int(cycle.verdict.code) == 0
    return cycle, metrics


@pytest.fixture
def written_anew(monkeypatch):
    monkeypatch.setitem(LEAKAGES, StiffeningLeakage, leakage_anew)
    monkeypatch.setitem(FRICTIONS, FallingFriction, friction_anew)


def test_power_and_oil_are_kept_whatever_the_law(simulated):
    cycle, metrics = simulated
    assert abs(float(metrics.power_residual)) < 2e-6
    samples = jax.jit(quadrature_samples)(cycle)
    piston, beta = samples.piston, cycle.fluid.bulk_modulus
    net = samples.mean(piston.supply_flow + piston.return_flow - piston.leakage_flow)
    swept = cycle.point.shaft_speed * piston.chamber.volume_slope
    squeezed = -samples.mean(piston.chamber_pressure * swept) / beta
    supply = samples.mean(piston.supply_flow)
    assert float((net - squeezed) / supply) == pytest.approx(0, abs=5e-7)
    assert float(metrics.leakage_loss) > 0
    assert float(metrics.friction_loss) > 0


def test_a_law_written_a_second_time_is_checked_by_the_second_solver(simulated, case, written_anew):
    found = {name: float(getattr(simulated[1], name)) for name in RESULTS}
    errors = relative_errors(found, independent_results(*case, tolerance=1e-8), case)
    assert max(errors.values()) < 1e-5, errors


def test_a_second_writing_is_found_by_its_class_name_too(case, monkeypatch, written_anew):
    by_class = machine_of(*case)
    for written, law in ((LEAKAGES, StiffeningLeakage), (FRICTIONS, FallingFriction)):
        monkeypatch.setitem(written, law.__name__, written[law])
        monkeypatch.delitem(written, law)
    by_name = machine_of(*case)
    assert by_name.leakage(2e7, 1e5) == by_class.leakage(2e7, 1e5) > 0


def test_a_law_written_once_has_no_second_solver(case):
    with pytest.raises(NoSecondSolver, match="no second solver for StiffeningLeakage"):
        machine_of(*case)

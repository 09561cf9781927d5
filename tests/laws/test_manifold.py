"""A manifold before the supply windows: two solvers, its limits, its books.

Slopes, air and a free ring: with a second manifold, in `test_return_manifold.py`.
"""

from math import pi

import equinox as eqx
import jax
import numpy as np
import pytest
from both_solvers import records, relative_errors, run_all, single
from motors import STRUCTURES, Case, replaced_manifold, sound_case, stacked, with_manifold

from camring.numerics.radau import STAGE_INTEGRALS
from camring.physics.heat.simulation import simulate
from camring.physics.manifold.coupling import line_flow
from camring.physics.piston_state import quadrature_samples, sample_angles
from camring.reference import independent_results

RADIAL, RING = STRUCTURES[0], STRUCTURES[1]  # 8 pistons on 6 lobes; 6 on a free ring


def without_manifold(case: Case) -> Case:
    return Case(replaced_manifold(case.motor, None), case.fluid, case.point)


def in_manifold(case: Case, volume: float, line_conductance: float) -> Case:
    """The motor with these numbers of its manifold."""
    return case.changed(
        lambda c: (c.motor.manifold.volume, c.motor.manifold.line_conductance),
        (volume, line_conductance),
    )


def numbers(case: Case) -> np.ndarray:
    manifold = case.motor.manifold
    return np.array([float(manifold.volume), float(manifold.line_conductance)])


CASES = {
    "wide line": with_manifold(sound_case(0, RADIAL), 0.03, 2.0),
    "narrow line, small manifold": with_manifold(sound_case(4, RADIAL), 0.2, 0.1),
    "narrow line, wide manifold": with_manifold(sound_case(8, RADIAL), 0.15, 20.0),
}
SUBJECT = "wide line"
LARGE, ENDLESS, WIDE_OPEN, NO_VOLUME, HARDER = range(5)
OF_SET_PRESSURE = {
    "ideal_torque", "hydromechanical_efficiency", "efficiency", "energy_efficiency", "input_power",
    "port_power", "port_efficiency", "spectral_torque", "spectral_pressure",
}  # fmt: skip
"""Results that count from the set pressure, not from that before the windows."""


@pytest.fixture(scope="module")
def radial():
    """Every motor of this structure that the tests look at, in few batches."""
    subject = CASES[SUBJECT]
    volume, conductance = numbers(subject)
    limits = [
        in_manifold(subject, 10.0, conductance),
        in_manifold(subject, 1000.0, conductance),
        in_manifold(subject, volume, 1e-4),  # loses 3 Pa
        in_manifold(subject, 1e-9, conductance),
        in_manifold(subject, volume, conductance / 6),
    ]
    cases = [*CASES.values(), *limits]
    return cases, *run_all(cases)


def limit(index: int) -> int:
    return len(CASES) + index


def errors(metrics, index, case: Case, tolerance: float = 1e-8) -> dict[str, float]:
    """Against the other solver; what is new with a manifold is compared with itself."""
    expected = independent_results(*case, tolerance=tolerance)
    found = {name: float(getattr(metrics, name)[index]) for name in expected}
    new = ("line_loss", "supply_pressure_swing")
    return relative_errors(found, expected, case) | {
        name: abs(found[name] / expected[name] - 1) for name in new
    }


@pytest.mark.parametrize("name", CASES)
def test_every_result_is_that_of_the_independent_solver(radial, name):
    _, cycles, metrics = radial
    index = list(CASES).index(name)
    assert int(cycles.verdict.code[index]) == 0
    found = errors(metrics, index, CASES[name])
    assert max(found.values()) < 1e-5, found


class TestLimits:
    def test_a_manifold_without_end_is_a_constant_supply_at_its_pressure(self, radial):
        """By the other solver, which here needs no manifold; first order in one over volume."""
        cases, cycles, metrics = radial
        differences = []
        for index in (limit(LARGE), limit(ENDLESS)):
            states = np.asarray(cycles.manifold.stage_state[index])  # for this oil a pressure
            held = without_manifold(cases[index])
            held = held.changed(lambda c: c.point.supply_pressure, states.mean())
            expected = independent_results(*held, tolerance=1e-9)
            found = records(single(metrics, index))[0]
            errors = relative_errors(found, expected, held)
            differences.append({n: e for n, e in errors.items() if n not in OF_SET_PRESSURE})
        large, endless = differences
        assert max(endless.values()) < 2e-6, endless
        for name in ("torque_ripple", "flow_ripple"):
            assert 80 < large[name] / endless[name] < 125
        swing = np.asarray(metrics.supply_pressure_swing)
        assert swing[limit(LARGE)] == pytest.approx(100 * swing[limit(ENDLESS)], rel=1e-3)

    def test_a_wide_line_is_none(self, radial):
        cases, _, metrics = radial
        plain = without_manifold(cases[0])
        found = records(single(metrics, limit(WIDE_OPEN)))[0]
        errors = relative_errors(found, independent_results(*plain, tolerance=1e-9), plain)
        assert max(errors.values()) < 2e-6, errors

    def test_a_manifold_of_no_volume_passes_on_at_every_instant_what_the_pistons_draw(self, radial):
        cases, cycles, _ = radial
        pistons = cases[0].motor.pistons
        angle = np.linspace(0, 2 * pi, 2001)
        places = angle[:, None] + 2 * pi * np.arange(pistons) / pistons

        @eqx.filter_jit
        def both(cycle):
            state = sample_angles(cycle, places.reshape(-1))
            drawn = state.supply_flow.reshape(places.shape).sum(1)
            manifold_pressure = state.supply_pressure.reshape(places.shape)
            return (
                line_flow(
                    cycle.motor.manifold,
                    cycle.fluid,
                    cycle.point.supply_pressure,
                    manifold_pressure[:, 0],
                ),
                drawn,
                manifold_pressure,
            )

        line, drawn, manifold_pressure = both(single(cycles, limit(NO_VOLUME)))
        assert np.ptp(drawn) > 0.1 * np.mean(drawn)
        np.testing.assert_allclose(line, drawn, atol=2e-6 * np.mean(drawn))
        # All pistons see one pressure, whatever their place on the ring.
        np.testing.assert_allclose(
            manifold_pressure, manifold_pressure[:, :1] + 0 * manifold_pressure, rtol=1e-12
        )


class TestBooks:
    def test_power_in_is_shaft_power_and_every_loss_with_the_lines(self, radial):
        _, _, metrics = radial
        assert np.all(np.asarray(metrics.line_loss[: len(CASES)]) > 0)
        np.testing.assert_allclose(metrics.power_residual, 0, atol=1e-9)

    def test_the_line_brings_what_the_pistons_draw(self, radial):
        _, cycles, metrics = radial

        @eqx.filter_jit
        @jax.vmap
        def books(cycle):
            samples = quadrature_samples(cycle)
            manifold_pressure = samples.piston.supply_pressure
            port_pressure = cycle.point.supply_pressure
            brought = samples.mean(
                line_flow(cycle.motor.manifold, cycle.fluid, port_pressure, manifold_pressure)
            )
            return brought, cycle.motor.pistons * samples.mean(samples.piston.supply_flow)

        brought, drawn = books(cycles)
        # Rounding: one loses 3 of 300e5 Pa in its line, one has 1000 m3 of oil.
        known = ~np.isin(np.arange(len(drawn)), [limit(WIDE_OPEN), limit(ENDLESS)])
        np.testing.assert_allclose(brought[known], drawn[known], rtol=1e-9)
        np.testing.assert_allclose(metrics.supply_flow, drawn, rtol=1e-12)

    def test_a_narrower_line_costs_torque(self, radial):
        _, _, metrics = radial
        torque = metrics.mean_torque
        assert torque[limit(HARDER)] < torque[0] < torque[limit(WIDE_OPEN)]


def moments(orbit):
    """Integrals of the state and of its square over the period."""
    state, width = np.asarray(orbit.stage_state), np.asarray(orbit.mesh.width)
    return [STAGE_INTEGRALS[-1] @ power @ width for power in (state, state**2)]


def test_a_batch_with_manifolds_is_its_motors(radial):
    cases, cycles, _ = radial
    program = eqx.filter_jit(jax.vmap(simulate))
    batch = program(*stacked(cases[: len(CASES)]))
    for index in range(len(CASES)):
        found, alone = single(batch, index), single(cycles, index)
        np.testing.assert_allclose(moments(found.orbit), moments(alone.orbit), rtol=1e-8)
        np.testing.assert_allclose(moments(found.manifold), moments(alone.manifold), rtol=1e-8)

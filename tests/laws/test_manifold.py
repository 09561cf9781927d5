"""A gallery before the supply windows: two roads, its limits, its books, its slopes."""

from math import pi

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from both_roads import RESULTS, records, relative_errors, run_all, single
from motors import STRUCTURES, Case, replaced_manifold, sound_case, with_manifold
from second_rung import second_rung_case

from camring.metrics.independent import independent_results
from camring.metrics.spectrum import quadrature_samples
from camring.metrics.summary import summarise
from camring.physics.cycle import neighbour, simulate
from camring.physics.gallery import Manifold
from camring.physics.manifold import line_flow
from camring.physics.piston_state import sample_angles

RADIAL, RING = STRUCTURES[0], STRUCTURES[1]  # 8 pistons on 6 lobes; 6 on a free ring


def without_manifold(case: Case) -> Case:
    return Case(replaced_manifold(case.motor, None), case.fluid, case.point)


def in_manifold(case: Case, volume: float, line_conductance: float) -> Case:
    """The motor with these numbers of its gallery."""
    return case.changed(
        lambda c: (c.motor.manifold.volume, c.motor.manifold.line_conductance),
        (volume, line_conductance),
    )


def numbers(case: Case) -> np.ndarray:
    manifold = case.motor.manifold
    return np.array([float(manifold.volume), float(manifold.line_conductance)])


CASES = {
    "wide line": with_manifold(sound_case(0, RADIAL), 0.03, 2.0),
    "narrow line, small gallery": with_manifold(sound_case(4, RADIAL), 0.2, 0.1),
    "narrow line, wide gallery": with_manifold(sound_case(8, RADIAL), 0.15, 20.0),
}
SUBJECT = "wide line"
LARGE, ENDLESS, WIDE_OPEN, NO_ROOM, HARDER = range(5)
OF_SET_PRESSURE = {
    "ideal_torque", "hydromechanical_efficiency", "efficiency", "input_power",
    "spectral_torque", "spectral_pressure",
}  # fmt: skip
"""Results that count from the set pressure, not from that before the windows."""
SHARE = 2e-3  # step of the central differences


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


@eqx.filter_jit
def run_alone(motor, fluid, point):
    """Verdict and metrics of one motor, not in a batch."""
    cycle = simulate(motor, fluid, point)
    return cycle.verdict.code, summarise(cycle)


def errors(metrics, index, case: Case, tolerance: float = 1e-8) -> dict[str, float]:
    """Against the other solver; what is new with a manifold is judged against itself."""
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


def test_pistons_of_a_free_ring_meet_in_the_gallery_too():
    for seed in (1, 5):
        case = with_manifold(sound_case(seed, RING), 0.1, 1.0)
        code, metrics = run_alone(*case)
        assert int(code) == 0
        found = errors(metrics, (), case)
        assert max(found.values()) < 1e-5, found


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "share", "strokes"), [(0, 0.05, 0.5), (1, 0.1, 3), (3, 0.2, 1)])
def test_the_second_rung_draws_masses_from_the_gallery(seed, share, strokes):
    """Air in the oil and in the gallery, notched ports, an orifice that bends at zero."""
    case = with_manifold(second_rung_case(seed, RADIAL), share, strokes)
    code, metrics = run_alone(*case)
    assert int(code) == 0
    assert float(metrics.line_loss) > share / 2 * float(metrics.input_power)
    assert abs(float(metrics.power_residual)) < 1e-7  # with 1000 elements below 1e-9
    found = errors(metrics, (), case)
    assert max(found.values()) < 1e-5, found


class TestLimits:
    def test_a_gallery_without_end_is_a_constant_supply_at_its_pressure(self, radial):
        """By the other solver, which here needs no manifold; first order in one over volume."""
        cases, cycles, metrics = radial
        differences = []
        for index in (limit(LARGE), limit(ENDLESS)):
            states = np.asarray(cycles.gallery.stage_state[index])  # for this oil a pressure
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

    def test_a_gallery_of_no_volume_passes_on_at_every_instant_what_the_pistons_draw(self, radial):
        cases, cycles, _ = radial
        pistons = cases[0].motor.pistons
        angle = np.linspace(0, 2 * pi, 2001)
        places = angle[:, None] + 2 * pi * np.arange(pistons) / pistons

        @eqx.filter_jit
        def both(cycle):
            state = sample_angles(cycle, places.reshape(-1))
            drawn = state.supply_flow.reshape(places.shape).sum(1)
            gallery = state.supply_pressure.reshape(places.shape)
            return line_flow(cycle.motor, cycle.fluid, cycle.point, gallery[:, 0]), drawn, gallery

        line, drawn, gallery = both(single(cycles, limit(NO_ROOM)))
        assert np.ptp(drawn) > 0.1 * np.mean(drawn)
        np.testing.assert_allclose(line, drawn, atol=2e-6 * np.mean(drawn))
        # All pistons see one pressure, whatever their place on the ring.
        np.testing.assert_allclose(gallery, gallery[:, :1] + 0 * gallery, rtol=1e-12)


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
            gallery = samples.piston.supply_pressure
            brought = samples.mean(line_flow(cycle.motor, cycle.fluid, cycle.point, gallery))
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


def test_slopes_are_central_differences_and_a_batch_is_its_motors(radial):
    """Reverse mode, through chamber and gallery; the value beside it is a single run's.

    Differences are of solutions on one mesh, the derivative's own: laying it anew
    moves the torque by 1e-12, which is much to a slope as small as that by volume.
    """
    cases, _, metrics = radial

    @eqx.filter_jit
    def alone(motor, fluid, point):
        cycle = simulate(motor, fluid, point)

        def of(manifold):
            found = summarise(neighbour(cycle, replaced_manifold(motor, manifold), fluid, point))
            return found.mean_torque, jnp.stack([getattr(found, name) for name in RESULTS])

        def torque_at(manifold):
            again, fed = cycle, replaced_manifold(motor, manifold)
            for _ in range(4):
                again = neighbour(again, fed, fluid, point)
            return summarise(again).mean_torque

        return jax.value_and_grad(of, has_aux=True)(motor.manifold), jax.vmap(torque_at)(near)

    shares = jnp.array([(-2, 0), (-1, 0), (1, 0), (2, 0), (0, -2), (0, -1), (0, 1), (0, 2)])
    volume, conductance = numbers(cases[0])
    near = Manifold(volume * (1 + SHARE * shares[:, 0]), conductance * (1 + SHARE * shares[:, 1]))
    ((torque, results), slopes), torques = alone(*cases[0])
    batch = [float(getattr(metrics, name)[0]) for name in RESULTS]
    np.testing.assert_allclose(batch, results, rtol=1e-8)

    around = np.asarray(torques).reshape(2, 4)
    once = (around[:, 2] - around[:, 1]) / (2 * SHARE)
    twice = (around[:, 3] - around[:, 0]) / (4 * SHARE)
    differences = (4 * once - twice) / 3  # free of the third derivative
    found = np.array([slopes.volume * volume, slopes.line_conductance * conductance])
    assert np.all(np.abs(found) > 1e-6 * float(torque))
    np.testing.assert_allclose(found, differences, rtol=1e-6)

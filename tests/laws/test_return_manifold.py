"""A manifold behind the return windows, alone and beside the supply's: two solvers, books, laws."""

from dataclasses import replace
from math import pi

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from both_solvers import records, relative_errors, run, run_all, single
from detailed_motors import detailed_case
from motors import STRUCTURES, Case, replaced_manifold, sound_case, with_manifold

from camring.physics.heat.simulation import neighbour
from camring.physics.manifold.coupling import line_flow
from camring.physics.operating_point import OperatingPoint
from camring.physics.piston_state import quadrature_samples
from camring.physics.rotation import turned
from camring.physics.waves.port_waves import port_waves
from camring.physics.waves.waveforms import waveforms
from camring.programs.compiled import summarise
from camring.reference import independent_results

RADIAL, RING = STRUCTURES[0], STRUCTURES[1]  # 8 pistons on 6 lobes; 6 on a free ring
NEW = ("line_loss", "return_line_loss", "supply_pressure_swing", "return_pressure_swing")


def emptied(case: Case, share: float, strokes: float) -> Case:
    return with_manifold(case, share, strokes, "return_manifold")


def errors(metrics, case: Case) -> dict[str, float]:
    """Against the other solver; what manifolds bring is compared with itself."""
    expected = independent_results(*case, tolerance=1e-8)
    found = {name: float(getattr(metrics, name)) for name in expected}
    return relative_errors(found, expected, case) | {
        name: abs(found[name] - expected[name]) / (expected[name] or 1.0) for name in NEW
    }


def in_return_manifold(case: Case, volume: float = 1.0, conductance: float = 1.0) -> Case:
    """The motor with so many times its return manifold's volume and its line's conductance."""
    return case.changed(
        lambda c: (c.motor.return_manifold.volume, c.motor.return_manifold.line_conductance),
        (
            volume * float(case.motor.return_manifold.volume),
            conductance * float(case.motor.return_manifold.line_conductance),
        ),
    )


def without(case: Case) -> Case:
    return Case(replaced_manifold(case.motor, None, "return_manifold"), case.fluid, case.point)


def renamed(case: Case) -> Case:
    """The same machine, its return called supply and the other way round."""
    motor, (plate, point) = case.motor, (case.motor.valve_plate, case.point)
    plate = replace(plate, supply=plate.return_, return_=plate.supply)
    exchanged = replace(
        motor,
        valve_plate=plate,
        manifold=motor.return_manifold,
        return_manifold=motor.manifold,
    )
    pressures = point.return_pressure, point.supply_pressure, point.case_pressure
    return Case(exchanged, case.fluid, OperatingPoint(point.shaft_speed, *pressures))


SUBJECT = emptied(sound_case(4, RADIAL), 0.02, 0.1)
BESIDE = emptied(sound_case(0, RADIAL), 0.03, 2.0)
VOLUMES = (0.3, 3.0, 30.0)
ENDLESS, WIDE_OPEN, HARDER, BRAKING = range(2 + len(VOLUMES), 6 + len(VOLUMES))


@pytest.fixture(scope="module")
def radial():
    """Every motor with this manifold alone that a test needs, through one program."""
    cases = [SUBJECT, BESIDE, *(in_return_manifold(SUBJECT, volume=v) for v in VOLUMES)]
    cases += [
        in_return_manifold(SUBJECT, volume=1e7),
        in_return_manifold(SUBJECT, conductance=1e5),
        in_return_manifold(SUBJECT, conductance=0.5),
        renamed(with_manifold(sound_case(8, RADIAL), 0.15, 20.0)),
    ]
    return cases, *run_all(cases)


class TestAlone:
    @pytest.mark.parametrize("index", [0, 1, BRAKING])
    def test_every_result_is_that_of_the_independent_solver(self, radial, index):
        cases, cycles, metrics = radial
        assert int(cycles.verdict.code[index]) == 0
        assert float(metrics.supply_pressure_swing[index]) == 0
        found = errors(single(metrics, index), cases[index])
        assert max(found.values()) < 1e-5, found

    def test_a_return_manifold_is_a_supply_manifold_under_another_name(self, radial):
        """A machine does not know which of its ports is called supply."""
        _, _, metrics = radial
        _, fed = run(with_manifold(sound_case(8, RADIAL), 0.15, 20.0))
        same = ("mean_torque", "torque_ripple", "max_pressure", "throttling_loss", "friction_loss")
        for name in same:
            assert float(getattr(metrics, name)[BRAKING]) == pytest.approx(
                float(getattr(fed, name)), rel=1e-6
            )
        for here, there, sign in (
            ("return_pressure_swing", "supply_pressure_swing", 1),
            ("return_line_loss", "line_loss", 1),
            ("return_flow", "supply_flow", -1),
            ("supply_flow", "return_flow", -1),
        ):
            assert float(getattr(metrics, here)[BRAKING]) == pytest.approx(
                sign * float(getattr(fed, there)), rel=1e-6
            )

    def test_the_return_pressure_swings_less_in_more_oil(self, radial):
        _, _, metrics = radial
        swings = np.asarray(metrics.return_pressure_swing)[[0, *range(2, 2 + len(VOLUMES))]]
        by_volume = swings[np.argsort((1.0, *VOLUMES))]
        assert np.all(np.diff(by_volume) < 0)
        assert by_volume[-1] > 0

    def test_a_manifold_without_end_is_a_constant_return_at_its_pressure(self, radial):
        cases, cycles, metrics = radial
        states = np.asarray(cycles.return_manifold.stage_state[ENDLESS])  # here a pressure
        held = without(cases[ENDLESS])
        held = held.changed(lambda c: c.point.return_pressure, states.mean())
        expected = independent_results(*held, tolerance=1e-9)
        for name in ("mean_torque", "torque_ripple", "flow_ripple", "throttling_loss",
                     "max_pressure", "supply_flow"):  # fmt: skip
            assert float(getattr(metrics, name)[ENDLESS]) == pytest.approx(
                expected[name], rel=2e-6
            ), name

    def test_a_wide_line_is_none(self, radial):
        cases, _, metrics = radial
        plain = without(cases[0])
        found = records(single(metrics, WIDE_OPEN))[0]
        wrong = relative_errors(found, independent_results(*plain, tolerance=1e-9), plain)
        assert max(wrong.values()) < 1e-5, wrong

    def test_a_narrower_line_costs_torque_and_lifts_the_lowest_pressure(self, radial):
        _, _, metrics = radial
        torque, lowest = metrics.mean_torque, metrics.min_pressure
        assert torque[HARDER] < torque[0] < torque[WIDE_OPEN]
        assert lowest[HARDER] > lowest[0] > lowest[WIDE_OPEN]

    def test_power_in_is_shaft_power_and_every_loss_with_the_line(self, radial):
        _, _, metrics = radial
        assert np.all(np.asarray(metrics.return_line_loss) > 0)
        residual = np.abs(np.asarray(metrics.power_residual))
        assert np.max(residual) < 1e-9, residual

    def test_the_line_takes_away_what_the_pistons_give(self, radial):
        _, cycles, metrics = radial

        @eqx.filter_jit
        @jax.vmap
        def books(cycle):
            motor, fluid, point = cycle.motor, cycle.fluid, cycle.point
            samples = quadrature_samples(cycle)
            pressure = samples.piston.return_pressure
            line = line_flow(motor.return_manifold, fluid, point.return_pressure, pressure)
            given = motor.pistons * samples.mean(samples.piston.return_flow)
            angle = jnp.linspace(0, 2 * pi / motor.surviving_order, 400, endpoint=False)
            shown = waveforms(cycle, angle).return_manifold_pressure
            return samples.mean(line), given, jnp.mean(port_waves(cycle, angle).return_flow), shown

        line, given, at_port, shown = books(cycles)
        known = ~np.isin(np.arange(len(line)), [WIDE_OPEN, ENDLESS])  # these are rounding
        np.testing.assert_allclose(line[known], given[known], rtol=1e-9)
        np.testing.assert_allclose(metrics.return_flow, -given, rtol=1e-12)
        np.testing.assert_allclose(at_port[known], metrics.return_flow[known], rtol=1e-4)
        swings = metrics.return_pressure_swing[known]
        np.testing.assert_allclose(np.ptp(shown, axis=1)[known], swings, rtol=1e-2)


BOTH = [
    emptied(with_manifold(sound_case(1, RING), 0.1, 20.0), 0.05, 40.0),
    emptied(with_manifold(sound_case(5, RING), 0.1, 1.0), 0.02, 0.5),
]


@pytest.fixture(scope="module")
def both():
    """A free ring between both manifolds: no two pistons are at one place of their orbit."""
    return run_all(BOTH)


class TestBeside:
    @pytest.mark.parametrize("index", range(len(BOTH)))
    def test_every_result_is_that_of_the_independent_solver(self, both, index):
        cycles, metrics = both
        assert int(cycles.verdict.code[index]) == 0
        assert abs(float(metrics.power_residual[index])) < 1e-9
        found = errors(single(metrics, index), BOTH[index])
        assert max(found.values()) < 1e-5, found

    def test_backwards_each_manifold_stays_with_what_it_does(self):
        """The other solver works out by itself what is seen from behind."""
        fed = with_manifold(sound_case(0, RADIAL), 0.03, 2.0)
        motor, fluid, forwards = emptied(fed, 0.02, 0.5)
        point = replace(forwards, reverse=True)
        asked = [(motor, point), (turned(motor, point), point), (motor, forwards)]
        here, there, other = (independent_results(m, fluid, p, tolerance=1e-6) for m, p in asked)
        for name in ("mean_torque", *NEW):
            assert there[name] == pytest.approx(here[name], rel=1e-5), name
            assert there[name] != pytest.approx(other[name], rel=1e-4), name


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "share", "strokes"), [(0, 0.05, 0.5), (3, 0.2, 1)])
def test_the_detailed_motor_draws_masses_and_gives_them_back(seed, share, strokes):
    """Air in the oil and in both manifolds, notched ports, an orifice that bends at zero."""
    case = with_manifold(detailed_case(seed, RADIAL), share, strokes)
    case = emptied(case, 0.01, strokes)
    cycle, metrics = run(case)
    assert int(cycle.verdict.code) == 0
    assert float(metrics.line_loss) > share / 2 * float(metrics.input_power)
    assert float(metrics.return_line_loss) > 0.005 * float(metrics.input_power)
    assert abs(float(metrics.power_residual)) < 1e-9
    found = errors(metrics, case)
    assert max(found.values()) < 1e-5, found


SHARE = 2e-3  # step of the central differences


def test_slopes_are_central_differences(both):
    """Reverse mode, through chamber and manifolds; the cycle beside it is the one at hand.

    Of how much both pressures vary, which asks every number of both manifolds. Differences
    are of solutions on one mesh, the derivative's own: laying it anew moves them.
    """
    cycles, metrics = both
    motor, fluid, point = BOTH[0]

    def with_numbers(numbers):
        def where(each):
            pair = each.manifold, each.return_manifold
            return [x for m in pair for x in (m.volume, m.line_conductance)]

        return eqx.tree_at(where, motor, list(numbers))

    def varied(cycle):
        samples = quadrature_samples(cycle)
        pressures = samples.piston.supply_pressure, samples.piston.return_pressure
        return sum(
            samples.mean(((each - samples.mean(each)) / point.pressure_drop) ** 2)
            for each in pressures
        )

    @eqx.filter_jit
    def alone(cycle, given, near):
        def of(numbers):
            again = neighbour(cycle, with_numbers(numbers), fluid, point)
            return varied(again), again

        def at(numbers):
            fed = with_numbers(numbers)

            def improved(_, so_far):
                return neighbour(so_far, fed, fluid, point)

            return varied(jax.lax.fori_loop(0, 4, improved, cycle))

        return jax.value_and_grad(of, has_aux=True)(given), jax.lax.map(at, near)

    pair = motor.manifold, motor.return_manifold
    given = jnp.array([x for m in pair for x in (m.volume, m.line_conductance)])
    steps = SHARE * jnp.array([-2.0, -1.0, 1.0, 2.0])
    cycle = jax.tree.map(jnp.asarray, single(cycles, 0))
    near = given * (1 + steps[:, None, None] * jnp.eye(len(given)))  # (step, number, number)
    ((value, again), slopes), values = alone(cycle, given, near.reshape(-1, len(given)))
    before, after = (
        [float(x) for x in records(each)[0].values()]
        for each in (single(metrics, 0), summarise(again))
    )
    np.testing.assert_allclose(after, before, rtol=1e-8)

    around = np.asarray(values).reshape(len(steps), -1)
    once = (around[2] - around[1]) / (2 * SHARE)
    twice = (around[3] - around[0]) / (4 * SHARE)
    by_each = np.asarray(slopes * given)
    assert np.all(np.abs(by_each) > 1e-2 * float(value)), by_each
    # Free of the third derivative.
    np.testing.assert_allclose(by_each, (4 * once - twice) / 3, rtol=1e-6)

"""Sketches of motors: closed forms against the program's own geometry, and rules that are kept."""

from math import cos, gcd, pi, sin

import jax.numpy as jnp
import numpy as np
import pytest

from camring.files.starting import sizing_rules as rules
from camring.files.starting.sizing import (
    Demand,
    candidates,
    combinations,
    conditions_of,
    displacements,
    shortfalls,
    shut_angle,
    sized,
)
from camring.geometry.block import guided_length, meeting_radius, wall_between
from camring.geometry.cam import RadialCam
from camring.geometry.contour import pressure_angle, undercut_factor
from camring.geometry.profiles import control_values, sine
from camring.metrics.estimate import (
    greatest_pressure_angle,
    least_undercut_factor,
    pre_compression,
    pressure_leaked_away,
    sine_torque_ripple,
)

RPM = pi / 30
ORDINARY = Demand(2.5e-3, 250e5, 100 * RPM, 0.5)


@pytest.fixture(scope="module")
def ordinary():
    return sized(ORDINARY)


class TestBlock:
    def test_six_bores_meet_at_their_own_diameter(self):
        assert meeting_radius(6, 0.03) == pytest.approx(0.03)

    def test_no_wall_is_left_where_bores_meet(self):
        for pistons in (2, 5, 16):
            met = meeting_radius(pistons, 0.04)
            assert wall_between(pistons, 0.04, met) == pytest.approx(0, abs=1e-15)
            assert guided_length(pistons, 0.04, met) == pytest.approx(0, abs=1e-15)
            assert guided_length(pistons, 0.04, met + 0.01) == pytest.approx(0.01)

    def test_one_piston_meets_nobody(self):
        assert meeting_radius(1, 0.04) == 0


class TestClosedForms:
    def test_angle_and_undercut_are_those_of_the_spline(self, ordinary):
        sketch = ordinary.sketch
        for place in range(0, len(ordinary), 7):
            least, stroke = sketch.least_radius[place], sketch.stroke[place]
            lobes = int(sketch.lobes[place])
            cam = RadialCam(least + stroke * control_values(sine, 64), repeats=lobes)
            radius = cam.pitch_radius(jnp.linspace(0, cam.period, 4001))
            assert np.max(np.abs(pressure_angle(radius))) == pytest.approx(
                greatest_pressure_angle(sketch)[place], rel=1e-4
            )
            factor = undercut_factor(radius, sketch.roller_radius[place])
            assert np.min(factor) == pytest.approx(least_undercut_factor(sketch)[place], rel=2e-3)

    @pytest.mark.parametrize("phases", [3, 4, 5, 7, 8, 10])
    def test_ripple_is_that_of_rectified_sines(self, phases):
        angle = 2 * pi * np.arange(5040) / 5040
        torque = sum(np.maximum(np.sin(angle + 2 * pi * k / phases), 0) for k in range(phases))
        one_sided = np.std(torque) / np.mean(torque) / np.sqrt(2)
        assert sine_torque_ripple(phases) == pytest.approx(one_sided, rel=1e-3)

    def test_pre_compression_presses_the_dead_volume(self, ordinary):
        conditions = conditions_of(ORDINARY, ordinary.return_pressure)
        sketch = ordinary.sketch
        turned = pre_compression(sketch, conditions) * sketch.lobes
        travel = sketch.stroke / 2 * (1 - np.cos(turned))
        gained = conditions.bulk_modulus * sketch.area * travel / sketch.dead_volume
        np.testing.assert_allclose(gained, conditions.drop, rtol=1e-9)

    def test_half_the_speed_leaks_twice_as_much(self, ordinary):
        conditions = conditions_of(ORDINARY, ordinary.return_pressure)
        slow = conditions._replace(shaft_speed=conditions.shaft_speed / 2)
        lost = pressure_leaked_away(ordinary.sketch, conditions, 0.01)
        assert np.all(lost > 0)
        np.testing.assert_allclose(
            pressure_leaked_away(ordinary.sketch, slow, 0.01), 2 * lost, rtol=1e-12
        )


class TestSizes:
    def test_reach_the_displacement_and_keep_every_rule(self, ordinary):
        assert len(ordinary) > 10
        np.testing.assert_allclose(ordinary.sketch.displacement, 2.5e-3, rtol=1e-12)
        for name, missed in shortfalls(ordinary, ORDINARY).items():
            assert np.all(missed <= 1e-9), name
        assert np.all(np.diff(ordinary.score) >= 0)
        pairs = set(zip(ordinary.sketch.pistons, ordinary.sketch.lobes, strict=True))
        assert len(pairs) == len(ordinary)

    def test_counts_balance_the_shaft_and_can_start_anywhere(self):
        for pistons, lobes in combinations():
            assert gcd(pistons, lobes) >= 2
            assert pistons // gcd(pistons, lobes) >= 3

    def test_bores_clear_each_other_at_the_inner_end_of_the_pistons(self, ordinary):
        sketch = ordinary.sketch
        for place in range(len(ordinary)):
            inner = sketch.least_radius[place] - rules.PISTON_LENGTH * sketch.bore[place]
            half = pi / sketch.pistons[place]
            apart = inner * np.hypot(sin(2 * half), 1 - cos(2 * half))
            assert apart > sketch.bore[place]

    def test_similar_machines_are_alike(self):
        """Twice as large in every direction, turning half as fast: the same stresses."""
        counts = [(10, 8)]
        small = sized(Demand(1e-3, 250e5, 100 * RPM), counts)
        large = sized(Demand(8e-3, 250e5, 50 * RPM), counts)
        assert large.contact_stress[0] == pytest.approx(small.contact_stress[0], rel=0.05)
        assert large.outer_radius[0] == pytest.approx(2 * small.outer_radius[0], rel=0.05)

    def test_an_outer_diameter_too_small_leaves_none_and_a_larger_one_never_fewer(self):
        found = [len(sized(Demand(2.5e-3, 250e5, 10.0, outer))) for outer in (0.2, 0.4, 0.5, 1.0)]
        assert found[0] == 0
        assert found == sorted(found)

    def test_beyond_the_range_of_bores_there_is_nothing_to_size(self):
        low, high = displacements()
        assert len(candidates(Demand(0.99 * low, 250e5, 10.0))) == 0
        assert len(candidates(Demand(1.01 * high, 250e5, 1.0))) == 0
        assert len(candidates(Demand(1.01 * low, 250e5, 10.0))) > 0

    def test_slow_motors_are_shut_for_less(self, ordinary):
        one = type(ordinary.sketch)(*(each[0] for each in ordinary.sketch))
        conditions = conditions_of(ORDINARY, ordinary.return_pressure[0])
        full = float(pre_compression(one, conditions))
        fast = conditions._replace(shaft_speed=conditions.shaft_speed * 10)
        assert shut_angle(one, fast) == pytest.approx(rules.SHUT_SHARE * full)
        slow = conditions._replace(shaft_speed=conditions.shaft_speed / 100)
        left = shut_angle(one, slow)
        assert 0 < left < rules.SHUT_SHARE * full
        lost = pressure_leaked_away(
            one, slow._replace(shaft_speed=rules.SLOW * slow.shaft_speed), left
        )
        assert lost <= slow.return_pressure - slow.case_pressure

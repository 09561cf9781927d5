"""A design space holds the given motor, moves what it says, and can be differentiated."""

import re
from pathlib import Path

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camring.files.motor import parse_motor_file, read_motor_file
from camring.files.starting.template import PROFILES, template
from camring.geometry.extremes import extreme_radius
from camring.objective.cam_modes import CamModes, sum_of_rises, unit_point_for
from camring.objective.design_space import DesignSpace, Variable, leaf
from camring.objective.theory import ideal_edges, theory_designs

DERIVATION = Path(__file__).parents[1] / "derivation"
FILE = read_motor_file(DERIVATION / "wheel_motor.toml")
SYSTEM, SPACE = FILE.system, FILE.design_space
POINTS = st.lists(
    st.floats(0, 1, width=32), min_size=SPACE.dimension, max_size=SPACE.dimension
).map(np.array)
APPLY = eqx.filter_jit(SPACE.apply)


def leaves(system):
    return [np.asarray(each) for each in jax.tree.leaves(system)]


def test_the_given_motor_is_in_the_space():
    same = SPACE.apply(SYSTEM, SPACE.locate(SYSTEM))
    for one, other in zip(leaves(SYSTEM), leaves(same), strict=True):
        np.testing.assert_allclose(other, one, rtol=1e-12, atol=1e-15)


def test_a_variable_reaches_its_bounds_and_nothing_else_moves():
    point = np.array(SPACE.locate(SYSTEM))
    place = SPACE.names.index("motor.valve_plate.supply_width")
    for unit, width in ((0.0, 26.0), (1.0, 30.0)):
        point[place] = unit
        plate = SPACE.apply(SYSTEM, point).motor.valve_plate
        assert np.degrees(plate.supply.width) == pytest.approx(width)
        assert plate.return_.width == SYSTEM.motor.valve_plate.return_.width


@given(point=POINTS)
def test_modes_keep_the_displacement_and_the_mean_radius(point):
    cam, before = APPLY(SYSTEM, point).motor.cam, SYSTEM.motor.cam
    assert float(sum_of_rises(cam)) == pytest.approx(float(sum_of_rises(before)), rel=1e-12)
    assert float(jnp.mean(cam.control_radii)) == pytest.approx(
        float(jnp.mean(before.control_radii)), rel=1e-12
    )


@given(point=POINTS)
def test_mirrored_modes_keep_the_cam_symmetric(point):
    radii = np.asarray(APPLY(SYSTEM, point).motor.cam.control_radii)
    np.testing.assert_allclose(radii, np.roll(radii[::-1], 1), rtol=1e-12)


def test_the_design_space_runs_in_a_batch_and_gives_what_single_designs_give():
    points = np.random.default_rng(0).random((7, SPACE.dimension))
    batch = jax.vmap(lambda point: SPACE.apply(SYSTEM, point))(points)
    for place, point in enumerate(points):
        single = leaves(SPACE.apply(SYSTEM, point))
        for one, many in zip(single, leaves(batch), strict=True):
            np.testing.assert_allclose(many[place], one, rtol=1e-14)


def test_gradients_are_those_of_differences():
    point = jnp.asarray(np.random.default_rng(3).random(SPACE.dimension))

    def stroke(at):
        return extreme_radius(SPACE.apply(SYSTEM, at).motor.cam, 1)

    slope = jax.grad(stroke)(point)
    step = 1e-6
    differences = [
        (stroke(point.at[k].add(step)) - stroke(point.at[k].add(-step))) / (2 * step)
        for k in range(SPACE.dimension)
    ]
    np.testing.assert_allclose(slope, differences, rtol=1e-5, atol=1e-10)


@pytest.mark.parametrize("path", [v.leaves[0][0] for v in SPACE.variables])
def test_every_variable_stands_in_the_file_it_writes(path):
    point = np.full(SPACE.dimension, 0.25)
    design = SPACE.apply(SYSTEM, point)
    again = parse_motor_file(FILE.with_design(point)).system
    assert float(leaf(path)(again)) == pytest.approx(float(leaf(path)(design)), rel=1e-15)


@given(point=POINTS)
def test_a_written_design_reads_back_as_itself(point):
    design, again = SPACE.apply(SYSTEM, point), parse_motor_file(FILE.with_design(point))
    for one, other in zip(leaves(design), leaves(again.system), strict=True):
        np.testing.assert_allclose(other, one, rtol=1e-14, atol=1e-17)
    np.testing.assert_allclose(
        again.design_space.locate(again.system)[:4], np.clip(point[:4], 0, 1), atol=1e-9
    )


def test_a_written_design_keeps_the_comments():
    lines = FILE.with_design(np.full(SPACE.dimension, 0.5)).splitlines()
    assert sum("#" in line for line in lines) == sum("#" in line for line in FILE.text.splitlines())


def test_relative_bounds_move_numbers_by_the_same_share():
    variable = Variable(
        keys=("motor.bore", "motor.dead_volume"),
        leaves=(("motor.piston.bore",), ("motor.dead_volume",)),
        low=-0.1,
        high=0.3,
        relative=True,
    )
    space = DesignSpace((variable,))
    assert space.locate(SYSTEM) == pytest.approx([0.25])
    widest = space.apply(SYSTEM, np.array([1.0])).motor
    assert float(widest.piston.bore / SYSTEM.motor.piston.bore) == pytest.approx(1.3)
    assert float(widest.dead_volume / SYSTEM.motor.dead_volume) == pytest.approx(1.3)


class TestModes:
    def test_bounds_fall_so_that_each_mode_has_the_same_acceleration(self):
        modes = CamModes(harmonics=(2, 3, 4), amplitude=1e-3, count=16)
        harmonic = np.array([k for _, k in modes.terms])
        np.testing.assert_allclose(modes.bounds() * harmonic**2, 1e-3)

    def test_the_sine_that_no_control_value_sees_is_left_out(self):
        modes = CamModes(harmonics=(7, 8), amplitude=1e-3, count=16)
        assert modes.terms == (("cos", 7), ("sin", 7), ("cos", 8))

    def test_a_free_displacement_adds_what_it_says(self):
        modes = CamModes(
            harmonics=(1, 2), amplitude=1e-3, count=16, mirror=True, keep_displacement=False
        )
        cam = modes.apply(SYSTEM.motor.cam, np.array([1.0, 0.5]))
        change = cam.control_radii - SYSTEM.motor.cam.control_radii
        np.testing.assert_allclose(
            change, 1e-3 * np.cos(2 * np.pi * np.arange(16) / 16), atol=1e-15
        )

    def test_a_cam_is_found_where_it_came_from(self):
        point = np.random.default_rng(5).random(SPACE.cam.dimension)
        cam = SPACE.cam.apply(SYSTEM.motor.cam, point)
        found, missed = unit_point_for(SPACE.cam, SYSTEM, np.asarray(cam.control_radii))
        np.testing.assert_allclose(found, point, atol=1e-9)
        assert missed < 1e-12

    def test_planar_points_move_along_their_rays(self):
        angle = np.pi / 3 * np.arange(12) / 12
        radius = 0.09 - 0.005 * np.cos(6 * angle)
        points = [[r * np.cos(a), r * np.sin(a)] for r, a in zip(radius, angle, strict=True)]
        planar = f'representation = "planar"\ncontrol_points = {np.array(points).tolist()}\n'
        text = re.sub(r"control_radii = \[[^\]]*\]\n", planar, FILE.text)
        file = parse_motor_file(text.replace("modes = 8", "modes = 6"))
        point = np.random.default_rng(2).random(file.design_space.dimension)
        before = file.system.motor.cam.control_points
        after = file.design_space.apply(file.system, point).motor.cam.control_points
        np.testing.assert_allclose(
            np.arctan2(after[:, 1], after[:, 0]), np.arctan2(before[:, 1], before[:, 0]), atol=1e-12
        )
        again = parse_motor_file(file.with_design(point)).system.motor.cam.control_points
        np.testing.assert_allclose(again, after, rtol=1e-13)


class TestTheory:
    def test_designs_lie_in_the_space_and_differ(self):
        designs = theory_designs(SYSTEM, SPACE, FILE.goal.constraints)
        assert 4 <= len(designs) <= 12
        assert np.all((designs >= 0) & (designs <= 1))
        assert len(np.unique(np.round(designs, 6), axis=0)) == len(designs)

    def test_the_first_design_is_a_zero_ripple_cam_within_its_limits(self):
        from camring.objective.theory import _cam_facts

        first = SPACE.apply(SYSTEM, theory_designs(SYSTEM, SPACE, FILE.goal.constraints)[0])
        undercut, angle, stress = (float(each) for each in _cam_facts(first, first.motor.cam))
        assert undercut > 0.25
        assert np.degrees(angle) < 30
        assert stress < 1.9e9
        radius = first.motor.cam.pitch_radius(jnp.pi / 3 * jnp.arange(960) / 960)
        rising = np.maximum(radius.first, 0)
        total = sum(np.roll(rising, 240 * k) for k in range(4))
        np.testing.assert_allclose(total, np.mean(total), rtol=1e-9)

    def test_a_zero_ripple_motor_is_its_own_first_cam(self):
        file = parse_motor_file(template("zero-ripple"))
        designs = theory_designs(file.system, file.design_space, file.goal.constraints)
        cam = designs[0][len(file.design_space.variables) :]
        np.testing.assert_allclose(cam, 0.5, atol=1e-3)

    def test_windows_close_ahead_of_the_dead_centres_they_lead_to(self):
        none, full = ideal_edges(SYSTEM, 0.0), ideal_edges(SYSTEM, 1.0)
        np.testing.assert_allclose(np.degrees(none), [0, 30, 30, 60], atol=0.1)
        ahead = np.degrees(none - full)
        assert ahead[0] == ahead[2] == 0
        assert 1 < ahead[3] < ahead[1] < 6  # the outer dead centre has more oil to let expand

    def test_a_space_without_modes_or_timing_gives_what_it_can(self):
        only_cam = DesignSpace((), SPACE.cam)
        assert theory_designs(SYSTEM, only_cam).shape[1] == SPACE.cam.dimension
        only_plate = DesignSpace(SPACE.variables[:2])
        assert len(theory_designs(SYSTEM, only_plate)) >= 2
        few = CamModes(harmonics=(2,), amplitude=1e-4, count=16, mirror=True)
        assert theory_designs(SYSTEM, DesignSpace((), few)).shape == (0, 1)


@pytest.mark.parametrize("profile", PROFILES)
def test_every_template_holds_its_own_motor(profile):
    file = parse_motor_file(template(profile))
    assert np.all(np.isfinite(file.design_space.locate(file.system)))

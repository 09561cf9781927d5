"""Many motors side by side are the same motors, one by one."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from both_solvers import relative_errors, run_all, single
from motors import STRUCTURES, awkward_case, sound_case, stacked

from camring.geometry.batch_cam import radius_around, radius_at, round_the_cam
from camring.geometry.cam import RadialCam
from camring.metrics.batch_summary import summarise_batch
from camring.numerics.batch import ascending_rows, interpolate, locate
from camring.physics.batch_cycle import BatchResolution
from camring.physics.heat.batch_simulation import neighbour_batch, simulate_batch
from camring.programs.batch_program import BatchProgram

MEMBERS = 8
LOOSE = {"flow_ripple": 3e-3, "return_flow_ripple": 3e-3, "torque_ripple_peak_to_peak": 3e-4}
"""Sampled at fixed places, so that a spike between two of them is seen late."""

_simulate = BatchProgram(simulate_batch)
_summarise = BatchProgram(summarise_batch)


def in_batch(cases):
    return jax.tree.map(lambda leaf: jnp.moveaxis(leaf, 0, -1), stacked(cases))


@pytest.fixture(scope="module")
def sound():
    cases = [sound_case(seed, STRUCTURES[0]) for seed in range(MEMBERS)]
    return cases, _simulate(*in_batch(cases), BatchResolution())


def record(metrics, member):
    return {name: float(leaf[member]) for name, leaf in vars(metrics).items()}


def worst_errors(cases, metrics) -> dict[str, float]:
    _, alone = run_all(cases)
    errors = [
        relative_errors(record(metrics, k), {n: float(v) for n, v in vars(one).items()}, case)
        for k, case in enumerate(cases)
        for one in [single(alone, k)]
    ]
    return {name: max(each[name] for each in errors) for name in errors[0]}


def test_every_result_is_that_of_the_motor_alone(sound):
    cases, found = sound
    assert not np.any(np.asarray(found.cycle.verdict.code))
    errors = worst_errors(cases, _summarise(found))
    extremes = ("min_pressure", "max_pressure", "min_contact_force", "max_contact_stress")
    for name, error in errors.items():
        asked = LOOSE.get(name, 5e-5 if name in extremes else 2e-5)
        assert error < asked, (name, error)


def test_terms_of_the_objective_hold_at_search_resolution():
    cases = [sound_case(seed, STRUCTURES[0]) for seed in range(MEMBERS)]
    resolution = BatchResolution.search()
    found = _summarise(_simulate(*in_batch(cases), resolution), 600, resolution.oversampling)
    errors = worst_errors(cases, found)
    for name in ("torque_ripple", "pressure_ripple", "efficiency", "jerk_objective"):
        assert errors[name] < 1e-4, (name, errors[name])


def test_the_power_balance_closes_in_every_member(sound):
    _, found = sound
    assert np.max(np.abs(_summarise(found).power_residual)) < 1e-9


def test_an_unsound_member_leaves_its_neighbours_alone(sound):
    cases, alone = sound
    spoiled = list(cases)
    spoiled[3] = awkward_case(0, "racing").changed(lambda c: c.motor.dead_volume, -1e-3)
    found = _simulate(*in_batch(spoiled), BatchResolution())
    assert int(found.cycle.verdict.code[3]) != 0
    others = np.array([0, 1, 2, 4, 5, 6, 7])
    assert not np.any(np.asarray(found.cycle.verdict.code)[others])
    # Newton goes on until the slowest member is done, so the others are settled better still.
    np.testing.assert_allclose(
        _summarise(found).mean_torque[others], _summarise(alone).mean_torque[others], rtol=1e-8
    )


def test_a_member_without_a_number_stops_no_other(sound):
    cases, alone = sound
    spoiled = list(cases)
    spoiled[3] = cases[3].changed(lambda c: c.fluid.bulk_modulus, np.nan)
    found = _simulate(*in_batch(spoiled), BatchResolution())
    codes = np.asarray(found.cycle.verdict.code)
    assert codes[3] != 0
    others = np.array([0, 1, 2, 4, 5, 6, 7])
    assert not np.any(codes[others])
    np.testing.assert_allclose(
        _summarise(found).mean_torque[others], _summarise(alone).mean_torque[others], rtol=1e-8
    )


def test_a_share_of_the_elements_is_the_resolution_with_so_many(sound):
    cases, whole = sound
    resolution = BatchResolution()
    shares = np.where(np.arange(MEMBERS) < 4, 0.7, 1.0)
    found = _simulate(*in_batch(cases), resolution, shares)
    fewer = _simulate(*in_batch(cases), resolution.second_solution(0.7))
    torque = np.asarray(_summarise(found).mean_torque)
    np.testing.assert_allclose(torque[:4], _summarise(fewer).mean_torque[:4], rtol=1e-12)
    np.testing.assert_allclose(torque[4:], _summarise(whole).mean_torque[4:], rtol=1e-12)
    assert np.all(torque[:4] != _summarise(whole).mean_torque[:4])


def test_slopes_are_central_differences(sound):
    cases, found = sound
    motor, fluid, point = in_batch(cases)
    width = motor.valve_plate.supply.width

    def changed(width):
        return eqx.tree_at(lambda m: m.valve_plate.supply.width, motor, width)

    @eqx.filter_jit
    def near(width):
        return summarise_batch(
            neighbour_batch(found.cycle, changed(width), fluid, point, BatchResolution())
        ).mean_torque

    def torque(width):
        return _summarise(_simulate(changed(width), fluid, point, BatchResolution())).mean_torque

    _, slope = jax.jvp(near, (width,), (jnp.ones_like(width),))
    step = 2e-4
    difference = (
        8 * (torque(width + step) - torque(width - step))
        - (torque(width + 2 * step) - torque(width - 2 * step))
    ) / (12 * step)
    # Every simulation lays its mesh anew, which moves torque by 1e-7 of itself or so.
    np.testing.assert_allclose(slope, difference, rtol=1e-3)


def test_cams_in_a_batch_are_the_cams(sound):
    cases, _ = sound
    cam = in_batch(cases)[0].cam
    angle = np.random.default_rng(5).uniform(-9, 9, size=(50, MEMBERS))
    at, around = radius_at(cam, angle), radius_around(cam, np.arange(64) / 64)
    for member, case in enumerate(cases):
        alone = case.motor.cam
        for mine, theirs in zip(at, alone.pitch_radius(angle[:, member]), strict=True):
            np.testing.assert_allclose(mine[:, member], theirs, rtol=1e-9, atol=1e-9)
        fixed = alone.pitch_radius(alone.period * np.arange(64) / 64)
        np.testing.assert_allclose(around.value[:, member], fixed.value, rtol=1e-12)
        np.testing.assert_allclose(around.first[:, member], fixed.first, atol=1e-12)
    round_ = round_the_cam(cam)
    lowest, highest = round_.extremes()
    # One rise a lobe: what is climbed is the stroke.
    np.testing.assert_allclose(round_.rises(), highest - lowest, rtol=1e-6)


def test_extremes_of_a_cam_lie_within_its_control_radii():
    """Also where a dead centre is a sample and rounding moves it from one side to the other."""
    rng, members = np.random.default_rng(0), 16_384
    lift = -np.cos(2 * np.pi * np.arange(16) / 16)[:, None] * rng.uniform(0.05, 0.15, members)
    radii = (0.9 + lift) * (1 + 2.0**-52 * rng.integers(-2, 3, (16, members)))
    cams = RadialCam(radii, repeats=6)
    lowest, highest = eqx.filter_jit(lambda cam: round_the_cam(cam).extremes())(cams)
    assert np.all(lowest > radii.min(axis=0))
    assert np.all(highest < radii.max(axis=0))


def test_rows_are_found_and_sorted_member_by_member():
    rng = np.random.default_rng(7)
    rows, value = np.sort(rng.normal(size=(37, 5)), axis=0), rng.normal(size=(90, 5))
    for member in range(5):
        expected = np.searchsorted(rows[:, member], value[:, member], side="right") - 1
        found = np.asarray(locate(jnp.asarray(rows), jnp.asarray(value)))[:, member]
        np.testing.assert_array_equal(found, np.maximum(expected, 0))
        line = interpolate(jnp.asarray(value), jnp.asarray(rows), jnp.asarray(rows) ** 2)
        np.testing.assert_allclose(
            line[:, member],
            np.interp(value[:, member], rows[:, member], rows[:, member] ** 2),
            rtol=1e-12,
        )
    shuffled = rng.permuted(np.round(rows, 1), axis=0)
    ordered, carried = ascending_rows(jnp.asarray(shuffled), jnp.asarray(2 * shuffled))
    np.testing.assert_array_equal(ordered, np.sort(shuffled, axis=0))
    np.testing.assert_array_equal(carried, 2 * ordered)


def test_windows_that_open_at_once_have_coinciding_edges(sound):
    """All ramp: both shoulders of a window are the same place."""
    cases, _ = sound
    resolution = BatchResolution.search()
    steep = [case.changed(lambda c: c.motor.valve_plate.window.ramp, 1.0) for case in cases]
    found = _simulate(*in_batch(steep), resolution)
    assert not np.any(np.asarray(found.cycle.verdict.code))
    errors = worst_errors(steep, _summarise(found, 600, resolution.oversampling))
    assert errors["mean_torque"] < 1e-4

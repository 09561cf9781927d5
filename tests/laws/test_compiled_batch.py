"""Machine code of our own says of motors and designs what JAX's compiler says.

JAX compiles here without its expensive optimisations, for time; results are the same functions'.
"""

from dataclasses import dataclass, replace
from functools import cache
from math import pi
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from detailed_motors import detailed_case
from motors import STRUCTURES, Case, sound_case, stacked, window_widths

from camring.evaluation import batch as many
from camring.files.motor import read_motor_file
from camring.geometry.extremes import extreme_radius
from camring.objective.batch import designs_with_slopes, measure_designs, slopes_of_designs
from camring.physics.batch_cycle import BatchResolution, fits
from camring.physics.system import System
from camring.programs.batch_program import SWITCH, BatchProgram

DERIVATION = Path(__file__).parents[1] / "derivation"
QUICK = {"xla_backend_optimization_level": 0}
MEMBERS = 12  # two blocks, one of them not full
ORDERS = 240
SEARCH, FINAL = BatchResolution.search(), BatchResolution()

_measured = BatchProgram(measure_designs, QUICK)
_sloped = BatchProgram(slopes_of_designs, QUICK)
_designs = many.motor_program(designs_with_slopes, QUICK)


@pytest.fixture(autouse=True)
def _switched_on(monkeypatch):
    monkeypatch.delenv(SWITCH, raising=False)


@pytest.fixture
def through_jax(monkeypatch):
    """Calls a batch program with our own compiler switched off."""

    def called(program, *args, **kwargs):
        with monkeypatch.context() as context:
            context.setenv(SWITCH, "off")
            return jax.device_get(program(*args, **kwargs))

    return called


@pytest.fixture(autouse=True)
def _nothing_falls_back():
    """In silence; each test looks at what was compiled for it."""
    programs = _measured, _sloped, many.measure_batch, many.solve_batch, many.batch_slopes
    before = [len(each.hindrances) for each in programs]
    yield
    assert [each.hindrances[n:] for each, n in zip(programs, before, strict=True)] == [[]] * 5


# motors of every kind


def given_reference(seed):
    """A motor whose lift is counted from a radius of its own, turning backwards."""
    motor, fluid, point = sound_case(seed, STRUCTURES[2])
    below = extreme_radius(motor.cam, -1) - 1e-3
    motor = replace(motor, reference="given", given_reference_radius=below)
    return Case(motor, fluid, replace(point, reverse=True))


KINDS = {
    "ring, mean": lambda seed: sound_case(seed, STRUCTURES[1]),
    "degree 5, given, backwards": given_reference,
    "detailed laws, lowest": detailed_case,
}


@cache
def cases_of(kind):
    return tuple(KINDS[kind](seed) for seed in range(MEMBERS))


def in_batch(cases):
    motor, fluid, point = jax.tree.map(lambda leaf: jnp.moveaxis(leaf, 0, -1), stacked(list(cases)))
    return System(motor, fluid, (point,))


def both(system, resolution, through_jax):
    """Verdicts and results by our code and by JAX's."""
    (mine,), my_faults = _measured(system, ORDERS, resolution)
    (theirs,), their_faults = through_jax(_measured, system, ORDERS, resolution)
    return (vars(mine), my_faults), (vars(theirs), their_faults)


def sizes(results, system):
    """What an error of each result is relative to, shape (batch,)."""
    point = system.operating_points[0]
    drop = np.asarray(point.pressure_drop)
    pressures = ("min_pressure", "pressure_overshoot", "pressure_undershoot", "vapour_margin",
                 "air_release_margin")  # fmt: skip
    floors = dict.fromkeys(pressures, drop)
    floors["min_contact_force"] = drop * np.asarray(system.motor.piston.area)
    floors["power_residual"] = 1.0
    power = np.abs(results["output_power"])
    floors |= {name: 0.01 * power for name in results if name.endswith("_loss")}
    floors |= {name: 1.0 for name in results if name.startswith("share_")}
    return {name: np.maximum(np.abs(value), floors.get(name, 0)) for name, value in results.items()}


def assert_same_results(mine, theirs, system, members, within=1e-6, torque=1e-9):
    """To rounding, where both took as many of Newton's steps."""
    assert set(mine) == set(theirs)
    size = sizes(theirs, system)
    for name, value in theirs.items():
        allowed = torque if name == "mean_torque" else within
        error = np.abs(mine[name] - value)[members]
        assert np.all(error <= allowed * size[name][members]), (name, error / size[name][members])


def name_of(each):
    return each if isinstance(each, str) else each.elements


@pytest.mark.parametrize(
    ("kind", "resolution"),
    [
        ("ring, mean", SEARCH),
        ("detailed laws, lowest", SEARCH),
    ],
    ids=name_of,
)
def test_every_result_of_every_motor_is_that_of_jax(kind, resolution, through_jax):
    system = in_batch(cases_of(kind))
    assert fits(system.motor)
    (mine, my_faults), (theirs, their_faults) = both(system, resolution, through_jax)
    np.testing.assert_array_equal(my_faults, their_faults)
    sound = np.asarray(my_faults[0]) == 0
    assert np.sum(sound) >= MEMBERS - 1
    assert_same_results(mine, theirs, system, sound)


@pytest.mark.parametrize(
    ("kind", "resolution"),
    [
        ("detailed laws, lowest", FINAL),
        ("degree 5, given, backwards", SEARCH),
    ],
    ids=name_of,
)
def test_there_is_code_for_every_kind_and_resolution(kind, resolution):
    """The others' numbers are looked at above."""
    system = in_batch(cases_of(kind))
    (found,), faults = _measured(system, ORDERS, resolution)
    sound = faults[0] == 0
    assert np.sum(sound) >= MEMBERS - 1
    assert np.max(np.abs(found.power_residual[sound])) < 1e-4


@pytest.mark.parametrize("spoiled", [0, 9])
def test_an_unsound_motor_is_known_as_one_and_spoils_no_other(spoiled, through_jax):
    cases = list(cases_of("ring, mean"))
    system = in_batch(cases)
    (alone,), _ = _measured(system, ORDERS, SEARCH)
    cases[spoiled] = cases[spoiled].changed(lambda c: c.motor.dead_volume, -1e-3)
    (mine, faults), (theirs, their_faults) = both(in_batch(cases), SEARCH, through_jax)
    np.testing.assert_array_equal(faults, their_faults)
    np.testing.assert_array_equal(np.flatnonzero(faults[0]), [spoiled])
    others = np.arange(MEMBERS) != spoiled
    assert_same_results(mine, theirs, system, others)
    for name, value in vars(alone).items():
        np.testing.assert_array_equal(mine[name][others], value[others], err_msg=name)


def test_any_number_of_motors_is_one_answer():
    """Each block of eight by itself: who else is asked for does not matter, to the last bit."""
    system = in_batch(cases_of("detailed laws, lowest"))
    twice = jax.tree.map(lambda leaf: jnp.concatenate([leaf[..., :8]] * 3, axis=-1), system)
    (once,), _ = _measured(jax.tree.map(lambda leaf: leaf[..., :8], system), ORDERS, SEARCH)
    (thrice,), _ = _measured(twice, ORDERS, SEARCH)
    for name, value in vars(once).items():
        np.testing.assert_array_equal(np.tile(value, 3), vars(thrice)[name], err_msg=name)


def notched(share):
    """Motors whose ramps take so much of a window's half: at one, its two shoulders meet."""
    return [
        case.changed(lambda c: c.motor.valve_plate.window.ramp, share)
        for case in cases_of("detailed laws, lowest")
    ]


def triangular(share):
    return [
        case.changed(lambda c: c.motor.valve_plate.window.ramp, share)
        for case in cases_of("ring, mean")
    ]


def meeting(share):
    """Windows of which one opens where the other one shuts."""
    pitch = 2 * pi / STRUCTURES[1].lobes
    return [
        case.changed(window_widths, (share * pitch / 2, share * pitch / 2)).changed(
            lambda c: c.motor.valve_plate.shift, 0.0
        )
        for case in cases_of("ring, mean")
    ]


@pytest.mark.parametrize("motors", [triangular, meeting, notched], ids=lambda f: f.__name__)
def test_breakpoints_that_coincide_are_as_good_as_near_ones(motors, through_jax):
    system = in_batch(motors(1.0))
    (mine, my_faults), (theirs, their_faults) = both(system, SEARCH, through_jax)
    np.testing.assert_array_equal(my_faults, their_faults)
    (near,), near_faults = _measured(in_batch(motors(1 - 1e-7)), ORDERS, SEARCH)
    sound = np.asarray(near_faults[0]) == 0
    assert np.sum(sound) >= MEMBERS - 1
    np.testing.assert_array_equal(my_faults, near_faults)
    assert_same_results(mine, theirs, system, sound)
    np.testing.assert_allclose(mine["mean_torque"][sound], near.mean_torque[sound], rtol=1e-5)


# designs of motor files


@dataclass(frozen=True)
class Example:
    name: str
    resolution: BatchResolution
    first: int | None = None
    """Coordinates whose slopes are asked for, counted from the first one; None for all."""
    results: tuple[str, ...] = ()

    @property
    def file(self):
        return read_motor_file(DERIVATION / f"{self.name}_motor.toml")

    @property
    def given(self):
        return self.file.design_space, self.file.system, self.file.goal

    @property
    def points(self):
        rng = np.random.default_rng(6)
        return rng.uniform(0.3, 0.7, size=(8, self.file.design_space.dimension))


SLOPES = [
    Example("mill", FINAL, results=("efficiency", "max_pressure")),
]


@pytest.fixture(scope="module", params=SLOPES, ids=lambda each: each.name)
def sloped(request):
    """An example, its cycles, what was assessed, and slopes."""
    one = request.param
    cycles, assessed = many.assess_and_keep(*one.given, one.points, one.resolution)
    slopes = many.slopes_in_batch(
        *one.given, one.points, cycles, one.resolution, first=one.first, results=one.results
    )
    return one, cycles, assessed, slopes


def test_slopes_are_those_of_jax(sloped, through_jax):
    one, cycles, assessed, mine = sloped
    assert not np.any(assessed.faults)
    space, system, goal = one.given
    designs, along = _designs(space, system, jnp.asarray(one.points), one.first)
    theirs = through_jax(_sloped, designs, along, cycles, goal, one.resolution, one.results)
    assert jax.tree.structure(mine) == jax.tree.structure(theirs)
    assert mine.objective.shape == (one.first or space.dimension, 8)
    for found, expected in zip(jax.tree.leaves(mine), jax.tree.leaves(theirs), strict=True):
        size = np.max(np.abs(expected), axis=0, keepdims=True) + 1e-3
        assert np.max(np.abs(found - expected) / size) < 1e-8


def test_slopes_are_differences_of_designs_solved_anew(sloped):
    """Freed of their third-order term; each is solved with a mesh of its own."""
    one, _, _, slopes = sloped
    coordinates, step = (0, 1, 3), 2e-3
    ways = [
        one.points + way * step * np.eye(one.points.shape[1])[k]
        for k in coordinates
        for way in (2, 1, -1, -2)
    ]
    found = many.evaluate_many(*one.given, np.concatenate(ways), FINAL, threads=1, chunk=32)
    assert not np.any(found.faults)

    def differences(values):
        far, near, before, long_before = np.moveaxis(values.reshape(len(coordinates), 4, 8), 1, 0)
        return (8 * (near - before) - (far - long_before)) / (12 * step)

    expected = differences(found.physical_objective)
    mine = slopes.objective[coordinates, :]
    size = np.max(np.abs(slopes.objective), axis=0)
    # That is how well slopes in a batch are known, either way.
    assert np.max(np.abs(mine - expected) / size) < 4e-3
    for name in ("max_pressure_angle", "displacement_high", "min_undercut_factor"):
        np.testing.assert_allclose(
            slopes.constraints[name][coordinates, :],
            differences(found.constraints[name]),
            atol=1e-5,
            err_msg=name,
        )


def test_evaluate_many_says_the_same_with_the_switch_on_and_off(monkeypatch, through_jax):
    one = Example("mill", SEARCH)
    monkeypatch.setattr(many, "measure_batch", BatchProgram(measure_designs, QUICK))
    native = many.evaluate_many(*one.given, one.points, threads=1, chunk=8)
    assert not many.measure_batch.hindrances
    plain = through_jax(many.evaluate_many, *one.given, one.points, threads=1, chunk=8)
    np.testing.assert_array_equal(native.faults, plain.faults)
    for mine, theirs in zip(jax.tree.leaves(native), jax.tree.leaves(plain), strict=True):
        size = np.maximum(np.abs(theirs), 1e-3)
        assert np.max(np.abs(mine - theirs) / size) < 1e-6

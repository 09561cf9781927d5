"""A kept program answers as its function does; whatever is wrong with a file costs time only."""

import subprocess
import sys
from concurrent.futures import CancelledError, ThreadPoolExecutor

import equinox as eqx
import jax
import jax.numpy as jnp
import motors
import numpy as np
import pytest

from camring.metrics.timing import port_timing
from camring.numerics.radau import element_powers, horner
from camring.physics.leakage import ConstantLeakage
from camring.physics.resolution import Resolution
from camring.programs import kept_program
from camring.programs.compilation_cache import MAKING_SUFFIX, PROGRAMS, SWITCH
from camring.programs.compiled import simulate
from camring.programs.description import Indescribable, described
from camring.programs.jax_store import jax_store_unused
from camring.programs.kept_file import SUFFIX
from camring.programs.kept_program import KeptProgram, forget_programs
from camring.programs.motor_program import motor_program, named


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv(PROGRAMS, str(tmp_path))
    return tmp_path


@pytest.fixture
def compilations(monkeypatch):
    """The functions that were compiled, in order."""
    names = []
    compiled = KeptProgram._compiled

    def counted(self, path, *rest):
        names.append(path.name.partition("-")[0])
        return compiled(self, path, *rest)

    monkeypatch.setattr(KeptProgram, "_compiled", counted)
    return names


def kept(folder):
    return sorted(folder.glob(f"*{SUFFIX}"))


def same(left, right):
    assert jax.tree.structure(left) == jax.tree.structure(right)
    for a, b in zip(jax.tree.leaves(left), jax.tree.leaves(right), strict=True):
        np.testing.assert_array_equal(a, b)


def test_the_next_process_compiles_nothing_and_has_the_same_numbers(folder, compilations):
    case = motors.sound_case(0)
    first = KeptProgram(port_timing)(*case)
    assert compilations == ["port_timing"]
    same(KeptProgram(port_timing)(*case), first)  # a new one knows nothing but the disk
    assert compilations == ["port_timing"]
    same(eqx.filter_jit(port_timing)(*case), first)


FACTORISED = """
import sys
import jax.numpy as jnp, numpy as np
import camring
from camring.programs.kept_program import KeptProgram
from camring.search.surrogate.gaussian_process import factorise
if sys.argv[1] == "kept":
    KeptProgram._compiled = None
factor, _ = KeptProgram(factorise)(jnp.zeros((2, 2)), jnp.ones(2, bool), jnp.asarray(3.0))
print(np.asarray(factor).tolist())
"""


def test_a_program_from_disk_finds_its_linear_algebra_in_a_process_that_compiled_none(folder):
    for how in ("made", "kept"):
        done = subprocess.run(
            [sys.executable, "-c", FACTORISED, how], capture_output=True, text=True, timeout=300
        )
        assert (done.returncode, done.stdout) == (0, "[[2.0, 0.0], [0.0, 2.0]]\n"), done.stderr
        assert len(kept(folder)) == 1


def test_other_numbers_are_no_other_program(folder, compilations):
    timing = KeptProgram(port_timing)
    timing(*motors.sound_case(0))
    case = motors.sound_case(0).changed(lambda c: c.fluid.bulk_modulus, 0.9e9)
    same(timing(*case), eqx.filter_jit(port_timing)(*case))
    assert len(compilations) == len(kept(folder)) == 1


def test_a_whole_cycle_comes_back_with_its_motor_and_name(compilations):
    """From the folder of all tests, for it is the program that most of them use."""
    case = motors.sound_case(0, motors.STRUCTURES[0])
    for name in ("first", "second"):
        found = simulate(named(case.motor, name), case.fluid, case.point)
        assert found.motor.name == name
        same(found.motor, named(case.motor, name))
        if name == "first":
            forget_programs()
            compilations.clear()
    assert not compilations


def test_a_name_is_no_other_program(folder, compilations):
    timing, case = motor_program(port_timing), motors.sound_case(0)
    for name in ("one", "another", ""):
        timing(named(case.motor, name), case.fluid, case.point)
    assert compilations == ["port_timing"]


def test_what_is_no_array_makes_another_program(folder, compilations):
    scaled = KeptProgram(jnp.full)  # a shape is not an array
    assert scaled((2,), np.float64(3)).shape == (2,)
    assert scaled((4,), np.float64(3)).shape == (4,)
    assert scaled((4,), np.float32(3)).dtype == np.float32
    assert len(compilations) == 3


def test_of_two_that_want_one_program_at_once_the_second_waits_for_the_first(folder, compilations):
    """Two processes, or two functions of one; a lock left behind by a dead one holds nobody up."""
    case = motors.sound_case(0)
    KeptProgram(port_timing)(*case)
    (path,) = kept(folder)
    path.unlink()
    path.with_suffix(MAKING_SUFFIX).touch()
    compilations.clear()
    with ThreadPoolExecutor(2) as pool:
        one, other = pool.map(
            lambda program: program(*case), [KeptProgram(port_timing) for _ in "ab"]
        )
    same(one, other)
    assert compilations == ["port_timing"]
    assert not path.with_suffix(MAKING_SUFFIX).exists()


def above(values, limit=0.5):
    return values * (values > limit)


class TestBegun:
    """Compiled in a thread, before it is asked for."""

    def test_the_call_waits_for_it_and_says_the_same(self, folder, compilations):
        case, timing = motors.sound_case(0), KeptProgram(port_timing)
        shapes = timing.begin(*case).result(timeout=300)
        found = timing(*case)
        assert compilations == ["port_timing"]
        assert len(kept(folder)) == 1
        same(found, eqx.filter_jit(port_timing)(*case))
        assert jax.tree.map(lambda leaf: leaf.shape, shapes) == jax.tree.map(np.shape, found)

    def test_shapes_are_enough_to_begin_what_comes_after(self, folder, compilations):
        first, second = KeptProgram(element_powers), KeptProgram(horner)
        node, stages, fraction = jnp.ones(4), jnp.ones((3, 4)), jnp.asarray(0.5)
        powers = first.begin(node, stages).result(timeout=300)
        second.begin(powers, fraction)
        found = second(first(node, stages), fraction)
        assert sorted(compilations) == ["element_powers", "horner"]
        np.testing.assert_allclose(found, 1, rtol=1e-12)

    def test_what_is_there_is_not_begun(self, folder, compilations):
        case = motors.sound_case(0)
        KeptProgram(port_timing)(*case)
        with pytest.raises(CancelledError):
            KeptProgram(port_timing).begin(*case).result(timeout=300)
        assert compilations == ["port_timing"]

    def test_what_is_wrong_the_call_says(self, folder):
        timing, (motor, fluid, _) = KeptProgram(port_timing), motors.sound_case(0)
        with pytest.raises(CancelledError):
            timing.begin(motor, fluid, None).result(timeout=300)
        with pytest.raises(AttributeError, match="NoneType"):
            timing(motor, fluid, None)


def test_what_is_left_out_is_its_default(folder, compilations, monkeypatch):
    monkeypatch.setattr(kept_program, "program_name", lambda *given: described(given[1]))
    program, values = KeptProgram(above), np.linspace(0, 1, 4)
    for found in (program(values), program(values, 0.5), program(values, limit=0.5)):
        np.testing.assert_array_equal(found, above(values))
    assert compilations == ["above"]
    np.testing.assert_array_equal(program(values, limit=0.2), above(values, 0.2))
    assert len(compilations) == 2
    with pytest.raises(TypeError, match="unexpected"):
        program(values, lowest=0.2)


@pytest.mark.parametrize("damage", [lambda whole: whole[: len(whole) // 2], lambda whole: b"no"])
def test_a_damaged_file_is_made_anew(folder, compilations, damage):
    case = motors.sound_case(0)
    first = KeptProgram(port_timing)(*case)
    (path,) = kept(folder)
    whole = path.read_bytes()
    path.write_bytes(damage(whole))
    same(KeptProgram(port_timing)(*case), first)
    assert len(compilations) == 2
    same(KeptProgram(port_timing)(*case), first)
    assert len(compilations) == 2


def test_a_folder_that_cannot_be_written_is_no_error(tmp_path, monkeypatch, compilations):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv(PROGRAMS, str(tmp_path / "file" / "programs"))
    case = motors.sound_case(0)
    same(KeptProgram(port_timing)(*case), eqx.filter_jit(port_timing)(*case))


def test_without_a_folder_it_is_a_compiled_function(monkeypatch, compilations):
    monkeypatch.setenv(PROGRAMS, "")
    case = motors.sound_case(0)
    same(KeptProgram(port_timing)(*case), eqx.filter_jit(port_timing)(*case))
    assert not compilations


def test_whoever_imports_the_package_has_them_too(tmp_path, monkeypatch):
    monkeypatch.delenv(PROGRAMS, raising=False)
    monkeypatch.setenv(SWITCH, str(tmp_path / "elsewhere"))
    KeptProgram(port_timing)(*motors.sound_case(0))
    assert len(list((tmp_path / "elsewhere").rglob(f"port_timing-*{SUFFIX}"))) == 1


def test_the_switch_of_the_compilation_cache_is_theirs(tmp_path, monkeypatch):
    monkeypatch.delenv(PROGRAMS, raising=False)
    monkeypatch.setenv(SWITCH, "off")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    KeptProgram(port_timing)(*motors.sound_case(0))
    assert not list(tmp_path.rglob(f"*{SUFFIX}"))


class OwnLeakage(ConstantLeakage):
    """A user's law: its source is not this package's, and may be another tomorrow."""


def test_a_law_of_a_users_own_is_never_kept(folder, compilations):
    case = motors.sound_case(0)
    own = eqx.tree_at(lambda m: m.leakage, case.motor, OwnLeakage(case.motor.leakage.coefficient))
    timing = KeptProgram(port_timing)
    for _ in range(2):
        same(timing(own, case.fluid, case.point), eqx.filter_jit(port_timing)(*case))
    assert not compilations
    assert not kept(folder)
    with pytest.raises(Indescribable, match="OwnLeakage"):
        described(own)
    with pytest.raises(Indescribable, match="lambda"):
        described(lambda: None)


def test_inside_another_traced_function_it_is_part_of_that(folder, compilations):
    timing, case = KeptProgram(port_timing), motors.sound_case(0)
    slopes = jax.jacfwd(
        lambda modulus: timing(
            case.motor, eqx.tree_at(lambda f: f.bulk_modulus, case.fluid, modulus), case.point
        )
    )(case.fluid.bulk_modulus)
    assert all(np.all(np.isfinite(leaf)) for leaf in jax.tree.leaves(slopes))
    assert not compilations


@pytest.mark.parametrize("in_use", [True, False])
def test_jaxs_own_store_is_afterwards_as_it_was_before(monkeypatch, in_use):
    before = jax.config.jax_enable_compilation_cache
    try:
        jax.config.update("jax_enable_compilation_cache", in_use)
        with jax_store_unused():
            with jax_store_unused():
                assert not jax.config.jax_enable_compilation_cache
            assert not jax.config.jax_enable_compilation_cache
        assert jax.config.jax_enable_compilation_cache == in_use
    finally:
        jax.config.update("jax_enable_compilation_cache", before)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (1, 1.0),
        (1, True),
        ("a", b"a"),
        ((1, 2), [1, 2]),
        ((1, (2,)), ((1, 2),)),
        (np.zeros(2), np.zeros(3)),
        (np.zeros(2), np.zeros(2, np.float32)),
        (Resolution(), Resolution.coarse()),
        (None, "None"),
    ],
)
def test_descriptions_tell_apart_what_a_trace_would(one, other):
    assert described(one) != described(other)


def test_descriptions_hold_no_numbers_of_arrays():
    assert described(jnp.zeros(3)) == described(jnp.ones(3))
    assert described(motors.sound_case(0).motor) == described(motors.sound_case(0).motor)

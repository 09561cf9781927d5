"""A batch program answers as its function does, for a batch of any size, compiled or kept."""

import threading
from concurrent.futures import ThreadPoolExecutor

import jax
import jax.numpy as jnp
import motors
import numpy as np
import pytest

from camring.compiler.graph import NotInLanes
from camring.numerics.batch import ascending_rows, interpolate, running_total
from camring.physics.rotation import turned
from camring.programs import batch_program
from camring.programs.batch_program import SWITCH, BatchProgram
from camring.programs.compilation_cache import PROGRAMS
from camring.programs.kept_file import SUFFIX, sealed
from camring.programs.motor_program import named


@pytest.fixture(autouse=True)
def _switched_on(monkeypatch):
    monkeypatch.delenv(SWITCH, raising=False)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv(PROGRAMS, str(tmp_path))
    return tmp_path


@pytest.fixture
def compilations(monkeypatch, request):
    """A word for every program that was compiled natively; none comes from other tests' folder."""
    if "folder" not in request.fixturenames:
        monkeypatch.setenv(PROGRAMS, "")
    made = []

    class Counted(batch_program.NativeProgram):
        def __init__(self, function, arguments):
            super().__init__(function, arguments)
            made.append(function.__name__)

    monkeypatch.setattr(batch_program, "NativeProgram", Counted)
    return made


def kept(folder):
    return sorted(folder.glob(f"*{SUFFIX}"))


def rows(members=13, count=5, seed=0):
    return np.random.default_rng(seed).normal(size=(count, members))


def tables(members=13):
    """Arguments of `interpolate`: values, ascending rows, and what they lead to."""
    return rows(members, 4, 1), np.sort(rows(members, 6, 2), axis=0), rows(members, 6, 3)


def same(left, right):
    assert jax.tree.structure(left) == jax.tree.structure(right)
    for a, b in zip(jax.tree.leaves(left), jax.tree.leaves(right), strict=True):
        assert a.dtype == b.dtype
        np.testing.assert_array_equal(a, b)


def near(left, right):
    """But for rounding, which compilers do not agree about."""
    assert jax.tree.structure(left) == jax.tree.structure(right)
    for a, b in zip(jax.tree.leaves(left), jax.tree.leaves(right), strict=True):
        assert a.dtype == b.dtype
        np.testing.assert_allclose(a, b, rtol=1e-13, atol=1e-15)


def of_a_users_own(x, scale=1.0):
    """Not of this package: known by no lasting name."""
    return {"sum": scale * jnp.sum(x, axis=0), "rows": (jnp.exp(x), "a word", 3)}


def in_order(x):
    return jnp.sort(x, axis=0) * 2


# what it answers


def test_it_answers_as_its_function_does(compilations):
    program = BatchProgram(interpolate)
    near(program(*tables()), jax.jit(interpolate)(*tables()))
    value, ascending, results = tables()
    near(
        program(value, results=results, ascending=ascending),
        jax.jit(interpolate)(value, ascending, results),
    )
    assert not program.hindrances


def test_what_is_no_array_comes_back_and_makes_another_program(compilations):
    program = BatchProgram(of_a_users_own)
    for scale in (1.0, 2.0, 1.0):
        found = program(rows(), scale)
        assert found["rows"][1:] == ("a word", 3)
        np.testing.assert_allclose(found["sum"], scale * rows().sum(axis=0), rtol=1e-13)
    assert compilations == ["of_a_users_own"] * 2


def test_arrays_of_numpy_and_of_jax_are_one_program(compilations):
    program = BatchProgram(running_total)
    same(program(rows()), program(jnp.asarray(rows())))
    assert len(compilations) == 1


def test_other_types_and_other_rows_are_other_programs(compilations):
    program = BatchProgram(running_total)
    for given in (rows(), rows().astype(np.float32), rows(count=7), rows().astype(np.int32)):
        same(program(given), jax.jit(running_total)(given))
    assert len(compilations) == 4


def test_a_number_for_all_members_may_stand_beside_them(compilations):
    program = BatchProgram(jnp.multiply)
    for number in (np.float64(3), jnp.asarray(-2.5), np.asarray(0.1)):
        same(program(rows(), number), rows() * np.asarray(number))
    assert len(compilations) == 1


# a batch of any size


@pytest.mark.parametrize("function", [interpolate, ascending_rows], ids=lambda f: f.__name__)
def test_any_number_of_members_is_one_program(compilations, function):
    program = BatchProgram(function)
    whole = tables(1000) if function is interpolate else (rows(1000), rows(1000, seed=4))
    everything = program(*whole)
    for members in (1, 8, 13, 999):
        for first in (0, 1000 - members, 5 if members < 900 else 0):
            here = slice(first, first + members)
            found = program(*(each[..., here] for each in whole))
            same(found, jax.tree.map(lambda leaf, here=here: leaf[..., here], everything))
    assert len(compilations) == 1
    near(everything, jax.jit(function)(*whole))


def test_a_member_never_depends_on_its_neighbours():
    program, (value, ascending, results) = BatchProgram(interpolate), tables(24)
    alone = program(value, ascending, results)
    for poison in (np.nan, np.inf, 1e300):
        spoiled = results.copy()
        spoiled[:, 10] = poison
        found = program(value, ascending, spoiled)
        others = np.arange(24) != 10
        np.testing.assert_array_equal(found[:, others], alone[:, others])


# on disk


def test_the_next_process_compiles_nothing_and_has_the_same_numbers(folder, compilations):
    first = BatchProgram(interpolate)(*tables())
    assert len(compilations) == len(kept(folder)) == 1
    assert kept(folder)[0].name.startswith("interpolate-batch-")
    for members in (13, 1, 40):  # a new one knows nothing but the disk
        near(BatchProgram(interpolate)(*tables(members)), jax.jit(interpolate)(*tables(members)))
    same(BatchProgram(interpolate)(*tables()), first)
    assert len(compilations) == len(kept(folder)) == 1


def test_a_tuple_of_results_comes_back_from_disk_as_one(folder, compilations):
    given = rows(20), rows(20, seed=1)
    found = [BatchProgram(ascending_rows)(*given) for _ in range(2)]
    assert isinstance(found[1], tuple)
    same(*found)
    assert len(compilations) == 1


DAMAGES = {
    "half of it": lambda whole: whole[: len(whole) // 2],
    "nothing": lambda whole: b"",
    "something else": lambda whole: b"no",
    "one bit": lambda whole: whole[:300] + bytes([whole[300] ^ 1]) + whole[301:],
    "another kind of program": lambda whole: ("code", "inner", "outer", None),
    "code of fewer parts": lambda whole: ((b"", 0), None),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_file_or_one_of_another_version_is_made_anew(folder, compilations, damage):
    first = BatchProgram(interpolate)(*tables())
    (path,) = kept(folder)
    spoilt = DAMAGES[damage](path.read_bytes())
    path.write_bytes(spoilt if isinstance(spoilt, bytes) else sealed(path.name, spoilt))
    same(BatchProgram(interpolate)(*tables()), first)
    assert len(compilations) == 2
    same(BatchProgram(interpolate)(*tables()), first)
    assert len(compilations) == 2
    assert len(kept(folder)) == 1


def test_another_processor_or_compiler_has_programs_of_its_own(folder, compilations, monkeypatch):
    BatchProgram(running_total)(rows())
    monkeypatch.setattr(batch_program, "made_by", lambda: "another LLVM for another processor")
    BatchProgram(running_total)(rows())
    assert len(compilations) == len(kept(folder)) == 2


def test_what_is_kept_is_found_whatever_the_number_of_members(folder, compilations):
    BatchProgram(running_total)(rows(1))
    BatchProgram(running_total)(rows(1000))
    assert len(compilations) == len(kept(folder)) == 1


def test_a_law_of_a_users_own_is_never_kept(folder, compilations):
    for _ in range(2):
        BatchProgram(of_a_users_own)(rows())
    assert len(compilations) == 2
    assert not kept(folder)


def test_nothing_is_kept_without_a_folder(tmp_path, monkeypatch, compilations):
    monkeypatch.setenv(PROGRAMS, "")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    for _ in range(2):
        BatchProgram(running_total)(rows())
    assert len(compilations) == 2
    assert not list(tmp_path.rglob(f"*{SUFFIX}"))


def test_a_folder_that_cannot_be_written_is_no_error(tmp_path, monkeypatch, compilations):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv(PROGRAMS, str(tmp_path / "file" / "programs"))
    same(BatchProgram(running_total)(rows()), jax.jit(running_total)(rows()))


# names


def members_of(case):
    return jax.tree.map(
        lambda leaf: jnp.broadcast_to(leaf[..., None], (*leaf.shape, 8)), tuple(case)
    )


def test_names_of_motors_make_no_other_program(folder, compilations):
    program = BatchProgram(turned)
    motor, _, point = members_of(motors.sound_case(0))
    backwards = jax.tree.map(lambda leaf: leaf, point)
    for name in ("one", "another", ""):
        found = program(named(motor, name), backwards)
        assert found.name == ""
        same(found, motor)
        same(BatchProgram(turned)(named(motor, name), backwards), motor)
    assert len(compilations) == len(kept(folder)) == 1


# where JAX does it


def test_what_there_is_no_code_for_goes_through_jax_and_says_why(folder, compilations):
    program = BatchProgram(in_order)
    for members in (13, 13, 8):
        found = program(rows(members))
        assert isinstance(found, jax.Array)
        same(found, jax.jit(in_order)(rows(members)))
    assert len(program.hindrances) == 1  # it tries once
    assert "sort" in program.hindrances[0]
    assert not compilations
    assert not kept(folder)


@pytest.mark.parametrize("fault", [NotInLanes("no code for `sort`"), ValueError("two\n lines")])
def test_whatever_fails_is_left_to_jax_with_one_warning(folder, monkeypatch, fault):
    def fails(function, arguments):
        raise fault

    monkeypatch.setattr(batch_program, "NativeProgram", fails)
    monkeypatch.setattr(batch_program, "_warned", threading.Event())
    first, other = BatchProgram(running_total), BatchProgram(jnp.negative)
    asked = [(first, rows()), (first, rows(count=7)), (other, rows())]
    with pytest.warns(RuntimeWarning, match="three to eight times slower") as caught:
        found = [program(given) for program, given in asked]
    same(found, [jax.jit(running_total)(rows()), jax.jit(running_total)(rows(count=7)), -rows()])
    (warning,) = caught
    words = str(warning.message)
    reason = "no code for `sort`" if isinstance(fault, NotInLanes) else "ValueError: two lines"
    assert reason in words
    assert "CAMRING_NATIVE=off" in words


def test_the_switch_lets_jax_do_everything(folder, compilations, monkeypatch):
    program = BatchProgram(running_total)
    for word in ("off", "OFF"):
        monkeypatch.setenv(SWITCH, word)
        found = program(rows())
        assert isinstance(found, jax.Array)
        same(found, jax.jit(running_total)(rows()))
    assert not compilations
    assert not program.hindrances
    assert not [each for each in kept(folder) if "-batch-" in each.name]
    monkeypatch.setenv(SWITCH, "on")
    program(rows())
    assert len(compilations) == 1


def test_on_a_graphics_card_jax_does_everything(compilations, monkeypatch):
    monkeypatch.setattr(jax, "default_backend", lambda: "gpu")
    same(BatchProgram(running_total)(rows()), jax.jit(running_total)(rows()))
    assert not compilations


def test_inside_another_traced_function_it_is_part_of_that(folder, compilations):
    program, (value, ascending, results) = BatchProgram(interpolate), tables()

    def scaled(factor):
        return jnp.sum(program(value, ascending, factor * results))

    total = float(jnp.sum(interpolate(value, jnp.asarray(ascending), jnp.asarray(results))))
    assert float(jax.jit(scaled)(2.0)) == pytest.approx(2 * total, rel=1e-13)
    assert float(jax.grad(scaled)(2.0)) == pytest.approx(total, rel=1e-13)
    assert not compilations
    assert not kept(folder)


def test_to_search_for_mistakes_nothing_is_compiled(folder, compilations):
    traced = []

    def seen(x):
        traced.append(isinstance(x, jax.core.Tracer))
        return x + 1

    with jax.disable_jit():
        np.testing.assert_array_equal(BatchProgram(seen)(jnp.asarray(rows())), rows() + 1)
    assert traced == [False]
    with jax.debug_nans(True), pytest.raises(FloatingPointError):
        BatchProgram(jnp.log)(-np.ones((3, 8)))
    assert not compilations
    assert not kept(folder)
    assert np.all(np.isnan(BatchProgram(jnp.log)(-np.ones((3, 8)))))


# several threads


def test_threads_at_once_compile_once_and_agree(folder, compilations):
    program, threads = BatchProgram(interpolate), 8
    together = threading.Barrier(threads)
    given = [tables(40 + number) for number in range(threads)]

    def called(number):
        together.wait()
        return [program(*given[number]) for _ in range(50)]

    with ThreadPoolExecutor(threads) as pool:
        found = list(pool.map(called, range(threads)))
    assert len(compilations) == len(kept(folder)) == 1
    for number, answers in enumerate(found):
        expected = jax.jit(interpolate)(*given[number])
        for each in answers:
            near(each, expected)


def test_answers_are_not_written_over_by_the_next_call():
    program = BatchProgram(running_total)
    first = program(rows(seed=1))
    before = first.copy()
    program(rows(seed=2))
    np.testing.assert_array_equal(first, before)


def test_arguments_stay_as_they_are():
    given, program = rows(), BatchProgram(in_place_of)
    before = given.copy()
    found = program(given)
    found[...] = 0  # a result that is an argument is a copy of it
    np.testing.assert_array_equal(given, before)


def in_place_of(x):
    return x

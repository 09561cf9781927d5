"""Machine code for arrays with lanes gives what JAX gives, step by step."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from jax import lax
from machine_code import LANES, assert_same, both, rows

from camring.compiler.graph import NotInLanes
from camring.compiler.program import NativeProgram
from camring.numerics.batch import (
    ascending_rows,
    interpolate,
    locate,
    reached,
    running_total,
    take,
)
from camring.numerics.compilation import computed_once

MATRIX = np.random.default_rng(9).normal(size=(11, 7))
VIEWS = {
    "slice": lambda x: x[1:4],
    "strides": lambda x: x[::3],
    "strides of a later axis": lambda x: x.reshape(3, 4, -1)[:, 1::2],
    "one row": lambda x: x[5],
    "slice from a place": lambda x: lax.dynamic_slice_in_dim(x, 2, 5) + x[:5],
    "slice from beyond the end": lambda x: lax.dynamic_slice_in_dim(x, 10, 5) * 2,
    "rows put on a device": lambda x: x * jax.device_put(np.arange(12.0)[:, None]),
    "reshape": lambda x: x.reshape(3, 4, -1) * x[:4],
    "broadcast": lambda x: x[:, None] * x[None, :5],
    "broadcast of one row": lambda x: jnp.broadcast_to(x[2], (4, *x[2].shape)) + 1,
    "repeat": lambda x: jnp.repeat(x, 3, axis=0),
    "roll": lambda x: jnp.roll(x, 5, axis=0) - x,
    "roll of a later axis": lambda x: jnp.roll(x.reshape(3, 4, -1), 1, axis=1),
    "concatenate": lambda x: jnp.concatenate([x[:3] * 2, x[7:], x * x]),
    "concatenate of one array": lambda x: jnp.concatenate([x[7:], x[:7]]) * x,
    "concatenate with known rows": lambda x: jnp.concatenate([jnp.zeros_like(x[:1]), x + 1]),
    "stack": lambda x: jnp.stack([x[0] + 1, x[1] * 2, x[2]]),
    "stack of rows": lambda x: jnp.stack([x[:6] + 1, x[6:] * 2]),
    "flip": lambda x: x[::-1] + x,
    "flip of a later axis": lambda x: jnp.flip(x.reshape(3, 4, -1), 1),
    "transpose": lambda x: x.reshape(3, 4, -1).transpose(1, 0, 2) * 2,
    "known rows": lambda x: x[np.array([3, 3, 0, 11])],
    "views of views": lambda x: jnp.roll((x * 2)[::-1][2:10:2], 1, 0)[:, None] + x[None, :2],
}
FOLDS = {
    "sum": lambda x: jnp.sum(x, axis=0),
    "sum over all rows": lambda x: jnp.sum(x.reshape(3, 4, -1), axis=(0, 1)),
    "sum over the first axis": lambda x: jnp.sum(x.reshape(3, 4, -1), axis=0),
    "sum over the second axis": lambda x: jnp.sum(x.reshape(3, 4, -1), axis=1),
    "sum of one row": lambda x: jnp.sum(x[:1], axis=0),
    "mean": lambda x: x - jnp.mean(x, axis=0),
    "largest": lambda x: jnp.max(x, axis=0),
    "smallest": lambda x: jnp.min(x.reshape(2, 6, -1), axis=1),
    "all": lambda x: jnp.all(x > -2, axis=0),
    "any": lambda x: jnp.any(x > 2, axis=0),
    "a count": lambda x: jnp.sum(x > 0, axis=0),
    "a whole number's largest": lambda x: jnp.max(jnp.floor(x * 3).astype(jnp.int32), axis=0),
    "running total": lambda x: jnp.cumsum(x * 2, axis=0) + x,
    "running total from zero": running_total,
    "running count": lambda x: jnp.cumsum((x > 0).astype(jnp.int32), axis=0),
    "a fold of a running total": lambda x: jnp.max(jnp.cumsum(x, axis=0), axis=0) - x,
    "two folds of one array": lambda x: (x - jnp.min(x, 0)) / (jnp.max(x, 0) - jnp.min(x, 0)),
    "product with a matrix": lambda x: jnp.asarray(MATRIX) @ x[:7],
    "product with rows in the middle": lambda x: jnp.asarray(MATRIX) @ x[2:9],
    "product with rows in another order": lambda x: jnp.asarray(MATRIX) @ x[8:1:-1],
    "product with several axes": lambda x: jnp.einsum(
        "rt,tsl->rsl", MATRIX[:, :3], x.reshape(3, 4, -1)
    ),
}


def _scan_with_both(x):
    def step(carry, each):
        total, largest = carry
        total = 0.5 * total + each
        return (total, jnp.maximum(largest, total)), (total * each, total > 0)

    return lax.scan(step, (x[0], x[1]), x)


def _scan_backwards(x):
    return lax.scan(lambda c, e: (c * 0.3 + e[0], c - e[1]), x[0], (x, x[::-1]), reverse=True)


def _scan_with_what_is_outside(x):
    fixed = jnp.sum(x, axis=0)
    carry, left = lax.scan(lambda c, e: (c + e * fixed, c), jnp.zeros_like(x[0]), x[1:])
    return left * carry


LOOPS = {
    "scan": _scan_with_both,
    "scan backwards": _scan_backwards,
    "scan with what is outside": _scan_with_what_is_outside,
    "nested jit": lambda x: jax.jit(lambda y: jax.jit(jnp.sin)(y) * y)(x),
    "computed once": lambda x: (lambda y: y[0] * y[1])(computed_once((x * 2, x + 1))),
    "barrier": lambda x: lax.optimization_barrier(x) * 2,
    "stopped gradient": lambda x: lax.stop_gradient(x) * x,
}


@pytest.mark.parametrize("name", VIEWS)
def test_a_view_costs_no_accuracy(name):
    assert_same(VIEWS[name], rows(12), rtol=0)


@pytest.mark.parametrize("name", FOLDS)
def test_a_fold_is_that_of_jax(name):
    assert_same(FOLDS[name], rows(12), atol=1e-14)


@pytest.mark.parametrize("name", LOOPS)
def test_a_loop_is_that_of_jax(name):
    assert_same(LOOPS[name], rows(12), atol=1e-14)


SPECIAL = np.array([0.0, -0.0, 1.5, -2.5, np.nan, np.inf, -np.inf, 0.5])
PAIRS = [each.reshape(8, 8) for each in np.meshgrid(SPECIAL, SPECIAL)]
POINTWISE = {
    "add": lambda x, y: x + y,
    "subtract": lambda x, y: x - y,
    "multiply": lambda x, y: x * y,
    "divide": lambda x, y: x / y,
    "negative": lambda x, y: -x,
    "modulus": lambda x, y: jnp.abs(x),
    "sign": lambda x, y: jnp.sign(x),
    "root": lambda x, y: jnp.sqrt(x),
    "larger": jnp.maximum,
    "smaller": jnp.minimum,
    "floor": lambda x, y: jnp.floor(x),
    "ceiling": lambda x, y: jnp.ceil(x),
    "round": lambda x, y: jnp.round(x),
    "round away from zero": lambda x, y: lax.round(x, lax.RoundingMethod.AWAY_FROM_ZERO),
    "clip": lambda x, y: jnp.clip(x, -1, 1),
    "clamp": lambda x, y: lax.clamp(y, x, 2.0),
    "finite": lambda x, y: jnp.isfinite(x),
    "no number": lambda x, y: jnp.isnan(x),
    "comparisons": lambda x, y: (x < y, x <= y, x > y, x >= y, x == y, x != y),
    "choice": lambda x, y: jnp.where(x < y, x, y),
    "choice of no number": lambda x, y: jnp.where(x < y, x, jnp.nan),
    "rest": lax.rem,
    "rest of the divisor's sign": jnp.remainder,
    "square": lambda x, y: jnp.square(x),
    "whole powers": lambda x, y: (x**0, x**1, x**2, x**7, x**-1, x**-3),
    "truths": lambda x, y: ((x < y) & (x > 0), (x < y) | (x > 0), (x < y) ^ (y > 0), ~(x < y)),
    "larger truths": lambda x, y: (jnp.maximum(x < y, x > 0), jnp.minimum(x < y, x > 0)),
    "truths as numbers": lambda x, y: ((x < y) * 2.5, (x < y).astype(int), x.astype(bool)),
    "whole numbers": lambda x, y: (x.astype(int), y.astype(jnp.int32)),
    "single precision": lambda x, y: x.astype(jnp.float32) * y.astype(jnp.float32),
    "digits": lambda x, y: lax.bitcast_convert_type(x, jnp.int64),
    "reciprocal of a root": lambda x, y: lax.rsqrt(jnp.abs(x)),
}


@pytest.mark.parametrize("name", POINTWISE)
def test_what_is_no_number_comes_out_as_it_does_in_jax(name):
    assert_same(POINTWISE[name], *PAIRS)


@pytest.mark.parametrize("fold", [jnp.max, jnp.min, jnp.sum])
@pytest.mark.parametrize("lead", [(3,), (40,), (4, 5)])
def test_a_fold_with_no_number_in_it_is_none(fold, lead):
    x = rows(*lead)
    x[(1,) * len(lead)][2] = np.nan
    x[(2,) * len(lead)][3] = np.inf
    assert_same(
        lambda x: (fold(x, axis=0), fold(x.reshape(-1, x.shape[-1]), axis=0)), x, atol=1e-14
    )


WHOLE = {
    "quotient": lax.div,
    "rest": lax.rem,
    "floored quotient": lambda n, m: n // m,
    "rest of the divisor's sign": lambda n, m: n % m,
    "sums": lambda n, m: n + m * n - m,
    "powers": lambda n, m: n**3,
    "larger": jnp.maximum,
    "smaller": jnp.minimum,
    "signs": lambda n, m: (jnp.sign(n), jnp.abs(n), -n),
    "comparisons": lambda n, m: (n < m, n >= m, n == m),
    "digits": lambda n, m: (n & m, n | m, n ^ m, ~n),
    "shift to the left": lambda n, m: lax.shift_left(n, m),
    "shift to the right": lambda n, m: (
        lax.shift_right_logical(n, m),
        lax.shift_right_arithmetic(n, m),
    ),
    "other kinds": lambda n, m: (n.astype(float), n.astype(jnp.int32), n.astype(jnp.uint8)),
    "folds": lambda n, m: (jnp.max(n, axis=0), jnp.min(n, axis=0), jnp.sum(n, axis=0)),
}


@pytest.mark.parametrize("kind", [np.int32, np.int64, np.uint32, np.uint8])
@pytest.mark.parametrize("name", WHOLE)
def test_whole_numbers_are_those_of_jax(name, kind):
    """Zero and the largest as divisors, and shifts by more than there are digits, included."""
    least, most = np.iinfo(kind).min, np.iinfo(kind).max
    some = np.array([0, 1, 2, 3, most, least, 40, most // 3], kind)
    some[4:6] = most, least
    some = np.concatenate([some, (0 - some.astype(object)).astype(object) % (int(most) + 1)])
    some = some.astype(kind)
    if kind in (np.int32, np.int64):
        some[-4:] = -1, -2, -7, least + 1
    first, second = (each.reshape(16, 16) for each in np.meshgrid(some, some))
    assert_same(WHOLE[name], first, second)


def test_rests_are_exact_and_those_of_too_large_quotients_are_refused():
    rng = np.random.default_rng(2)
    x = rng.normal(size=(50, LANES)) * 10.0 ** rng.uniform(-3, 12, (50, LANES))
    y = rng.normal(size=(50, LANES))
    x[:10], y[:10] = rng.integers(-9, 9, (10, LANES)) * y[:10], np.abs(y[:10])
    found, expected = both(lax.rem, x, y)
    np.testing.assert_array_equal(found, np.fmod(x, y))
    np.testing.assert_array_equal(found, expected)
    program = NativeProgram(lambda given: lax.rem(*given), (x, y))
    assert np.all(np.isnan(program((np.full_like(x, 1e20), np.full_like(x, 3.0)))))


def test_rows_are_taken_lane_by_lane():
    x = rows(9)
    number = np.random.default_rng(3).integers(0, 9, (20, LANES))
    assert_same(take, x, number, rtol=0)
    assert_same(take, x, number.reshape(4, 5, LANES).astype(np.int32), rtol=0)
    assert_same(lambda x, n: take(x * 2, n) + take(x[2:], jnp.minimum(n, 6)), x, number, rtol=0)
    assert_same(lambda x, n: take(x[::-1], n) - take(jnp.roll(x, 2, 0), n[0]), x, number, rtol=0)
    assert_same(take, number, number)


def test_rows_are_found_lane_by_lane():
    x, value = np.sort(rows(37), axis=0), rows(50, seed=1)
    x[7:9] = x[6]
    value[:37] = x
    assert_same(locate, x, value)
    assert_same(interpolate, value, x, rows(37, seed=2), rtol=1e-12)


@pytest.mark.parametrize("count", [1, 5, 30])
def test_thresholds_are_counted_lane_by_lane(count):
    number = np.random.default_rng(3).integers(-3, 25, (count, LANES)).astype(np.int32)
    assert_same(lambda n: reached(n, 20), number)
    assert_same(lambda n: jnp.max(reached(n + 1, 20), axis=0), number)


@pytest.mark.parametrize("count", [2, 6])
def test_rows_are_ordered_lane_by_lane(count):
    x = np.round(rows(count), 1)
    assert_same(ascending_rows, x, rows(count, seed=1), rtol=0)


def test_one_number_of_all_lanes_is_the_largest_of_all_blocks():
    x = rows(12, lanes=40)
    program = NativeProgram(lambda x: (jnp.max(x), x / 2), x)
    found, _ = program(x)
    assert found == x.max()


# repetitions


def _halved(x):
    """Newton for a cube root, until the slowest lane has it."""

    def goes_on(state):
        y, count = state
        return (jnp.max(jnp.abs(y**3 - x)) > 1e-12) & (count < 60)

    def step(state):
        y, count = state
        return y - (y**3 - x) / (3 * y * y), count + 1

    return lax.while_loop(goes_on, step, (jnp.ones_like(x), jnp.asarray(0)))


def test_a_repetition_ends_where_it_does_in_jax():
    x = np.abs(rows(12, lanes=8)) + 0.1
    assert_same(_halved, x)


def _rounds(step, count=5):
    def loop(*begin):
        state = (jnp.asarray(0), *begin)
        return lax.while_loop(lambda s: s[0] < count, lambda s: (s[0] + 1, *step(*s[1:])), state)[
            1:
        ]

    return loop


REPEATED = {
    "row by row": lambda x, y: (x * 0.5 + y, y - 1),
    "with a neighbour": lambda x, y: (x * 0.5 + jnp.roll(x, 1, 0), y),
    "with both neighbours": lambda x, y: (0.3 * (jnp.roll(x, 1, 0) + jnp.roll(x, -1, 0)), y + x),
    "upside down": lambda x, y: (x[::-1] * 0.5, y),
    "one from the other": lambda x, y: (y * 0.5, x + 1),
    "exchanged and shifted": lambda x, y: (jnp.roll(y, 1, 0) * 0.5, x[::-1] + 1),
    "both from both": lambda x, y: (x + y, x - y),
    "the second from the new first": lambda x, y: (lambda new: (new, y + new))(x * 0.5 + 1),
    "the second from the old first": lambda x, y: (x * 0.5 + 1, y + jnp.roll(x, 1, 0)),
    "the same twice": lambda x, y: (lambda new: (new, new))(x * 0.5 + y),
    "a fold of the old": lambda x, y: (x - jnp.mean(x, axis=0), y * jnp.max(x, axis=0)),
    "a fold of the new": lambda x, y: (lambda new: (new, y - 0.1 * jnp.sum(new, axis=0)))(
        0.5 * x + 1
    ),
    "old and fold of the new": lambda x, y: (lambda new: (new, x + jnp.sum(new, axis=0)))(
        0.5 * x + y
    ),
    "running totals": lambda x, y: (0.1 * jnp.cumsum(x, axis=0), y + x),
    "a product": lambda x, y: (x * 0.9, y + jnp.asarray(0.1 * MATRIX[:, :3]) @ x[:3, :][:, :]),
    "taken rows": lambda x, y: (
        0.5 * take(x, jnp.clip(y * 3, 0, 10).astype(jnp.int32)),
        y - 0.1,
    ),
    "joined": lambda x, y: (jnp.concatenate([x[1:] * 0.5, y[:1]]), y),
    "not changed": lambda x, y: (x, y + x),
    "a nested loop": lambda x, y: _rounds(lambda a, b: (a * 0.5 + b, b), 3)(x, y),
}


@pytest.mark.parametrize("name", REPEATED)
def test_carried_rows_are_not_overwritten_before_they_are_read(name):
    assert_same(_rounds(REPEATED[name]), rows(11), rows(11, seed=1), atol=1e-13)


def test_rows_that_only_change_places_are_refused_or_right():
    found = refused_or_both(_rounds(lambda x, y: (y, x)), rows(11), rows(11, seed=1))
    if not isinstance(found, str):
        np.testing.assert_array_equal(*found)


def refused_or_both(function, *arguments):
    """The reason why there is no code, or what both give."""
    try:
        return both(function, *arguments)
    except NotInLanes as reason:
        return str(reason)


# blocks


def test_each_block_of_lanes_stops_by_itself():
    """What another block still needs is no reason to go on."""

    def rounds(x):
        return lax.while_loop(
            lambda s: jnp.max(s[0]) > 1, lambda s: (s[0] / 2, s[1] + 1), (x, jnp.zeros_like(x[0]))
        )

    x = np.ones((3, 64)) * 2.0 ** np.repeat(np.arange(8), 8)
    program = NativeProgram(rounds, x)
    found, count = program(x)
    np.testing.assert_array_equal(found, 1.0)
    np.testing.assert_array_equal(count, np.repeat(np.arange(8), 8))


@pytest.mark.parametrize("loop", [lambda x: _halved(x)[0], FOLDS["mean"], _scan_with_both])
def test_blocks_do_not_know_of_each_other(loop):
    x = np.abs(rows(12, lanes=64)) + 0.1
    program = NativeProgram(loop, x)
    order = np.random.default_rng(4).permutation(8)
    lanes = (order[:, None] * 8 + np.arange(8)).ravel()
    for whole, part in zip(
        jax.tree.leaves(program(x)), jax.tree.leaves(program(x[..., lanes])), strict=True
    ):
        np.testing.assert_array_equal(whole[..., lanes], part)
    for first in range(0, 64, 8):
        alone = program(x[..., first : first + 8])
        for whole, part in zip(jax.tree.leaves(program(x)), jax.tree.leaves(alone), strict=True):
            np.testing.assert_array_equal(whole[..., first : first + 8], part)


# what has no code


REFUSED = {
    "sort": lambda x: jnp.sort(x, axis=0),
    "order": lambda x: jnp.argsort(x, axis=0),
    "sort of lanes": lambda x: jnp.sort(x, axis=-1),
    "number of the largest": lambda x: jnp.argmax(x, axis=0),
    "rows along another axis": lambda x: jnp.take_along_axis(
        x.reshape(3, 4, -1), (x[:3, None] > 0).astype(int), axis=1
    ),
    "one lane": lambda x: x + x[:, :1],
    "first lane alone": lambda x: jnp.sum(x[:, 0]) + x,
    "half of the lanes": lambda x: x[:, : x.shape[1] // 2],
    "neighbouring lanes": lambda x: jnp.roll(x, 1, axis=1),
    "lanes the other way": lambda x: x[:, ::-1],
    "lanes before rows": lambda x: x.T,
    "sum over the lanes of each row": lambda x: x - jnp.sum(x, axis=1, keepdims=True),
    "a number of rows and lanes in one": lambda x: x * x.ravel()[3],
    "numbers of lanes": lambda x: x + jnp.arange(x.shape[1]),
    "a constant for each lane": lambda x: x * jnp.asarray(np.linspace(0, 1, x.shape[1])),
    "rounds of a known number": lambda x: lax.fori_loop(0, 7, lambda i, y: y * 0.5 + i, x),
    "checkpoint": jax.checkpoint(lambda x: x * x + 1),
    "tiles": lambda x: jnp.tile(x, (3, 1)),
    "running total over lanes": lambda x: jnp.cumsum(x, axis=1),
    "running total backwards": lambda x: lax.cumsum(x, axis=0, reverse=True),
    "running product": lambda x: jnp.cumprod(x, axis=0),
    "product of rows": lambda x: jnp.prod(x, axis=0),
    "product of arrays": lambda x: jnp.einsum("il,jl->ijl", x, x).sum(axis=1) @ x.T,
    "a branch": lambda x: lax.cond(jnp.max(x) > 0, lambda y: y, lambda y: -y, x),
    "one of several": lambda x: lax.switch(
        jnp.asarray(jnp.max(x) > 0, int), [lambda y: y, lambda y: -y, lambda y: y * 2], x
    ),
    "parts": lambda x: jnp.split(x, 3)[1],
    "padding": lambda x: jnp.pad(x, ((1, 0), (0, 0))),
    "a row set": lambda x: x.at[3].set(0),
    "a row of a number known late": lambda x: lax.dynamic_slice_in_dim(
        x, jnp.asarray(jnp.max(x), int), 2, 0
    ),
    "error function": lambda x: lax.erf(x),
    "complex numbers": lambda x: jnp.abs(x + 1j * x),
    "half precision": lambda x: x.astype(jnp.float16) * 2,
    "callback": lambda x: jax.pure_callback(np.sin, x, x),
    "random numbers": lambda x: x + jax.random.normal(jax.random.key(0), x.shape),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_there_is_no_code_for_is_refused_with_a_reason_or_right(name):
    x = rows(12, lanes=8)
    found = refused_or_both(REFUSED[name], x)
    assert found  # a reason, if it is one
    if isinstance(found, str):
        return
    np.testing.assert_allclose(*found, rtol=1e-13)
    program = NativeProgram(REFUSED[name], x)
    wide = rows(12, lanes=24, seed=5)
    np.testing.assert_allclose(program(wide)[..., 8:16], program(wide[..., 8:16]), rtol=1e-13)


@pytest.mark.parametrize("fold", [jnp.sum, jnp.min, lambda x: -jnp.max(x)])
def test_one_number_of_all_lanes_that_blocks_cannot_tell_is_refused_or_right(fold):
    """Each block knows its own lanes, and of what blocks say the largest is given."""
    found = refused_or_both(fold, rows(12, lanes=24))
    if not isinstance(found, str):
        np.testing.assert_allclose(*found, rtol=1e-13)


@pytest.mark.parametrize("shape", [(4,), (3, 5), (LANES + 8,)])
def test_an_array_without_lanes_is_no_argument(shape):
    """Each array's last axis is its lanes: there are as many of them in all."""
    given = (rows(4), np.ones(shape))
    with pytest.raises((NotInLanes, ValueError), match="lanes"):
        NativeProgram(lambda given: given[0] * given[1].sum(), given)(given)


@pytest.mark.parametrize("other", [rows(5), rows(4).astype(np.float32), rows(2, 2)])
def test_a_program_takes_what_it_was_made_for(other):
    program = NativeProgram(lambda x: x * 2, rows(4))
    with pytest.raises((TypeError, ValueError)):
        program(other)

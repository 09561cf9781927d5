"""Programs that nobody would write: what shares a loop or a place in memory is still right.

Each is a list of steps on some arrays of several row counts, drawn by hypothesis; a step
takes any arrays that are there and leaves one more. Its numbers stay of the size of one,
and no step but `taken` jumps, so that rounding stays small beside any confusion of rows.
What there is no code for may be refused, but is never wrong.
"""

import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import event, given, settings
from hypothesis import strategies as st
from jax import lax
from machine_code import LANES, assert_same, rows

from camring.compiler.graph import NotInLanes
from camring.numerics.batch import take
from camring.numerics.compilation import computed_once

ROWS = (1, 4, 6, 12)
MATRICES = {
    (m, n): np.random.default_rng(m + n).uniform(-1, 1, (m, n)) / n for m in ROWS for n in ROWS
}


def fitted(x, count):
    """The array with so many rows, by views alone."""
    have = x.shape[0]
    if have == count:
        return x
    if have == 1:
        return jnp.broadcast_to(x, (count, x.shape[1]))
    if have > count:
        return x[have - count :]
    return jnp.concatenate([x] * -(-count // have))[:count]


ALONE = {
    "half": lambda x: 0.5 * x + 0.25,
    "wave": jnp.sin,
    "root": lambda x: jnp.sqrt(0.1 + jnp.abs(x)),
    "flip": lambda x: x[::-1],
    "roll": lambda x: jnp.roll(x, 1, axis=0),
    "difference": lambda x: x - jnp.roll(x, -1, axis=0),
    "first row": lambda x: x[:1],
    "last row": lambda x: x[-1:],
    "total": lambda x: jnp.mean(x, axis=0, keepdims=True),
    "largest": lambda x: jnp.max(x, axis=0, keepdims=True),
    "smallest": lambda x: jnp.min(x, axis=0, keepdims=True),
    "less its mean": lambda x: x - jnp.mean(x, axis=0),
    "running": lambda x: jnp.cumsum(x, axis=0) / x.shape[0],
    "filter": lambda x: lax.scan(lambda c, e: (0.5 * c + 0.5 * e, c), x[0], x)[1],
    "backwards": lambda x: lax.scan(lambda c, e: (0.5 * c + 0.5 * e, c * e), x[0], x, reverse=True)[
        1
    ],
    "once": computed_once,
    "pairs": lambda x: x.reshape(-1, 2, x.shape[1])[:, 0] if x.shape[0] % 2 == 0 else x,
}
TOGETHER = {
    "sum": lambda x, y: 0.5 * (x + y),
    "product": lambda x, y: x * y,
    "quotient": lambda x, y: x / (1.5 + jnp.abs(y)),
    "larger": jnp.maximum,
    "choice": lambda x, y: jnp.where(x < y, 0.5 * (x + y), x),
    "joined": lambda x, y: jnp.concatenate([x, y])[: x.shape[0]],
    "laid between": lambda x, y: jnp.concatenate([x[:1], y[1:]]),
    "times its fold": lambda x, y: x * jnp.mean(y, axis=0) + jnp.max(x, axis=0) * 0.25,
    "taken": lambda x, y: take(
        x, jnp.clip(0.3 + jnp.abs(3.7 * y), 0, x.shape[0] - 1).astype(jnp.int32)
    ),
    "scan of two": lambda x, y: (lambda found: 0.5 * found[1] + found[0] * y)(
        lax.scan(lambda c, e: (0.5 * (c + e[0]), c - e[1]), x[0], (x, y))
    ),
}
STEP = st.tuples(
    st.one_of(
        st.sampled_from(sorted(ALONE)),
        st.sampled_from(sorted(TOGETHER)),
        st.sampled_from(["product with a matrix", "fit"]),
    ),
    st.integers(0, 99),
    st.integers(0, 99),
    st.sampled_from(ROWS),
)
LOOP = st.tuples(
    st.just("loop"),
    st.integers(1, 3),
    st.lists(st.integers(0, 99), min_size=1, max_size=3),
    st.lists(STEP, min_size=1, max_size=10),
)


def done(steps, arrays):
    """All arrays, given and computed."""
    arrays = list(arrays)
    for name, *how in steps:
        if name == "loop":
            arrays.extend(looped(arrays, *how))
            continue
        first, second, count = arrays[-1 - how[0] % len(arrays)], how[1], how[2]
        second = arrays[-1 - second % len(arrays)]
        if name in ALONE:
            arrays.append(ALONE[name](first))
        elif name in TOGETHER:
            arrays.append(TOGETHER[name](first, fitted(second, first.shape[0])))
        elif name == "fit":
            arrays.append(fitted(first, count))
        else:
            matrix = MATRICES.get((count, first.shape[0]))
            arrays.append(first if matrix is None else jnp.asarray(matrix) @ first)
    return arrays


def looped(arrays, rounds, carried, steps):
    """A few rounds of some arrays; the last ones computed take the places of the first."""
    begin = [arrays[-1 - number % len(arrays)] for number in carried]

    def step(state):
        count, *now = state
        new = done(steps, [*arrays[:2], *now])[2 + len(now) :]
        filled = [fitted(new[-1 - k % len(new)], each.shape[0]) for k, each in enumerate(now)]
        return (count + 1, *filled)

    def goes_on(state):
        return (state[0] < rounds) & (jnp.max(jnp.abs(state[1])) < 100)

    return lax.while_loop(goes_on, step, (jnp.asarray(0), *begin))[1:]


def run(steps, wanted, arrays):
    found = done(steps, arrays)[len(arrays) :]
    return [found[-1 - number % len(found)] for number in wanted]


@settings(max_examples=40)
@given(
    steps=st.lists(st.one_of(STEP, STEP, STEP, STEP, LOOP), min_size=5, max_size=40),
    wanted=st.lists(st.integers(0, 20), min_size=1, max_size=4),
)
def test_any_program_gives_what_jax_gives(steps, wanted):
    arrays = [np.tanh(rows(count, seed=count, lanes=8)) for count in ROWS]
    try:
        assert_same(lambda *given: run(steps, wanted, given), *arrays, rtol=1e-9, atol=1e-9)
    except NotInLanes as reason:
        event(str(reason))


def filtered(x):
    return lax.scan(lambda c, e: (0.5 * (c + e), c), x[0], x)[1]


def test_a_scan_may_begin_with_what_another_of_one_row_leaves():
    """Both have loops of one row, but not the same."""
    assert_same(lambda x: filtered(filtered(x * 2) + 1), rows(1))
    assert_same(lambda x: filtered(filtered(filtered(x))), rows(1))


@pytest.mark.parametrize("count", [1, 3])
def test_what_is_taken_or_multiplied_may_be_one_computed_row(count):
    number = np.zeros((count, LANES), int)
    assert_same(lambda x, n: take(x * 2, n), rows(1), number)
    assert_same(lambda x: jnp.asarray(MATRICES[6, 1]) @ (x * 2), rows(1))
    assert_same(lambda x: jnp.asarray(MATRICES[6, 1]) @ jnp.sum(x, 0, keepdims=True), rows(5))

"""What the compiler computes beforehand by NumPy is what JAX computes, to the last bit."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from jax import lax

from camring.compiler.plain_numbers import PLAIN
from camring.numerics.quantity import real

RNG = np.random.default_rng(16)
REALS = RNG.normal(size=(2, 3, 4)) * 10.0 ** RNG.integers(-12, 12, size=(2, 3, 4))
ODD = np.asarray(real(np.array([0.0, -0.0, np.inf, -np.inf, np.nan, 1e308, -1e308, 1.0])))
WHOLE = RNG.integers(-9, 9, size=(2, 3, 4)).astype(np.int32)
TRUTHS = RNG.integers(0, 2, size=(2, 3, 4)).astype(bool)
PAIRS = [(REALS, REALS[::-1].copy()), (ODD, ODD[::-1].copy()), (WHOLE, WHOLE[::-1].copy())]
OF_TWO = ("add", "sub", "mul", "lt", "le", "gt", "ge", "eq", "ne")

STEPS = {
    **{name: [(getattr(lax, name), pair) for pair in PAIRS] for name in OF_TWO},
    "neg": [(lax.neg, (each,)) for each in (REALS, ODD, WHOLE)],
    "abs": [(lax.abs, (each,)) for each in (REALS, ODD, WHOLE)],
    "and": [(lax.bitwise_and, (TRUTHS, TRUTHS[::-1])), (lax.bitwise_and, PAIRS[2])],
    "or": [(lax.bitwise_or, (TRUTHS, TRUTHS[::-1])), (lax.bitwise_or, PAIRS[2])],
    "select_n": [
        (lax.select_n, (TRUTHS, REALS, -REALS)),
        (lax.select_n, (np.array(True), REALS, -REALS)),
        (lax.select_n, (WHOLE % 3, REALS, -REALS, 2 * REALS)),
        (lax.select_n, (TRUTHS, WHOLE, -WHOLE)),
    ],
    "iota": [(lambda: lax.broadcasted_iota(float, (3, 4), 1), ())],
    "broadcast_in_dim": [
        (lambda x: lax.broadcast_in_dim(x, (5, 2, 3, 4), (1, 2, 3)), (REALS,)),
        (lambda x: lax.broadcast_in_dim(x, (3, 4, 2), (0, 1)), (REALS[0, :, :1],)),
        (lambda x: lax.broadcast_in_dim(x, (2, 2), ()), (np.array(3.0),)),
    ],
    "slice": [
        (lambda x: lax.slice(x, (0, 1, 0), (2, 3, 4)), (REALS,)),
        (lambda x: lax.slice(x, (1, 0, 0), (2, 3, 4), (1, 2, 3)), (WHOLE,)),
    ],
    "reshape": [
        (lambda x: lax.reshape(x, (6, 4)), (REALS,)),
        (lambda x: lax.reshape(x, (4, 6), (2, 0, 1)), (REALS,)),
    ],
    "squeeze": [(lambda x: lax.squeeze(x, (0, 2)), (REALS[:1, :, :1],))],
    "transpose": [(lambda x: lax.transpose(x, (2, 0, 1)), (REALS,))],
    "concatenate": [(lambda x, y: lax.concatenate([x, y], 1), (REALS, -REALS))],
    "rev": [(lambda x: lax.rev(x, (0, 2)), (REALS,))],
}


def test_every_step_is_tried():
    assert set(STEPS) == set(PLAIN)


@pytest.mark.parametrize("name", PLAIN)
def test_a_step_is_that_of_jax_to_the_last_bit(name):
    for function, arguments in STEPS[name]:
        seen = jax.make_jaxpr(function)(*arguments)
        (step,) = [each for each in seen.jaxpr.eqns if each.primitive.name == name]
        found = PLAIN[name](*arguments, **step.params)
        (kind,) = [var.aval for var in step.outvars]
        found = np.broadcast_to(found, kind.shape).astype(kind.dtype)
        expected = np.asarray(function(*map(jnp.asarray, arguments)))
        assert found.dtype == expected.dtype
        assert found.shape == expected.shape
        assert np.array_equal(np.isnan(found), np.isnan(expected))
        number = ~np.isnan(expected)
        assert np.array_equal(found[number], expected[number])
        assert np.array_equal(np.signbit(found[number]), np.signbit(expected[number]))

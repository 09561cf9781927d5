"""One function, two compilers."""

import jax
import jax.numpy as jnp
import numpy as np

from camring.compiler.program import NativeProgram
from camring.numerics.quantity import real

LANES = 16


def both(function, *arguments):
    """Results of the machine code and of JAX, of a function of several arrays with lanes."""
    program = NativeProgram(lambda given: function(*given), arguments)
    return program(arguments), jax.jit(function)(*map(jnp.asarray, arguments))


def assert_same(function, *arguments, rtol=1e-13, atol=0.0):
    found, expected = both(function, *arguments)
    assert jax.tree.structure(found) == jax.tree.structure(expected)
    for mine, theirs in zip(jax.tree.leaves(found), jax.tree.leaves(expected), strict=True):
        assert mine.dtype == theirs.dtype, (mine.dtype, theirs.dtype)
        assert mine.shape == theirs.shape, (mine.shape, theirs.shape)
        if mine.dtype.kind == "f":
            np.testing.assert_allclose(mine, theirs, rtol=rtol, atol=atol)
        else:
            np.testing.assert_array_equal(mine, theirs)


def rows(*lead, seed=0, lanes=LANES):
    return np.asarray(real(np.random.default_rng(seed).normal(size=(*lead, lanes)))).copy()

"""What is computed once is what was computed, for every number and every derivative."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from camring.numerics.compilation import computed_once

AWKWARD = [np.nan, np.inf, -np.inf, 0.0, -3.0, 1e-310]


@pytest.mark.parametrize("first", AWKWARD)
def test_every_number_passes_whatever_the_first_one_is(first):
    given = (jnp.array([first, 2.0]), {"count": jnp.arange(3)}, None)
    found = jax.jit(computed_once)(given)
    np.testing.assert_array_equal(found[0], given[0])
    np.testing.assert_array_equal(found[1]["count"], given[1]["count"])
    assert found[2] is None


def test_one_lost_member_leaves_the_others_alone():
    members = jnp.stack([jnp.full(4, np.nan), jnp.arange(4.0)])
    np.testing.assert_array_equal(
        jax.vmap(lambda member: computed_once(jnp.sin(member)))(members)[1:], jnp.sin(members[1:])
    )


def test_derivatives_pass_in_both_modes():
    def curve(x):
        return computed_once((x**3, jnp.cos(x)))[0]

    at = jnp.array([0.5, 2.0])
    np.testing.assert_allclose(jax.jvp(curve, (at,), (jnp.ones(2),))[1], 3 * at**2, rtol=1e-15)
    np.testing.assert_allclose(jax.grad(lambda x: curve(x).sum())(at), 3 * at**2, rtol=1e-15)


def test_it_stands_in_the_compiled_program():
    """Where the compiler learns to look through it, batches lose half their speed."""
    program = jax.jit(lambda x: computed_once(jnp.sin(x)) + 1).lower(jnp.ones(9)).compile()
    assert "conditional" in program.as_text()

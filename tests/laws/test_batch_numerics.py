"""Short cuts that batches take are what they stand for, and so are their slopes."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from motors import STRUCTURES, random_cam

from camring.numerics.batch_fourier import power_of_orders
from camring.numerics.radau import STAGE_INTEGRALS, solve_stages
from camring.numerics.smooth import signed_root
from camring.objective.cam_modes import _sum_of_rises, sum_of_rises

# Fourier sums


def power_by_fft(wave, orders):
    return np.sum(np.abs(np.fft.rfft(wave, axis=0)[1 : orders + 1] / len(wave)) ** 2, axis=0)


COUNTS = [(4, 1), (8, 1), (8, 3), (12, 5), (256, 1), (256, 2), (256, 100), (260, 129), (1200, 75)]


@pytest.mark.parametrize(("count", "orders"), COUNTS)
def test_power_of_orders_is_that_of_the_fast_fourier_transform(count, orders):
    wave = np.random.default_rng(count).normal(size=(count, 5)) + 30
    found = jax.jit(power_of_orders, static_argnums=1)(wave, orders)
    np.testing.assert_allclose(found, power_by_fft(wave, orders), rtol=1e-11)


def test_a_single_order_counts_if_it_is_among_them():
    places = 2 * np.pi * np.arange(64)[:, None] / 64
    order = np.arange(1, 13)
    for wave in (np.cos(order * places), np.sin(order * places), np.cos(order * places + 1)):
        found = power_of_orders(jnp.asarray(wave), 7)
        np.testing.assert_allclose(found, np.where(order <= 7, 0.25, 0), atol=1e-15)


@pytest.mark.parametrize(("count", "orders"), COUNTS)
def test_the_slope_of_power_is_twice_the_wave_without_its_other_orders(count, orders):
    """As a gradient, along several directions at once, and of a multiple of the wave."""
    rng = np.random.default_rng(count)
    wave, ways = rng.normal(size=(count, 3)), rng.normal(size=(4, count, 3))

    def power(wave):
        return power_of_orders(2 * wave, orders)

    transform = np.fft.rfft(wave, axis=0)
    transform[0], transform[orders + 1 :] = 0, 0
    gradient = 4 * np.fft.irfft(transform, count, axis=0) / count

    @jax.jit
    def slopes(wave, ways):
        _, linear = jax.linearize(power, wave)
        one = jax.jvp(power, (wave,), (ways[0],))
        return jax.grad(lambda wave: jnp.sum(power(wave)))(wave), jax.vmap(linear)(ways), *one

    # The highest order of all counts once, the others with their mirror images.
    by_grad, found, value, slope = slopes(wave, ways)
    np.testing.assert_allclose(by_grad, gradient, atol=1e-14)
    np.testing.assert_allclose(found, np.sum(gradient * ways, axis=1), atol=1e-12)
    np.testing.assert_allclose(value, 4 * power_by_fft(wave, orders), rtol=1e-12)
    np.testing.assert_allclose(slope, found[0], atol=1e-14)


# A root with a sign


def root(x, softness):
    return x * (x**2 + softness**2) ** -0.25


def slopes_of_root(x, softness):
    square = x**2 + softness**2
    return (x**2 / 2 + softness**2) * square**-1.25, -x * softness / 2 * square**-1.25


def second_derivative_of_root(x, softness):
    square = x**2 + softness**2
    return -x * (x**2 / 4 + 1.5 * softness**2) * square**-2.25


RATIOS = np.concatenate([[0.0], 10.0 ** np.arange(-6, 7), -(10.0 ** np.arange(-6, 7))])
SOFTNESS = [1e-3, 1.0, 7e5]


@pytest.mark.parametrize("softness", SOFTNESS)
@pytest.mark.parametrize("compiled", [True, False])
def test_a_root_with_a_sign_and_its_slopes(softness, compiled):
    x, soft = RATIOS * softness, np.full_like(RATIOS, softness)
    through = jax.jit if compiled else lambda function: function
    np.testing.assert_allclose(through(signed_root)(x, soft), root(x, soft), rtol=1e-14)
    by_x, by_softness = slopes_of_root(x, soft)
    one = through(jax.vmap(jax.grad(signed_root, argnums=(0, 1))))
    for found, expected in zip(one(x, soft), (by_x, by_softness), strict=True):
        np.testing.assert_allclose(found, expected, rtol=1e-13)
    # Only one of them moves, the other has no tangent at all, or one of nil.
    ones, nil = np.ones_like(x), np.zeros_like(x)
    along = through(lambda *way: jax.jvp(signed_root, (x, soft), way)[1])
    np.testing.assert_allclose(along(ones, nil), by_x, rtol=1e-13)
    np.testing.assert_allclose(along(nil, ones), by_softness, rtol=1e-13)
    np.testing.assert_allclose(along(ones, ones), by_x + by_softness, rtol=1e-12)
    alone = through(lambda x: jax.jvp(lambda x: signed_root(x, soft), (x,), (ones,))[1])
    np.testing.assert_allclose(alone(x), by_x, rtol=1e-13)
    other = through(lambda s: jax.jvp(lambda s: signed_root(x, s), (s,), (ones,))[1])
    np.testing.assert_allclose(other(soft), by_softness, rtol=1e-13)


@pytest.mark.parametrize("softness", SOFTNESS)
def test_its_second_derivatives(softness):
    x, soft = RATIOS * softness, np.full_like(RATIOS, softness)
    for twice in (
        jax.grad(jax.grad(signed_root)),
        jax.jacfwd(jax.jacfwd(signed_root)),
        jax.jacfwd(jax.grad(signed_root)),
    ):
        found = jax.jit(jax.vmap(twice))(x, soft)
        scale = softness**-1.5
        np.testing.assert_allclose(
            found, second_derivative_of_root(x, soft), rtol=1e-9, atol=1e-13 * scale
        )


def test_it_is_straight_through_zero():
    softness = 4.0
    assert float(signed_root(jnp.zeros(()), softness)) == 0
    assert float(jax.grad(signed_root)(0.0, softness)) == pytest.approx(softness**-0.5, rel=1e-15)
    assert float(jax.grad(jax.grad(signed_root))(0.0, softness)) == 0
    assert float(jax.grad(signed_root, argnums=1)(0.0, softness)) == 0
    small = np.array([-1e-9, 1e-9])
    np.testing.assert_allclose(signed_root(small, softness), small / 2, rtol=1e-14)


def test_one_softness_serves_many_places():
    """Shapes that only fit together by broadcasting, in slopes too."""
    x = jnp.linspace(-2, 2, 7)
    by_softness = jax.grad(lambda s: jnp.sum(signed_root(x, s)))(0.5)
    assert float(by_softness) == pytest.approx(
        np.sum(slopes_of_root(np.asarray(x), 0.5)[1]), abs=1e-14
    )
    _, slope = jax.jvp(lambda s: signed_root(x, s), (0.5,), (1.0,))
    assert slope.shape == x.shape


# Stages


def stage_systems(count=2000, seed=0):
    """`1 - width A slope` of elements whose rate falls, from hardly at all to very steeply."""
    rng = np.random.default_rng(seed)
    stiffness = 10 ** rng.uniform(-6, 12, (count, 1)) * 10 ** rng.uniform(-3, 0, (count, 3))
    stiffness *= rng.random((count, 3)) < 0.9  # some do not fall at all
    return np.eye(3) + STAGE_INTEGRALS * stiffness[:, None, :], rng


def test_stage_systems_are_solved_as_by_exchange_of_rows():
    matrix, rng = stage_systems()
    solution = rng.normal(size=(2000, 3, 2))
    right = matrix @ solution
    rows = [[jnp.asarray(matrix[:, i, j]) for j in range(3)] for i in range(3)]
    sides = [[jnp.asarray(right[:, i, k]) for i in range(3)] for k in range(2)]
    found = np.array(jax.jit(solve_stages)(rows, *sides))  # (side, stage, element)
    expected = np.linalg.solve(matrix, right)
    for k in range(2):
        mine, theirs = found[k].T, expected[..., k]
        # Small against what is solved for, whatever the stiffness: it only scales columns.
        residual = np.einsum("eij,ej->ei", matrix, mine) - right[..., k]
        size = np.einsum("eij,ej->ei", np.abs(matrix), np.abs(mine)) + np.abs(right[..., k])
        assert np.max(np.abs(residual) / size) < 1e-14
        scaled = matrix / np.max(np.abs(matrix), axis=1, keepdims=True)
        condition = np.linalg.cond(scaled)
        assert np.max(condition) < 1e3
        error = np.linalg.norm((mine - theirs) * np.max(np.abs(matrix), axis=1), axis=1)
        allowed = np.linalg.norm(theirs * np.max(np.abs(matrix), axis=1), axis=1)
        assert np.max(error / (condition * allowed)) < 1e-14


def test_two_coupled_equations_are_solved_as_by_exchange_of_rows():
    """Two volumes lose oil, in part to each other, from hardly at all to very steeply."""
    rng = np.random.default_rng(2)
    leaving, crossing = 10 ** rng.uniform(-6, 6, (2, 2000, 2, 3))
    matrix = np.tile(np.eye(6), (2000, 1, 1)).reshape(2000, 2, 3, 2, 3)
    for s in range(2):
        matrix[:, s, :, s] += STAGE_INTEGRALS * (leaving + crossing)[:, s, None]
        matrix[:, s, :, 1 - s] -= STAGE_INTEGRALS * crossing[:, 1 - s, None]
    matrix = matrix.reshape(2000, 6, 6)
    right = rng.normal(size=(2000, 6))
    rows = [[jnp.asarray(matrix[:, i, j]) for j in range(6)] for i in range(6)]
    (found,) = jax.jit(solve_stages)(rows, [jnp.asarray(right[:, i]) for i in range(6)])
    found = np.array(found).T
    residual = np.einsum("eij,ej->ei", matrix, found) - right
    size = np.einsum("eij,ej->ei", np.abs(matrix), np.abs(found)) + np.abs(right)
    assert np.max(np.abs(residual) / size) < 1e-14


def test_leading_minors_of_falling_rates_are_never_small():
    """Why no rows are exchanged."""
    matrix, _ = stage_systems(seed=1)
    for size in (1, 2, 3):
        assert np.all(np.linalg.det(matrix[:, :size, :size]) >= 1 - 1e-9)


# Rises of a cam


@jax.jit
def rises_and_slopes(cam, ways):
    """Of both functions, along several ways at once."""

    def of(function):
        value, linear = jax.linearize(function, cam)
        return value, jax.vmap(linear)(ways), jax.jvp(function, (cam,), (_first(ways),))[1]

    return of(sum_of_rises), of(_sum_of_rises)


def _first(ways):
    return jax.tree.map(lambda leaf: leaf[0], ways)


@pytest.mark.parametrize("structure", STRUCTURES[1:], ids=lambda each: each.kind)
def test_the_slope_of_rises_is_that_of_the_function_left_to_itself(structure):
    rng = np.random.default_rng(3)
    cam = random_cam(rng, structure, 0.1, 0.012)
    ways = jax.tree.map(lambda leaf: rng.normal(size=(3, *leaf.shape)), cam)
    for mine, theirs in zip(*rises_and_slopes(cam, ways), strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=1e-11)

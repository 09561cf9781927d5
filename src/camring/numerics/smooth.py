"""Functions with a removable singularity, smooth and differentiable through it."""

from collections.abc import Callable, Sequence
from typing import Any

import jax
import jax.numpy as jnp
from jax.custom_derivatives import SymbolicZero
from jaxtyping import Array, Float

NEAR = 1e-2
"""Where a series of eight terms takes over: its error there is below 1e-16."""


def _series(x: Float[Array, "*grid"], coefficients: list[float]) -> Float[Array, "*grid"]:
    total = jnp.zeros_like(x)
    for coefficient in reversed(coefficients):
        total = total * x + coefficient
    return total


def exponential_mean(x: Float[Array, "*grid"]) -> Float[Array, "*grid"]:
    """`(e^x - 1)/x`, the mean of the exponential between 0 and x; 1 at zero."""
    near = jnp.abs(x) < NEAR
    far = jnp.where(near, 1.0, x)
    factorial, coefficients = 1.0, []
    for k in range(1, 9):
        factorial *= k
        coefficients.append(1 / factorial)
    return jnp.where(near, _series(jnp.where(near, x, 0.0), coefficients), jnp.expm1(far) / far)


def logarithmic_mean(x: Float[Array, "*grid"]) -> Float[Array, "*grid"]:
    """`ln(1 + x)/x`, the mean of `1/(1 + x)` between 0 and x > -1; 1 at zero."""
    near = jnp.abs(x) < NEAR
    far = jnp.where(near, 1.0, x)
    coefficients = [(-1) ** k / (k + 1) for k in range(8)]
    return jnp.where(near, _series(jnp.where(near, x, 0.0), coefficients), jnp.log1p(far) / far)


def tanh_ratio(squared: Float[Array, "*grid"]) -> Float[Array, "*grid"]:
    """`tanh(z)/z` of `z^2`, for `z^2 >= 0`; 1 at zero, with a finite slope there."""
    near = squared < NEAR**2
    root = jnp.sqrt(jnp.where(near, 1.0, squared))
    series = _series(jnp.where(near, squared, 0.0), [1.0, -1 / 3, 2 / 15, -17 / 315])
    return jnp.where(near, series, jnp.tanh(root) / root)


def along(
    found: Float[Array, "*grid"], tangents: Sequence[Any], *slopes: Callable[[], Array]
) -> Float[Array, "*grid"]:
    """Derivative of a function's value: of each argument that moves its slope times how it does.

    Slopes of the others are not worked out.
    """
    parts = [
        slope() * tangent
        for slope, tangent in zip(slopes, tangents, strict=True)
        if not isinstance(tangent, SymbolicZero)
    ]
    return jnp.broadcast_to(sum(parts[1:], parts[0]), found.shape)


@jax.custom_jvp
def inverse(x: Float[Array, "*grid"]) -> Float[Array, "*grid"]:
    """`1/x`; value and slope share the division."""
    return 1 / x


@inverse.defjvp
def _inverse_slope(primals: tuple[Array], tangents: tuple[Array]) -> tuple[Array, Array]:
    found = inverse(primals[0])
    return found, -found * found * tangents[0]


@jax.custom_jvp
def inverse_root(x: Float[Array, "*grid"]) -> Float[Array, "*grid"]:
    """`1/sqrt(x)` for `x > 0`; value and slope share root and division."""
    return 1 / jnp.sqrt(x)


@inverse_root.defjvp
def _inverse_root_slope(primals: tuple[Array], tangents: tuple[Array]) -> tuple[Array, Array]:
    found = inverse_root(primals[0])
    return found, -found * found * found / 2 * tangents[0]


@jax.custom_jvp
def power(x: Float[Array, "*grid"], exponent: Float[Array, ""]) -> Float[Array, "*grid"]:
    """`x ** exponent` for `x > 0`, whose slope by `x` takes no second exponential."""
    return jnp.exp(exponent * jnp.log(x))


def _power_slope(primals: tuple[Any, ...], tangents: tuple[Any, ...]) -> tuple[Array, Array]:
    x, exponent = primals
    found = power(x, exponent)
    by_x, by_exponent = lambda: found * exponent * inverse(x), lambda: found * jnp.log(x)
    return found, along(found, tangents, by_x, by_exponent)


power.defjvp(_power_slope, symbolic_zeros=True)


@jax.custom_jvp
def stiffening_decay(
    strain: Float[Array, "*grid"], gain: Float[Array, ""]
) -> Float[Array, "*grid"]:
    """`(1 + gain strain)^(-1/gain)`, the exponential of `-strain` where the gain is zero."""
    return jnp.exp(-strain * logarithmic_mean(gain * strain))


def _decay_slope(primals: tuple[Any, ...], tangents: tuple[Any, ...]) -> tuple[Array, Array]:
    strain, gain = primals
    found = stiffening_decay(strain, gain)

    def by_gain() -> Array:
        means = jax.jvp(lambda g: logarithmic_mean(g * strain), (gain,), (jnp.ones_like(gain),))
        return -found * strain * means[1]

    return found, along(found, tangents, lambda: -found * inverse(1 + gain * strain), by_gain)


stiffening_decay.defjvp(_decay_slope, symbolic_zeros=True)


@jax.custom_jvp
def signed_root(x: Float[Array, "*grid"], softness: Float[Array, "*grid"]) -> Float[Array, "*grid"]:
    """`x / (x^2 + softness^2)^(1/4)`: a root that carries the sign, straight through zero.

    Value and slope share one division; left to itself, differentiation takes six.
    """
    return _signed_root(x, softness)[0]


def _signed_root(x: Array, softness: Array) -> tuple[Array, Array, Array]:
    """The root, and its slopes by both."""
    over = inverse_root(jnp.sqrt(x**2 + softness**2))
    square = over * over
    share = x * square  # of x in what is under the root: towards one far from zero
    return x * over, over * (1 - share * share / 2), -share * square * over * softness / 2


def _signed_root_slopes(primals: tuple[Any, ...], tangents: tuple[Any, ...]) -> tuple[Array, Array]:
    root, by_x, by_softness = _signed_root(*primals)
    return root, along(root, tangents, lambda: by_x, lambda: by_softness)


signed_root.defjvp(_signed_root_slopes, symbolic_zeros=True)

"""Largest and smallest pitch radius, found between the knots."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.geometry.cam import AbstractCam
from camring.numerics.quantity import Q
from camring.numerics.selection import bounded

_SAMPLES_PER_SPAN = 8
_NEWTON_STEPS = 4


def extreme_radius(cam: AbstractCam, sign: int) -> Q[Float[Array, ""], "m"]:
    """Smallest (`sign = -1`) or largest (`sign = 1`) pitch radius.

    Samples each knot span, then lets Newton on the slope settle the best one
    within its neighbours. The angle is held constant under differentiation,
    which is exact at an extreme (envelope theorem).
    """
    count = _SAMPLES_PER_SPAN * cam.control_count
    spacing = cam.period / count
    angles = spacing * jnp.arange(count)
    best = angles[jnp.argmax(sign * jax.lax.stop_gradient(cam.pitch_radius(angles).value))]

    angle = best
    for _ in range(_NEWTON_STEPS):
        radius = cam.pitch_radius(angle)
        bend = jnp.where(radius.second == 0, 1.0, radius.second)
        angle = bounded(angle - radius.first / bend, best - spacing, best + spacing)
    angle = jax.lax.stop_gradient(angle)
    start = jax.lax.stop_gradient(best)
    refined, sampled = cam.pitch_radius(angle).value, cam.pitch_radius(start).value
    return jnp.where(sign * refined > sign * sampled, refined, sampled)

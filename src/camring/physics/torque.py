"""Torque of one piston on the block, in two ways that must agree."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.geometry.contour import pressure_angle
from camring.numerics.quantity import Q
from camring.numerics.spline import Jet


def torque_by_virtual_work(
    force: Q[Float[Array, "*grid"], "N"], radius: Jet
) -> Q[Float[Array, "*grid"], "N.m"]:
    """Radial force times piston travel for each radian, `F ds/dtheta`. docs/theory.md section 4."""
    return force * radius.first


def torque_by_contact(
    force: Q[Float[Array, "*grid"], "N"], radius: Jet
) -> Q[Float[Array, "*grid"], "N.m"]:
    """Tangential part of the contact force times its arm, `r F tan(phi)`."""
    return radius.value * force * jnp.tan(pressure_angle(radius))

"""What the pistons press on the shaft and the ring sideways, and the ring outwards, by order.

Every roller presses on the ring along the contact's normal, and the block takes the same force
the other way to the shaft's bearings. All pistons together are one vector in the plane of the
housing. It cancels where pistons and the period of cam and windows share a divisor; else it
holds orders that the number of pistons divides. docs/theory.md section 14.
"""

from math import lcm
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from camring.numerics.quantity import Q
from camring.numerics.selection import largest
from camring.physics.cycle import Cycle
from camring.physics.motor import Motor
from camring.physics.piston_state import PistonState, quadrature_samples, sample_angles

__all__ = ["RadialLoad", "radial_load", "ring_orders", "shaft_orders"]

PLACES = 720  # of the shaft, while it turns from one piston to the next
ORDERS = 12  # multiples of the number of pistons, each way round


class RadialLoad(NamedTuple):
    """Of all pistons at steady state; the shaft's and the ring's are equal and opposite."""

    largest: Q[Float[Array, ""], "N"]
    """The vector's greatest length."""
    mean: Q[Float[Array, ""], "N"]
    """Its mean length."""
    by_order: Q[Float[Array, " order"], "N"]
    """Its parts that turn `shaft_orders(motor)` times a revolution."""
    outwards: Q[Float[Array, ""], "N"]
    """Mean of all radial forces added up, the same all round: what widens the ring."""
    outwards_by_order: Q[Float[Array, " order"], "N"]
    """Peak amplitudes of that sum at `ring_orders(motor)`."""


def shaft_orders(motor: Motor) -> np.ndarray:
    """Turns a revolution of the parts of the vector, ascending; negative against the shaft."""
    orders = motor.pistons * np.arange(-ORDERS, ORDERS + 1)
    return orders[(orders - 1) % motor.cam.repeats == 0]


def ring_orders(motor: Motor) -> np.ndarray:
    """Orders of the sum of radial forces: the torque's."""
    return lcm(motor.pistons, motor.cam.repeats) * np.arange(1, ORDERS + 1)


def radial_load(cycle: Cycle) -> RadialLoad:
    """Net radial force of all pistons, and their sum outwards.

    Notes
    -----
    `Z = sum_i F (1 - i r'/r) e^(i theta_i)`, in which `F (1 - i r'/r)` is the contact's normal
    force beside the piston's own direction. Inertia counts as in `F`; that of the circle, which
    a piston describes with the block, is left out there and here. Friction is left out, too.
    """
    motor = cycle.motor
    samples = quadrature_samples(cycle)
    piston = samples.piston
    pressing = _pressing(piston)

    def part(wave: Array, order: int) -> Array:
        return motor.pistons * jnp.abs(samples.mean(wave * jnp.exp(-1j * order * piston.angle)))

    def parts(wave: Array, orders: np.ndarray) -> Array:
        return jnp.stack([part(wave, int(order)) for order in orders] or [jnp.zeros(())])

    turning = shaft_orders(motor)
    by_order = parts(pressing, turning - 1)[: len(turning)]
    length = jnp.abs(_vector(cycle))
    return RadialLoad(
        largest=largest(length),
        mean=jnp.mean(length),
        by_order=by_order,
        outwards=motor.pistons * samples.mean(piston.force),
        outwards_by_order=2 * parts(piston.force, ring_orders(motor)),
    )


def _pressing(piston: PistonState) -> Array:
    """The contact's normal force beside the piston's own direction."""
    return piston.force * (1 - 1j * piston.radius.first / piston.radius.value)


def _vector(cycle: Cycle) -> Array:
    """While the shaft turns from one piston to the next, after which it repeats, turned."""
    pistons = cycle.motor.pistons
    angle = 2 * np.pi / (pistons * PLACES) * np.arange(pistons * PLACES)
    piston = sample_angles(cycle, jnp.asarray(angle))
    # Where the piston stands in the housing; its own angle is taken modulo the cam's period.
    each = _pressing(piston) * jnp.exp(1j * angle)
    return jnp.sum(each.reshape(pistons, PLACES), axis=0)

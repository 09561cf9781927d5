"""How long ring and rollers live: ISO 281's rating life from the contact load round the ring.

Lundberg and Palmgren's capacity of one line contact, in the form that the geometry of a cam
ring asks for. Their law of survival, `ln 1/S ~ tau^(31/3) N^(9/8) z^(-7/3) V`, gives with Hertz'
stress and depth a load that a whole raceway of length `c` bears for a million stress cycles,

`q = a l^(7/9) R'^(35/27) c^(-2/9)`,

`l` the contact's length, `R'` its relative radius, here `Rf (1 + kappa Rf)`. On the circles of a
bearing this is `552 (1 -+ g)^(29/27) g^(2/9) D^(29/27) l^(7/9) / 2^(1/4)` newtons in millimetres
(Harris, *Rolling Bearing Analysis*, on line contact), which fixes `a`; with `u` cycles a revolution
it is less by `u^(1/4)`. Life goes with the power 10/3 of load, as ISO 281 rounds it, and the
dispersion of lives is 9/8.

- The ring stands still under its load: each place of it bears its own, and the weakest link is
  the mean of `(Q/q)^(15/4)` over its length.
- The roller turns under its load: each place of it bears all loads in turn, the mean of
  `(Q/q)^(10/3)` over the ring's length.

Holds for hardened bearing steel, clean oil whose film separates the contact, 90 % survival.
Lundberg and Palmgren, *Acta Polytechnica* 96 (1952); ISO 281:2007; ISO/TR 1281-1.
"""

from math import pi
from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.geometry.contour import undercut_factor
from camring.numerics.quantity import Q
from camring.numerics.selection import larger
from camring.physics.motor import Motor
from camring.physics.piston_state import PistonState

__all__ = ["CAPACITY", "Endured", "contact_capacity", "endured", "rating_life"]

DISPERSION = 9 / 8
LOAD_EXPONENT = 10 / 3
_EDGES = 0.83  # lambda nu of ISO/TR 1281-1: load is not even along the contact
_STEEL = 1.1  # b_m of ISO 281 for cylindrical rollers of contemporary steel
_LUNDBERG = 552 * 2 ** (-1 / 4) * 2 ** (35 / 27) * pi ** (2 / 9)  # N, mm
CAPACITY = _EDGES * _STEEL * _LUNDBERG * 1e3 ** (7 / 9 + 35 / 27 - 2 / 9)
"""`a` for lengths in metres and forces in newtons."""
_MILLION = 1e6
_TINY = 1e-300
_RUINED = 1e300
"""Damage where there is no contact to bear a load: finite, for elements without width count too."""


class Endured(NamedTuple):
    """What contact loads do to ring and roller, as means over the angle.

    Loads are over `R'^(35/27)`, what does not change round the ring being left to `rating_life`.
    """

    ring: Float[Array, "*batch"]
    """Of load to the power 15/4, times the ring's length a radian."""
    roller: Float[Array, "*batch"]
    """Of load to the power 10/3, times the ring's length a radian."""
    ring_length: Q[Float[Array, "*batch"], "m/rad"]
    """That passes a roller for each radian."""


def endured(piston: PistonState, motor: Motor) -> Endured:
    """Ring's and roller's damage at some places of the reference piston, before any mean.

    Zero where the roller does not press; beyond all bounds where the ring is undercut.
    """
    factor = undercut_factor(piston.radius, motor.roller.radius)
    sound = factor > 0
    length = factor * jnp.hypot(piston.radius.value, piston.radius.first)
    relative = jnp.where(sound, motor.roller.radius * factor, 1.0)
    pressing = piston.contact_force > 0
    load = jnp.where(pressing, piston.contact_force, 1.0) * jnp.exp(-35 / 27 * jnp.log(relative))
    root = jnp.sqrt(load)
    ring = load**3 * root * jnp.sqrt(root)
    roller = load**3 * jnp.exp(jnp.log(load) / 3)
    return Endured(
        jnp.where(pressing, jnp.where(sound, ring * length, _RUINED), 0.0),
        jnp.where(pressing, jnp.where(sound, roller * length, _RUINED), 0.0),
        length,
    )


def contact_capacity(
    contact_length: Q[Float[Array, "*batch"], "m"],
    raceway: Q[Float[Array, "*batch"], "m"],
    cycles: Float[Array, "*batch"] | float,
) -> Float[Array, "*batch"]:
    """Load over `R'^(35/27)` that a raceway bears for a million revolutions, N/m^(35/27).

    Parameters
    ----------
    contact_length
        Of roller and ring together.
    raceway
        Length of the raceway once round.
    cycles
        Stress cycles of each of its places in a revolution.
    """
    return CAPACITY * contact_length ** (7 / 9) * raceway ** (-2 / 9) * cycles ** (-1 / 4)


def rating_life(
    motor: Motor, speed: Q[Float[Array, "*batch"], "rad/s"], found: Endured
) -> Q[Float[Array, "*batch"], "s"]:
    """Life that nine of ten motors reach at this speed and load, of the ring and all rollers."""
    ring_round = 2 * pi * found.ring_length
    roller_round = 2 * pi * motor.roller.radius
    length = motor.roller.length
    ring = contact_capacity(length, ring_round, motor.pistons)
    roller = contact_capacity(length, roller_round, ring_round / roller_round)
    # Damage a million revolutions: the inverse of each life.
    of_ring = found.ring / found.ring_length / ring ** (DISPERSION * LOAD_EXPONENT)
    of_roller = found.roller / found.ring_length / roller**LOAD_EXPONENT
    weakest = of_ring + motor.pistons * of_roller**DISPERSION
    revolutions = _MILLION * larger(weakest, _TINY) ** (-1 / DISPERSION)
    return revolutions * 2 * pi / jnp.abs(speed)
